// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "servo_link.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/profile/toml_table.h"
#include "thermorig/rig/profile/toml_text.h"

namespace thermorig::rig {

namespace {

constexpr double rate_limit_dps = SERVO_LIMIT_RATE_CDPS / 100.0;
constexpr double smallest_rate_dps = 0.01;  // the link counts hundredths
constexpr double rest_limit_s = 3600.0;
constexpr int frames_limit = 1'000'000;
constexpr std::size_t legs_limit = 65'535;  // each has a number of 16 bits in the servo's telemetry

enum class SpeedOrder : std::uint8_t { seeded, ascending, descending, given };

/// A plan before its legs are laid out.
struct Draft {
  std::string name;
  std::vector<double> magnitudes_dps;
  SpeedOrder order = SpeedOrder::seeded;
  bool both_directions = true;
  int frames_per_leg = 57;
  std::optional<int> valid_per_leg;
  bool for_calibration = false;
  double opening_rest_s = 10.0;
  double closing_rest_s = 10.0;
  std::uint64_t seed = 1;
};

// SplitMix64 (Steele, Lea, Flood 2014). The library's own shuffle differs between implementations.
std::uint64_t next_random(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15U;
  std::uint64_t mixed = state;
  mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9U;
  mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBU;
  return mixed ^ (mixed >> 31U);
}

void shuffle(std::vector<double>& values, std::uint64_t seed) {
  for (std::size_t left = values.size(); left > 1; --left)
    std::swap(values[left - 1], values[next_random(seed) % left]);
}

std::vector<double> evenly_spaced(double min, double max, double step) {
  std::vector<double> values;
  const int count = static_cast<int>(std::floor((max - min) / step + 1e-9)) + 1;
  for (int i = 0; i < count; ++i) values.push_back(min + i * step);
  return values;
}

void put_in_order(std::vector<double>& magnitudes, SpeedOrder order, std::uint64_t seed) {
  if (order == SpeedOrder::given) return;
  std::sort(magnitudes.begin(), magnitudes.end());
  if (order == SpeedOrder::descending) std::reverse(magnitudes.begin(), magnitudes.end());
  if (order == SpeedOrder::seeded) shuffle(magnitudes, seed);
}

SweepPlan lay_out(Draft draft) {
  put_in_order(draft.magnitudes_dps, draft.order, draft.seed);
  SweepPlan plan{.name = draft.name,
                 .leg_rates_dps = {},
                 .frames_per_leg = draft.frames_per_leg,
                 .valid_per_leg = draft.valid_per_leg.value_or(default_valid_per_leg(draft.frames_per_leg)),
                 .for_calibration = draft.for_calibration,
                 .opening_rest_s = draft.opening_rest_s,
                 .closing_rest_s = draft.closing_rest_s,
                 .seed = draft.seed};
  for (const double magnitude : draft.magnitudes_dps) {
    plan.leg_rates_dps.push_back(magnitude);
    if (draft.both_directions) plan.leg_rates_dps.push_back(-magnitude);
  }
  return plan;
}

[[noreturn]] void refuse_override(const std::string& what, const std::string& advice) {
  throw Error(ExitCode::bad_usage, what, "the plan's options", advice);
}

void apply(Draft& draft, const PlanOverrides& overrides) {
  for (const double magnitude : overrides.magnitudes_dps) {
    if (!(magnitude >= smallest_rate_dps && magnitude <= rate_limit_dps))
      refuse_override(fmt::format("a speed of {} deg/s cannot be driven", magnitude),
                      fmt::format("speeds from {} to {} deg/s, e.g. --speeds 30,60,90", smallest_rate_dps,
                                  rate_limit_dps));
  }
  if (!overrides.magnitudes_dps.empty()) {
    draft.magnitudes_dps = overrides.magnitudes_dps;
    draft.both_directions = true;
  }
  draft.frames_per_leg = overrides.frames_per_leg.value_or(draft.frames_per_leg);
  if (overrides.valid_per_leg) draft.valid_per_leg = overrides.valid_per_leg;
  draft.opening_rest_s = overrides.opening_rest_s.value_or(draft.opening_rest_s);
  draft.closing_rest_s = overrides.closing_rest_s.value_or(draft.closing_rest_s);
  draft.seed = overrides.seed.value_or(draft.seed) & INT64_MAX;  // TOML knows signed numbers only
  if (draft.frames_per_leg < 1 || draft.frames_per_leg > frames_limit)
    refuse_override(fmt::format("{} frames a leg", draft.frames_per_leg),
                    fmt::format("1 to {}", frames_limit));
  if (draft.valid_per_leg.value_or(0) < 0 || draft.valid_per_leg.value_or(0) > frames_limit)
    refuse_override(fmt::format("{} valid frames a leg", *draft.valid_per_leg),
                    fmt::format("0 (no quota) to {}", frames_limit));
  for (const double rest_s : {draft.opening_rest_s, draft.closing_rest_s}) {
    if (!(rest_s >= 0.0 && rest_s <= rest_limit_s))
      refuse_override(fmt::format("a rest of {} s", rest_s), fmt::format("0 to {} s", rest_limit_s));
  }
}

// The paper's magnitudes: 20..200 deg/s in steps of 7.5, both directions: 50 speeds.
Draft paper_draft(const std::string& name, int frames_per_leg) {
  Draft draft;
  draft.name = name;
  draft.magnitudes_dps = evenly_spaced(20.0, 200.0, 7.5);
  draft.frames_per_leg = frames_per_leg;
  return draft;
}

Draft quick_draft() {
  Draft draft;
  draft.name = "quick";
  draft.magnitudes_dps = {30.0, 90.0, 150.0};
  draft.frames_per_leg = 30;
  draft.opening_rest_s = 2.0;
  draft.closing_rest_s = 2.0;
  return draft;
}

std::optional<Draft> built_in_draft(const std::string& name, const std::string& environment) {
  if (name == "paper") return paper_draft(name, 57);
  // Table I of the paper: 61 frames a speed indoors, 51 in the garden.
  if (name == "table-one") return paper_draft(name, environment == "garden" ? 51 : 61);
  if (name == "quick") return quick_draft();
  return std::nullopt;
}

/// Speeds as a file gives them: legs with their signs, or magnitudes.
struct Speeds {
  std::vector<double> legs_dps;
  std::vector<double> magnitudes_dps;
};

Speeds read_speeds(TomlTable& file) {
  const std::string allowed = "leg_rates_dps, magnitudes_dps, or min_dps with max_dps and step_dps";
  const auto legs = file.numbers("leg_rates_dps", -rate_limit_dps, rate_limit_dps, legs_limit);
  const auto magnitudes = file.numbers("magnitudes_dps", smallest_rate_dps, rate_limit_dps, legs_limit);
  const auto min = file.number("min_dps", smallest_rate_dps, rate_limit_dps);
  const auto max = file.number("max_dps", smallest_rate_dps, rate_limit_dps);
  const auto step = file.number("step_dps", smallest_rate_dps, rate_limit_dps);
  const bool spaced = min || max || step;
  if (int{legs.has_value()} + int{magnitudes.has_value()} + int{spaced} > 1)
    file.refuse(legs ? "leg_rates_dps" : "magnitudes_dps", "speeds are given twice", "one of: " + allowed);
  if (spaced && (!min || !max || !step || *min > *max))
    file.refuse("min_dps", "the range of speeds is not whole",
                "min_dps, max_dps (not below it) and step_dps");
  if (legs && std::count(legs->begin(), legs->end(), 0.0) > 0)
    file.refuse("leg_rates_dps", "a leg with speed 0", "rests are opening_rest_s and closing_rest_s");
  return {legs.value_or(std::vector<double>{}),
          spaced ? evenly_spaced(*min, *max, *step) : magnitudes.value_or(std::vector<double>{})};
}

Draft read_draft(TomlTable& file, std::uint64_t seed) {
  Draft draft;
  draft.name = file.text("name").value_or("unnamed");
  if (const auto order = file.choice("order", {"seeded", "ascending", "descending", "given"}))
    draft.order = static_cast<SpeedOrder>(*order);
  draft.both_directions = file.boolean("both_directions").value_or(true);
  draft.frames_per_leg =
      static_cast<int>(file.integer("frames_per_leg", 1, frames_limit).value_or(draft.frames_per_leg));
  if (const auto valid = file.integer("valid_per_leg", 0, frames_limit))
    draft.valid_per_leg = static_cast<int>(*valid);
  draft.for_calibration = file.boolean("for_calibration").value_or(false);
  draft.opening_rest_s = file.number("opening_rest_s", 0.0, rest_limit_s).value_or(draft.opening_rest_s);
  draft.closing_rest_s = file.number("closing_rest_s", 0.0, rest_limit_s).value_or(draft.closing_rest_s);
  constexpr std::int64_t seed_limit = INT64_MAX;
  draft.seed = static_cast<std::uint64_t>(
      file.integer("seed", 0, seed_limit).value_or(static_cast<std::int64_t>(seed & INT64_MAX)));
  return draft;
}

}  // namespace

const std::vector<std::string>& built_in_plan_names() {
  static const std::vector<std::string> names{"paper", "table-one", "quick"};
  return names;
}

// Its first frames lie in a ramp or settle after it, the last one may lie in the next ramp: at 200 deg/s and
// 8 frames/s that is at most 7.
int default_valid_per_leg(int frames_per_leg) {
  constexpr int most = 50;
  constexpr int lost_at_the_ends = 7;
  return std::clamp(frames_per_leg - lost_at_the_ends, 0, most);
}

SweepPlan parse_plan(const std::string& text, const std::string& file_name, std::uint64_t seed,
                     const PlanOverrides& overrides) {
  TomlTable file = TomlTable::parse(text, file_name);
  Draft draft = read_draft(file, seed);
  Speeds speeds = read_speeds(file);
  file.refuse_unknown();
  draft.magnitudes_dps = speeds.magnitudes_dps;
  apply(draft, overrides);
  SweepPlan plan = lay_out(draft);
  if (overrides.magnitudes_dps.empty() && !speeds.legs_dps.empty()) plan.leg_rates_dps = speeds.legs_dps;
  if (plan.leg_rates_dps.empty() && !plan.for_calibration)
    file.refuse("", "the plan has no speeds",
                "leg_rates_dps, magnitudes_dps, or min_dps, max_dps and step_dps");
  if (plan.leg_rates_dps.size() > legs_limit)
    file.refuse("", fmt::format("the plan has {} legs", plan.leg_rates_dps.size()),
                fmt::format("at most {}: fewer speeds, or both_directions = false", legs_limit));
  return plan;
}

SweepPlan load_plan(const std::string& name_or_file, const std::string& environment, std::uint64_t seed,
                    const PlanOverrides& overrides) {
  if (auto draft = built_in_draft(name_or_file, environment)) {
    draft->seed = seed;
    apply(*draft, overrides);
    return lay_out(*draft);
  }
  if (!std::filesystem::exists(name_or_file))
    throw Error(ExitCode::bad_usage, "no such sweep plan", name_or_file,
                fmt::format("one of: {}, or a TOML file", fmt::join(built_in_plan_names(), ", ")));
  return parse_plan(read_text_file(name_or_file, "sweep plan"), name_or_file, seed, overrides);
}

SweepPlan by_hand_plan(std::optional<double> seconds) {
  SweepPlan plan;
  plan.name = "by-hand";
  plan.valid_per_leg = 0;
  plan.opening_rest_s = seconds.value_or(longest_by_hand_s);
  plan.closing_rest_s = 0.0;
  return plan;
}

std::string to_toml(const SweepPlan& plan) {
  return fmt::format(
      "name = {}\nframes_per_leg = {}\nvalid_per_leg = {}\n{}opening_rest_s = {}\nclosing_rest_s = {}\n"
      "seed = {}\nleg_rates_dps = [{}]\n",
      toml_quoted(plan.name), plan.frames_per_leg, plan.valid_per_leg,
      plan.for_calibration ? "for_calibration = true\n" : "", plan.opening_rest_s, plan.closing_rest_s,
      plan.seed, fmt::join(plan.leg_rates_dps, ", "));
}

}  // namespace thermorig::rig
