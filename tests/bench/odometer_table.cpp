// SPDX-License-Identifier: MIT
// How the odometer does on simulated rigs in virtual time, against the true shaft.
// Usage: odometer_table [--json] [--first-seed N] [--quick] [--only TEXT]
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "odometer_judge.h"
#include "odometer_lens.h"
#include "odometer_recording.h"
#include "odometer_stresses.h"
#include "thermorig/core/run_all.h"
#include "timing_figures.h"

namespace thermorig::bench {
namespace {

const std::array<std::string, 4> environments{"laboratory", "dining", "kitchen", "garden"};
constexpr double in_motion_s = 12.0;  // after the opening rest, in the first leg

struct Row {
  std::string name;
  OdometerCase recorded;
  Stress stress;
  bool is_plain = false, is_hour = false, is_typical = false, is_lens = false;
  Judgement judgement;
  StepTimes steps;      // of a row that is plain, or an hour
  CalibratedLens lens;  // of a row that begins with `calibrate lens`
};

std::string key_of(std::string text) {
  for (char& one : text)
    if (std::isalnum(static_cast<unsigned char>(one)) == 0) one = '_';
  return text;
}

void add(std::vector<Figure>& figures, const std::string& section, const std::string& row,
         const std::string& column, const std::string& unit, std::optional<double> value,
         std::optional<double> at_most = {}, std::optional<double> at_least = {}) {
  figures.push_back(
      {section, row, column, key_of(section + " " + row + " " + column), unit, value, at_most, at_least, ""});
}

void add_common(std::vector<Figure>& figures, const std::string& section, const Row& row, double worst_deg) {
  const Judgement& of = row.judgement;
  add(figures, section, row.name, "tracks after", "s", of.tracked_after_s);
  add(figures, section, row.name, "not tracking", "%", 100.0 * of.not_tracked);
  add(figures, section, row.name, "worst angle", "deg", of.worst_deg, worst_deg);
  add(figures, section, row.name, "spread", "deg", of.spread_deg);
  add(figures, section, row.name, "coverage", "", of.coverage);
  add(figures, section, row.name, "NIS", "", of.mean_nis);
}

void add_plain(std::vector<Figure>& figures, const Row& row) {
  const Judgement& of = row.judgement;
  const std::string section = "Honest world";
  add_common(figures, section, row, 2.0);
  figures[figures.size() - 3].at_most = 0.25;
  add(figures, section, row.name, "drift", "deg/min", of.drift_deg_per_min);
  figures.back().value = std::abs(of.drift_deg_per_min);
  figures.back().at_most = 0.05;
  add(figures, section, row.name, "rate, steady", "deg/s", of.steady_rate_rmse_dps, 0.06);
  add(figures, section, row.name, "rate, all", "deg/s", of.rate_rmse_dps, 0.12);
  add(figures, section, row.name, "rate coverage", "", of.rate_coverage);
  add(figures, section, row.name, "step, median", "us", row.steps.median_us, 300.0);
  add(figures, section, row.name, "step, worst", "us", row.steps.worst_us, 5000.0);
}

void add_mean(std::vector<Figure>& figures, const std::vector<Row>& rows) {
  double count = 0.0, coverage = 0.0, nis = 0.0, tracking = 0.0;
  for (const Row& row : rows) {
    if (!row.is_plain) continue;
    count += 1.0;
    coverage += row.judgement.coverage;
    nis += row.judgement.mean_nis;
    tracking += row.judgement.tracked_after_s && *row.judgement.tracked_after_s <= 30.0 ? 1.0 : 0.0;
  }
  if (count == 0.0) return;
  const std::string section = "Honest world, all";
  add(figures, section, "mean", "coverage", "", coverage / count, 1.0, 0.85);
  add(figures, section, "mean", "NIS", "", nis / count, 1.3, 0.4);
  add(figures, section, "mean", "track within 30 s", "%", 100.0 * tracking / count);
}

void add_stress(std::vector<Figure>& figures, const Row& row) {
  const Judgement& of = row.judgement;
  const std::string section = "Stresses";
  add_common(figures, section, row, row.stress.worst_deg);
  figures[figures.size() - 5].at_most = 33.3;  // not tracking
  add(figures, section, row.name, "wrong and silent", "s", of.silent_s, 5.0);
  if (of.last) {
    add(figures, section, row.name, "rows found", "", of.last->rows == row.stress.rows ? 1.0 : 0.0, {}, 1.0);
    add(figures, section, row.name, "margin of rows", "", of.last->row_margin);
  }
  if (!row.stress.run.harm_begin_s) return;
  add(figures, section, row.name, "said after", "s", of.said_after_s, 5.0);
  add(figures, section, row.name, "back after", "s", of.back_after_s, 10.0);
  add(figures, section, row.name, "then within", "deg", of.back_deg, 2.0);
}

void add_hour(std::vector<Figure>& figures, const Row& row) {
  const Judgement& of = row.judgement;
  const std::string section = "An hour";
  add(figures, section, row.name, "not tracking", "%", 100.0 * of.not_tracked);
  add(figures, section, row.name, "worst angle", "deg", of.worst_deg);
  add(figures, section, row.name, "worst 2 minutes, RMSE", "deg", of.worst_two_minutes_deg, 0.7);
  add(figures, section, row.name, "drift", "deg/min", std::abs(of.drift_deg_per_min), 0.05);
  add(figures, section, row.name, "coverage", "", of.coverage);
  add(figures, section, row.name, "step, median", "us", row.steps.median_us, 300.0);
  add(figures, section, row.name, "last steps / early steps", "", row.steps.slower, 1.2);
}

/// What `calibrate lens` found of what was to be found. `is_held`: limits are meant.
void add_lens(std::vector<Figure>& figures, const std::string& section, const Row& row, bool is_held) {
  const CalibratedLens& lens = row.lens;
  add(figures, section, row.name, "refused", "", lens.result ? 0.0 : 1.0);
  if (!lens.result) return;
  const auto limit = [&](double most) { return is_held ? std::optional(most) : std::nullopt; };
  const Estimate& pitch = lens.result->pitch_scale;
  const double off = std::abs(pitch.value - lens.pitch_scale);
  add(figures, section, row.name, "pitch off", "%", 100.0 * off, limit(0.5));
  add(figures, section, row.name, "stated", "%", 100.0 * pitch.uncertainty, limit(0.5));
  add(figures, section, row.name, "off / stated", "", off / pitch.uncertainty, limit(3.0));
  if (!lens.result->distortion) return;
  const Estimate& distortion = *lens.result->distortion;
  const double corners_off = std::abs(distortion.value - lens.distortion);
  add(figures, section, row.name, "distortion off", "%", 100.0 * corners_off);
  add(figures, section, row.name, "distortion off / stated", "", corners_off / distortion.uncertainty,
      limit(3.0));
}

bool is_within(const Judgement& of) {
  return of.tracked_after_s && of.worst_deg <= 3.0 && std::abs(of.drift_deg_per_min) <= 0.1;
}

void add_typical(std::vector<Figure>& figures, const std::vector<Row>& rows) {
  const std::string section = "World typical";
  double count = 0.0, within = 0.0, silent = 0.0, never = 0.0, refused = 0.0;
  for (const Row& row : rows) {
    if (!row.is_typical) continue;
    const Judgement& of = row.judgement;
    count += 1.0;
    within += is_within(of) ? 1.0 : 0.0;
    never += of.tracked_after_s ? 0.0 : 1.0;
    silent += of.silent_s > 5.0 ? 1.0 : 0.0;
    add(figures, section, row.name, "tracks after", "s", of.tracked_after_s);
    add(figures, section, row.name, "not tracking", "%", 100.0 * of.not_tracked);
    add(figures, section, row.name, "worst angle", "deg", of.worst_deg);
    add(figures, section, row.name, "drift", "deg/min", std::abs(of.drift_deg_per_min));
    add(figures, section, row.name, "coverage", "", of.coverage);
    add(figures, section, row.name, "wrong and silent", "s", of.silent_s, 5.0);
    refused += row.lens.result ? 0.0 : 1.0;
    add_lens(figures, section, row, false);
  }
  if (count == 0.0) return;
  add(figures, section + ", all", "share", "lens refused", "%", 100.0 * refused / count);
  add(figures, section + ", all", "share", "within 3 deg and 0.1 deg/min", "%", 100.0 * within / count, {},
      90.0);
  add(figures, section + ", all", "share", "never track", "%", 100.0 * never / count);
  add(figures, section + ", all", "share", "wrong and silent", "%", 100.0 * silent / count, 0.0);
}

/// Lenses by which the honest world is seen: what pitch and distortion may be off, and a camera that leans.
void add_lens_rows(std::uint64_t first_seed, std::vector<Row>& rows) {
  struct Lens {
    const char* knobs;
    double field_of_view_deg = 55.0;
  };
  constexpr std::array<Lens, 6> lenses{
      {{"camera.pitch_error=0"},
       {"camera.pitch_error=0.03"},
       {"camera.pitch_error=-0.02,camera.distortion=0.05"},
       {"camera.pitch_error=0.01,camera.distortion=-0.05,camera.rolling_rows=-1"},
       {"camera.pitch_error=-0.03,camera.distortion=0.02,camera.tilt_deg=4,camera.roll_deg=-3"},
       {"camera.pitch_error=0.02,camera.distortion=-0.03", 110.0}}};
  for (const Lens& lens : lenses)
    for (const std::string& environment : environments) {
      Row row;
      row.is_lens = true;
      row.recorded = {.seed = first_seed + 300 + rows.size(),
                      .environment = environment,
                      .world = std::string("honest,") + lens.knobs,
                      .field_of_view_deg = lens.field_of_view_deg};
      std::string knobs = lens.knobs;
      for (auto at = knobs.find("camera."); at != std::string::npos; at = knobs.find("camera."))
        knobs.erase(at, 7);
      row.name = fmt::format("lens {:g}, {}, {}", lens.field_of_view_deg, knobs, environment);
      rows.push_back(row);
    }
}

/// 24 rigs of the world `typical`, and one that runs for an hour.
void add_long_rows(std::uint64_t first_seed, std::vector<Row>& rows) {
  for (std::size_t i = 0; i < 24; ++i) {
    Row row;
    row.recorded = {.seed = first_seed + 100 + i, .environment = environments[i % 4], .world = "typical"};
    row.stress.run.from_s = in_motion_s;
    row.is_typical = true;
    row.name = fmt::format("typical {} {}", row.recorded.environment, row.recorded.seed);
    rows.push_back(row);
  }
  Row hour;
  hour.recorded = {.seed = first_seed + 200, .environment = "dining", .duration_s = 3600.0};
  hour.stress.run.from_s = in_motion_s;
  hour.is_hour = true;
  hour.name = fmt::format("60 minutes, dining {}", hour.recorded.seed);
  rows.push_back(hour);
}

std::vector<Row> rows_of(const TableOptions& options) {
  std::vector<Row> rows;
  const std::size_t gyros = options.quick ? 1 : 6;
  for (std::size_t gyro = 0; gyro < gyros; ++gyro)
    for (const std::string& environment : environments) {
      Row row;
      row.recorded.seed = options.first_seed + rows.size();
      row.recorded.environment = environment;
      row.stress.run.from_s = in_motion_s;
      row.is_plain = true;
      row.name = fmt::format("{} {}", environment, row.recorded.seed);
      rows.push_back(row);
    }
  if (options.quick) return rows;
  const std::uint64_t after = options.first_seed + rows.size();
  for (std::size_t at = 0; at < odometer_stresses().size(); ++at)
    for (std::size_t i = 0; i < environments.size(); ++i) {
      Row row;
      const Stress stress = odometer_stresses()[at];  // of its own: it remembers what it did to the room
      row.stress = stress;
      row.recorded = {.seed = after + i,
                      .environment = environments[i],
                      .world = stress.world,
                      .field_of_view_deg = stress.field_of_view_deg};
      row.name = fmt::format("{}, {}", stress.name, environments[i]);
      rows.push_back(row);
    }
  add_long_rows(options.first_seed, rows);
  add_lens_rows(options.first_seed, rows);
  return rows;
}

void judge_row(const OdometerRecording& recording, BeginJudged begin, Row& row) {
  const JudgedRun& run = row.stress.run;
  row.judgement = judge(recording, run, begin(recording));
  if (row.is_plain || row.is_hour) row.steps = time_steps(recording, run.from_s, begin);
}

}  // namespace
}  // namespace thermorig::bench

int main(int count, char** arguments) {
  using namespace thermorig::bench;
  const auto options =
      table_options(count, arguments, "odometer_table [--json] [--first-seed N] [--quick] [--only TEXT]");
  if (!options) return 2;
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Row> rows = rows_of(*options);
  std::erase_if(rows, [&](const Row& row) { return row.name.find(options->only) == std::string::npos; });
  thermorig::on_all_cores(rows.size(), [&](std::size_t i) {
    Row& row = rows[i];
    if (row.is_lens || row.is_typical) row.lens = calibrate_lens(row.recorded);
    if (row.is_lens) return;
    if (row.is_typical) row.recorded.calibrated = row.lens.profile;
    judge_row(record(row.recorded), odometer_of, row);
  });
  std::vector<Figure> figures;
  for (const Row& row : rows) {
    if (row.is_plain) add_plain(figures, row);
    if (row.is_lens) add_lens(figures, "Lens", row, true);
    if (!row.is_plain && !row.is_hour && !row.is_typical && !row.is_lens) add_stress(figures, row);
  }
  add_mean(figures, rows);
  for (const Row& row : rows)
    if (row.is_hour) add_hour(figures, row);
  add_typical(figures, rows);
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (options->json) {
    print_json(figures);
    return 0;
  }
  fmt::print(
      "Simulated rigs in virtual time, plan \"paper\", raw gyro, causal clocks; from seed {} on; made in "
      "{:.0f} s.\n",
      options->first_seed, took_s);
  print_text(figures);
  return 0;
}
