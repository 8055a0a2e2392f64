// SPDX-License-Identifier: MIT
// What the odometer that `thermorig export --odometer` writes takes on a Cortex-M4F in QEMU, how far it is
// from the same C on this machine, from the product's odometer, and from the true shaft of simulated rigs.
// Usage: export_odometer [--json] [--first-seed N] [--quick]
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "embedded/board_odometer.h"
#include "embedded/boards.h"
#include "odometer_judge.h"
#include "odometer_recording.h"
#include "odometer_stresses.h"
#include "thermorig/core/run_all.h"
#include "thermorig/estimators/table.h"
#include "timing_figures.h"

namespace thermorig::bench {
namespace {

using tests::OdometerRun;

const std::array<std::string, 4> environments{"laboratory", "dining", "kitchen", "garden"};
constexpr double in_motion_s = 12.0;  // after the opening rest, in the first leg
constexpr double recorded_s = 440.0;  // seven minutes are seen
constexpr int qemu_timeout_s = 900;
const std::string host_compiler = "cc -std=c99 -O2";

/// One recording from its start at rest, or in motion.
struct Case {
  std::string name;
  OdometerCase recorded;
  JudgedRun run;
  bool on_board = false;  // in QEMU too
  bool is_plain = true;
  Judgement product, board;
  double apart_deg = 0.0;   // board and product, at most, where both track; both zero where that begins
  OdometerRun here, there;  // the C on this machine and on the board
};

std::vector<Case> cases_of(const TableOptions& options) {
  std::vector<Case> cases;
  const std::size_t count = options.quick ? 4 : 24;
  for (const bool is_moving : {true, false})
    for (std::size_t i = 0; i < count; ++i) {
      Case one;
      one.recorded = {.seed = options.first_seed + i,
                      .environment = environments[i % environments.size()],
                      .duration_s = recorded_s};
      one.name = fmt::format("{} {}, {}", one.recorded.environment, one.recorded.seed,
                             is_moving ? "in motion" : "at rest");
      one.run.from_s = is_moving ? in_motion_s : 0.0;
      one.on_board = i < (options.quick ? 1U : 4U) && is_moving;
      cases.push_back(one);
    }
  for (const Stress& stress : odometer_stresses()) {
    if (!stress.name.starts_with("frozen gyro")) continue;  // it relocalises afterwards
    Case one;
    one.name = stress.name;
    one.recorded = {.seed = options.first_seed + count, .environment = "laboratory"};
    one.run = stress.run;
    one.on_board = true;
    one.is_plain = false;
    cases.push_back(one);
  }
  return cases;
}

/// How far two headings are apart, from the first measurement on that both track.
class Apart {
 public:
  void add(const RateEstimate& one, const RateEstimate& other) {
    if (one.state != EstimateState::good || other.state != EstimateState::good) return;
    const double off_deg = one.angle_deg - other.angle_deg;
    if (!has_begun_) begin_deg_ = off_deg;
    has_begun_ = true;
    largest_deg_ = std::max(largest_deg_, std::abs(off_deg - begin_deg_));
  }
  double largest_deg() const { return largest_deg_; }

 private:
  bool has_begun_ = false;
  double begin_deg_ = 0.0, largest_deg_ = 0.0;
};

/// Board and product see the same measurements, those that the judge lets them see.
void judge_both(const OdometerRecording& recording, Case& one, std::string& input) {
  estimators::Bank bank(std::vector<std::string>{"odometer"}, std::nullopt, recording.profile);
  tests::BoardOdometer board(recording.profile);
  const HostTime origin = recording.measurements.front().frame.exposure_begin - std::chrono::seconds(1);
  std::vector<RateEstimate> of_product;
  one.product = judge(recording, one.run, [&](const Measurement& seen) {
    return of_product.emplace_back(bank.add(seen).front());
  });
  Apart apart;
  std::size_t place = 0;
  one.board = judge(recording, one.run, [&](const Measurement& seen) {
    if (one.on_board)
      tests::BoardFrame(seen.frame, seen.gyro, recording.profile.gyro, origin).append_to(input);
    const RateEstimate of_board = board.add(seen.frame, seen.gyro);
    apart.add(of_board, of_product.at(place++));
    return of_board;
  });
  one.apart_deg = apart.largest_deg();
}

void run(Case& one) {
  const OdometerRecording recording = record(one.recorded);
  std::string input;
  judge_both(recording, one, input);
  if (!one.on_board) return;
  const auto source = board_odometer::odometer_source(recording.profile, "odometer");
  one.here = tests::run_odometer_on({.compiler = host_compiler}, source, input);
  one.there = tests::run_odometer_on(tests::board_of(tests::cores.front(), qemu_timeout_s), source, input);
  for (const OdometerRun* of : {&one.here, &one.there})
    if (!of->failure.empty()) {
      fmt::print(stderr, "{}\n", of->failure);
      std::exit(1);
    }
}

double difference_deg(const OdometerRun& here, const OdometerRun& there) {
  if (here.frames.size() != there.frames.size()) return std::numeric_limits<double>::infinity();
  double largest = 0.0;
  for (std::size_t i = 0; i < here.frames.size(); ++i) {
    const auto &a = here.frames[i].output, &b = there.frames[i].output;
    largest = std::max(largest,
                       std::abs(360.0 * (a.turns - b.turns) + double{a.heading_deg} - double{b.heading_deg}));
  }
  return largest;
}

std::string key_of(std::string text) {
  for (char& one : text)
    if (std::isalnum(static_cast<unsigned char>(one)) == 0) one = '_';
  return text;
}

class Table {
 public:
  void add(const std::string& section, const std::string& row, const std::string& column,
           const std::string& unit, std::optional<double> value, std::optional<double> at_most = {}) {
    figures_.push_back(
        {section, row, column, key_of(section + " " + row + " " + column), unit, value, at_most, {}, ""});
  }
  const std::vector<Figure>& figures() const { return figures_; }

 private:
  std::vector<Figure> figures_;
};

void add_board(Table& table, const std::vector<Case>& cases) {
  const std::string section = "On a Cortex-M4F in QEMU";
  for (const Case& one : cases) {
    if (!one.on_board) continue;
    std::vector<std::uint32_t> counts;
    std::array<std::uint32_t, 4> worst{};  // by state
    std::uint32_t stack_bytes = 0;
    for (const OdometerRun::Frame& frame : one.there.frames) {
      counts.push_back(frame.instructions);
      auto& of_state = worst.at(static_cast<std::size_t>(frame.output.state));
      of_state = std::max(of_state, frame.instructions);
      stack_bytes = std::max(stack_bytes, frame.stack_bytes);
    }
    std::sort(counts.begin(), counts.end());
    const auto ram = static_cast<double>(one.there.state_bytes);
    table.add(section, one.name, "flash", "B", static_cast<double>(one.there.flash_bytes));
    table.add(section, one.name, "state", "B", ram);
    table.add(section, one.name, "stack", "B", stack_bytes);
    table.add(section, one.name, "RAM", "B", ram + stack_bytes, 40'000.0);
    table.add(section, one.name, "median", "instructions a frame", counts[counts.size() / 2]);
    table.add(section, one.name, "worst", "instructions a frame", counts.back(), 10.5e6);
    table.add(section, one.name, "starting", "at most", worst[THERMORIG_ODOMETER_STARTING]);
    table.add(section, one.name, "tracking", "at most", worst[THERMORIG_ODOMETER_TRACKING]);
    table.add(section, one.name, "relocalising", "at most", worst[THERMORIG_ODOMETER_RELOCALISING]);
    table.add(section, one.name, "frames", "", static_cast<double>(counts.size()));
    table.add(section, one.name, "from this machine's", "deg", difference_deg(one.here, one.there), 0.01);
  }
}

void add_accuracy(Table& table, const std::vector<Case>& cases) {
  const std::string section = "Against the true shaft";
  for (const Case& one : cases) {
    if (!one.is_plain) continue;
    table.add(section, one.name, "tracks after", "s", one.board.tracked_after_s);
    table.add(section, one.name, "worst angle", "deg",
              one.board.tracked_after_s ? std::optional(one.board.worst_deg) : std::nullopt, 2.0);
    table.add(section, one.name, "spread", "deg", one.board.spread_deg);
    table.add(section, one.name, "drift", "deg/min", std::abs(one.board.drift_deg_per_min));
    table.add(section, one.name, "wrong and silent", "s", one.board.silent_s, 5.0);
    table.add(section, one.name, "product: tracks after", "s", one.product.tracked_after_s);
    table.add(section, one.name, "product: worst angle", "deg", one.product.worst_deg);
    table.add(section, one.name, "from the product's", "deg", one.apart_deg);
  }
}

/// Median and largest of those that track.
void add_summary(Table& table, const std::vector<Case>& cases, const std::string& start) {
  std::vector<double> after, worst, apart, product;
  double all = 0.0;
  for (const Case& one : cases) {
    if (!one.is_plain || !one.name.ends_with(start)) continue;
    all += 1.0;
    product.push_back(one.product.worst_deg);
    if (!one.board.tracked_after_s) continue;
    after.push_back(*one.board.tracked_after_s);
    worst.push_back(one.board.worst_deg);
    apart.push_back(one.apart_deg);
  }
  const std::string section = "All of them";
  table.add(section, start, "never track", "", all - static_cast<double>(after.size()), 0.0);
  const auto add = [&](const std::string& name, const std::string& unit, std::vector<double>& values,
                       std::optional<double> at_most) {
    std::sort(values.begin(), values.end());
    if (values.empty()) return;
    table.add(section, start, name + ", median", unit, values[values.size() / 2]);
    table.add(section, start, name + ", most", unit, values.back(), at_most);
  };
  add("tracks after", "s", after, {});
  add("worst angle", "deg", worst, 2.0);
  add("product's worst angle", "deg", product, {});
  add("from the product's", "deg", apart, {});
}

}  // namespace
}  // namespace thermorig::bench

int main(int count, char** arguments) {
  using namespace thermorig::bench;
  const auto options = table_options(count, arguments, "export_odometer [--json] [--first-seed N] [--quick]");
  if (!options) return 2;
  std::vector<Case> cases = cases_of(*options);
  thermorig::on_all_cores(cases.size(), [&](std::size_t i) { run(cases[i]); });
  Table table;
  add_board(table, cases);
  add_summary(table, cases, "in motion");
  add_summary(table, cases, "at rest");
  add_accuracy(table, cases);
  if (options->json) {
    print_json(table.figures());
    return 0;
  }
  fmt::print("Simulated rigs in virtual time, plan \"paper\", raw gyro, causal clocks; from seed {} on.\n",
             options->first_seed);
  print_text(table.figures());
  return 0;
}
