// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "servo_link.h"
#include "thermorig/core/error.h"
#include "thermorig/core/nearest_name.h"
#include "thermorig/rig/profile/toml_table.h"
#include "thermorig/rig/profile/toml_text.h"
#include "thermorig/sensors/device_stream.h"

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
  if (spaced && (!min || !max || !step))
    file.refuse("min_dps", "the range of speeds is incomplete", "min_dps, max_dps and step_dps");
  if (spaced && *min > *max) file.refuse("max_dps", "it is below min_dps", "min_dps is the lowest speed");
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
                advice_on_name(name_or_file, built_in_plan_names()) + ", or a TOML file");
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

LinkLoad link_load(Device device, const RigProfile& profile) {
  const sensors::DeviceStream stream = sensors::device_stream(device, profile);
  return {stream.message_bytes, stream.rate_hz};
}

std::uint64_t expected_journal_bytes(const SweepPlan& plan, const RigProfile& profile) {
  constexpr double record_bytes = 40.0;      // the journal's own, of each chunk
  constexpr double chunks_per_frame = 50.0;  // a frame comes in parts of 32 bytes or more
  constexpr double sent_hz = 30.0;           // refreshes, pings and commands to the servo a second
  constexpr double sent_bytes = 32.0;        // of one, at most
  const LinkLoad camera = link_load(Device::camera, profile);
  const LinkLoad gyro = link_load(Device::gyro, profile);
  const LinkLoad servo = link_load(Device::servo, profile);
  const double received_per_s = camera.bytes_per_s() + gyro.bytes_per_s() + servo.bytes_per_s();
  const double chunks_per_s = chunks_per_frame * camera.rate_hz + gyro.rate_hz + servo.rate_hz + sent_hz;
  const double bytes_per_s = received_per_s + sent_hz * sent_bytes + record_bytes * chunks_per_s;
  const double duration_s = plan_duration_s(plan, profile.servo, profile.camera.output_rate_hz);
  return static_cast<std::uint64_t>(bytes_per_s * (1.2 * duration_s + 10.0));
}

std::uint64_t session_bytes_beside(std::uint64_t journal_bytes) {
  return journal_bytes / 2;
}

std::uint64_t expected_recording_bytes(const SweepPlan& plan, const RigProfile& profile) {
  const std::uint64_t journal_bytes = expected_journal_bytes(plan, profile);
  return journal_bytes + session_bytes_beside(journal_bytes);
}

namespace {

constexpr double endless = std::numeric_limits<double>::infinity();
// How far the shaft's speed may leave the commanded one in a valid frame: reason servo_ramp.
constexpr double tolerance_least_dps = 1.0;
constexpr double tolerance_share = 0.02;

// Two refresh periods: a half-fresh frame holds halves that were exposed one after the other.
double exposure_s(double frame_rate_hz) {
  return 2.0 / frame_rate_hz;
}

double ramps_deg(double rate_dps, const ServoProfile& servo) {
  return rate_dps * rate_dps / servo.acceleration_dps2;  // one at either end
}

/// The servo's own loop, of second order with damping 0.7, at its end of a ramp.
class Loop {
 public:
  explicit Loop(const ServoProfile& servo)
      : acceleration_dps2_(servo.acceleration_dps2), loop_rad_(2.0 * std::numbers::pi * servo.loop_hz) {}

  /// How far the shaft's speed is behind, `t` seconds after the end of a ramp that was long.
  double error_dps(double t) const {
    const double oscillation_rad = loop_rad_ * std::sqrt(1.0 - damping * damping);
    const double lag_s = 2.0 * damping / loop_rad_;
    const double swing_s = (2.0 * damping * damping - 1.0) / oscillation_rad;
    return acceleration_dps2_ * std::exp(-damping * loop_rad_ * t) *
           (lag_s * std::cos(oscillation_rad * t) + swing_s * std::sin(oscillation_rad * t));
  }

  /// What the shaft's speed has changed by, `t` seconds after the begin of a ramp.
  double drop_dps(double t) const { return acceleration_dps2_ * t - (error_dps(0.0) - error_dps(t)); }

 private:
  static constexpr double damping = 0.7;
  double acceleration_dps2_;
  double loop_rad_;
};
constexpr double loop_step_s = 0.001;

std::array<SpeedYield::Windows, window_frames_max> windows_of(const ExpectedLeg& leg,
                                                              const ServoProfile& servo,
                                                              double frame_rate_hz) {
  std::array<SpeedYield::Windows, window_frames_max> all;
  for (int frames = 1; frames <= window_frames_max; ++frames) {
    SpeedYield::Windows& windows = all[static_cast<std::size_t>(frames - 1)];
    const LegYield yield = leg_yield(leg.course, leg.frames, frames, frame_rate_hz);
    windows.sweep =
        windows_within(sweep_constant_s(leg.rate_dps, servo), leg.course.settling_s, frames, frame_rate_hz);
    windows.leg = yield.own + yield.other;
    windows.travel_deg = window_travel_deg(leg.rate_dps, frames, servo, frame_rate_hz);
    windows.possible = windows.travel_deg <= stroke_deg(servo);
  }
  return all;
}

}  // namespace

double window_s(int frames, const ServoProfile& servo, double frame_rate_hz) {
  return servo.settle_s + exposure_s(frame_rate_hz) + (frames - 1) / frame_rate_hz;
}

double window_travel_deg(double rate_dps, int frames, const ServoProfile& servo, double frame_rate_hz) {
  return std::abs(rate_dps) * window_s(frames, servo, frame_rate_hz) + ramps_deg(rate_dps, servo);
}

double sweep_constant_s(double rate_dps, const ServoProfile& servo) {
  return std::max(0.0, stroke_deg(servo) - ramps_deg(rate_dps, servo)) / std::abs(rate_dps);
}

// Where a ramp ends, what the loop lags behind dies away; where the next one begins, the shaft keeps the
// speed for a little longer. A pure delay shifts both alike.
double settling_s(double rate_dps, const ServoProfile& servo) {
  const Loop loop(servo);
  const double tolerance_dps = std::max(tolerance_least_dps, tolerance_share * std::abs(rate_dps));
  const double ramp_s = 2.0 * std::abs(rate_dps) / servo.acceleration_dps2;  // a reversal's
  double settled_s = 0.0, kept_s = 0.0;
  for (double t = 0.0; t < servo.settle_s; t += loop_step_s) {
    if (std::abs(loop.error_dps(t) - loop.error_dps(t + ramp_s)) > tolerance_dps) settled_s = t + loop_step_s;
    if (loop.drop_dps(t) <= tolerance_dps) kept_s = t;
  }
  return std::clamp(settled_s - kept_s, 0.0, servo.settle_s);
}

// Frames come every period at a phase that is not known: on average so many begin early enough to end in
// time.
double windows_within(double constant_s, double settling_s, int frames, double frame_rate_hz) {
  const double needed_s = settling_s + exposure_s(frame_rate_hz) + (frames - 1) / frame_rate_hz;
  return std::max(0.0, (constant_s - needed_s) * frame_rate_hz);
}

bool LegCourse::turns_back() const {
  return std::isfinite(constant_s);
}

LegCourse leg_course(double rate_dps, double before_dps, double frames, const ServoProfile& servo,
                     double frame_rate_hz) {
  const double acceleration_dps2 = servo.acceleration_dps2;
  const double settle = settling_s(rate_dps, servo);
  if (leg_travel_deg(rate_dps, frames, frame_rate_hz, acceleration_dps2) <= stroke_deg(servo))
    return {std::abs(rate_dps - before_dps) / acceleration_dps2, settle, endless, 0.0};
  const double ramp_s = std::abs(rate_dps) / acceleration_dps2;
  return {ramp_s, settle, sweep_constant_s(rate_dps, servo), 2.0 * ramp_s};
}

LegYield leg_yield(const LegCourse& course, double frames, int window_frames, double frame_rate_hz) {
  const double driven_s = std::max(0.0, frames / frame_rate_hz - course.ramp_s);
  const auto windows = [&](double constant_s) {
    return windows_within(constant_s, course.settling_s, window_frames, frame_rate_hz);
  };
  if (!course.turns_back()) return {windows(driven_s), 0.0};
  const double stroke_s = course.constant_s + course.reversal_s;
  const double whole = std::floor(driven_s / stroke_s);
  const double each = windows(course.constant_s);
  const double last = windows(std::min(course.constant_s, driven_s - whole * stroke_s));
  LegYield yield{each * std::ceil(whole / 2.0), each * std::floor(whole / 2.0)};
  (std::fmod(whole, 2.0) == 0.0 ? yield.own : yield.other) += last;
  return yield;
}

double frames_for(double valid, const LegCourse& course, double frame_rate_hz) {
  if (valid <= 0.0) return 0.0;
  double before_s = course.ramp_s;
  if (course.turns_back()) {
    const double each = windows_within(course.constant_s, course.settling_s, 1, frame_rate_hz);
    if (each <= 0.0) return endless;
    const double whole = std::ceil(valid / each) - 1.0;
    before_s += 2.0 * whole * (course.constant_s + course.reversal_s);
    valid -= whole * each;
  }
  const double lost_s = before_s + course.settling_s + exposure_s(frame_rate_hz);
  return std::ceil(lost_s * frame_rate_hz + valid);
}

std::vector<SpeedYield> plan_yield(const SweepPlan& plan, const ServoProfile& servo, double frame_rate_hz) {
  std::map<double, SpeedYield> speeds;
  for (const ExpectedLeg& leg : expected_legs(plan, servo, frame_rate_hz)) {
    SpeedYield& speed = speeds[std::abs(leg.rate_dps)];
    if (speed.rate_dps == 0.0) {
      speed.rate_dps = std::abs(leg.rate_dps);
      speed.windows = windows_of(leg, servo, frame_rate_hz);
    }
    speed.duration_s += leg.transit_s + leg.duration_s;
  }
  std::vector<SpeedYield> ascending;
  for (const auto& [rate_dps, speed] : speeds) ascending.push_back(speed);
  return ascending;
}

// ---- how a plan goes, leg by leg: how long each takes, and where it leaves the servo
// -----------------------

namespace {

constexpr double command_s = 0.1;  // from one leg's end to the servo's start of the next
constexpr double transit_extra_s = 0.2;

/// Walks through a plan on paper.
class Walk {
 public:
  Walk(const SweepPlan& plan, const ServoProfile& servo, double frame_rate_hz)
      : plan_(plan), servo_(servo), travel_(servo), frame_rate_hz_(frame_rate_hz) {}

  ExpectedLeg drive(double rate_dps) {
    ExpectedLeg leg{.rate_dps = rate_dps, .course = {}, .frames_for_quota = frames_for_quota(rate_dps)};
    const double planned = plan_.frames_per_leg;
    leg.frames = std::clamp(leg.frames_for_quota, planned, frames_growth_max * planned);
    leg.transit_s = go_to_start(rate_dps, leg.frames);
    leg.course = leg_course(rate_dps, before_dps_, leg.frames, servo_, frame_rate_hz_);
    leg.duration_s = leg_duration_s(leg.frames, frame_rate_hz_);
    const LegYield yield = leg_yield(leg.course, leg.frames, 1, frame_rate_hz_);
    valid_[rate_dps] += yield.own;
    valid_[-rate_dps] += yield.other;
    before_dps_ = leg.course.turns_back() ? 0.0 : rate_dps;
    return leg;
  }

 private:
  /// What earlier legs brought in this direction counts.
  double frames_for_quota(double rate_dps) {
    wanted_[rate_dps] += plan_.valid_per_leg;
    const double missing = wanted_[rate_dps] - valid_[rate_dps];
    const double planned = plan_.frames_per_leg;
    const LegCourse course = leg_course(rate_dps, before_dps_, planned, servo_, frame_rate_hz_);
    return frames_for(missing, course, frame_rate_hz_);
  }

  /// Seconds to where the leg fits. Leaves the servo where the leg ends.
  double go_to_start(double rate_dps, double frames) {
    const double way_deg = travel_.way_deg(rate_dps, frames, frame_rate_hz_);
    double transit_s = 0.0;
    if (!travel_.has_room(rate_dps, way_deg, angle_deg_)) {
      const double start_deg = ServoTravel::start_deg(rate_dps, way_deg);
      transit_s = std::abs(start_deg - angle_deg_) / speed_limit_dps(servo_) + transit_extra_s;
      angle_deg_ = start_deg;
      before_dps_ = 0.0;
    }
    angle_deg_ += sign_of(rate_dps) * way_deg;
    return transit_s;
  }

  const SweepPlan& plan_;
  const ServoProfile& servo_;
  ServoTravel travel_;
  double frame_rate_hz_;
  double angle_deg_ = 0.0;
  double before_dps_ = 0.0;
  std::map<double, double> wanted_;  // valid frames by speed, signed
  std::map<double, double> valid_;
};

}  // namespace

double leg_duration_s(double frames, double frame_rate_hz) {
  return (frames + 0.5) / frame_rate_hz + command_s;
}

std::vector<ExpectedLeg> expected_legs(const SweepPlan& plan, const ServoProfile& servo,
                                       double frame_rate_hz) {
  Walk walk(plan, servo, frame_rate_hz);
  std::vector<ExpectedLeg> legs;
  for (const double rate_dps : plan.leg_rates_dps) legs.push_back(walk.drive(rate_dps));
  return legs;
}

double plan_duration_s(const SweepPlan& plan, const ServoProfile& servo, double frame_rate_hz) {
  double duration_s = plan.opening_rest_s + plan.closing_rest_s;
  for (const ExpectedLeg& leg : expected_legs(plan, servo, frame_rate_hz))
    duration_s += leg.transit_s + leg.duration_s;
  return duration_s;
}

}  // namespace thermorig::rig
