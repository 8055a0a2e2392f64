// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/labeller.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "thermorig/core/estimate.h"
#include "thermorig/core/sync.h"
#include "thermorig/pipeline/labels/gyro_track.h"
#include "thermorig/pipeline/labels/label_config.h"
#include "thermorig/pipeline/labels/pulse_train.h"
#include "thermorig/pipeline/labels/servo_model.h"

namespace thermorig::labels {

namespace {

constexpr double assumed_slope_error = 0.005;  // along the travel, of hobby servos
constexpr double assumed_ripple_dps = 0.3;     // of an exposure's mean, where the loop is only guessed
constexpr double least_gyro_error_dps = 0.05;  // resolution and cross axes
constexpr double least_model_error_dps =
    0.06;  // what is the same in all frames of a speed, and hides in its mean
constexpr double chance_deviations = 3.0;

/// Straight between the speeds of the table, constant beyond them. It is not empty.
template <typename Column>
double tabled(const ServoResponse& response, double rate_dps, const Column& column) {
  const auto& speeds = response.speeds;
  const auto slower = [](const ServoResponse::AtSpeed& at, double rate) { return at.rate_dps < rate; };
  const auto next = std::lower_bound(speeds.begin(), speeds.end(), rate_dps, slower);
  if (next == speeds.begin()) return column(speeds.front());
  if (next == speeds.end()) return column(speeds.back());
  const auto before = next - 1;
  const double share = (rate_dps - before->rate_dps) / (next->rate_dps - before->rate_dps);
  return std::lerp(column(*before), column(*next), share);
}

/// What the fit left at that speed; nullptr: it knows none.
const ServoResponse::AtSpeed* known_at(const ServoResponse& response, double commanded_dps) {
  const ServoResponse::AtSpeed* const seen = response.fitted ? seen_at(response, commanded_dps) : nullptr;
  return seen != nullptr && std::isfinite(seen->residual_dps) ? seen : nullptr;
}

/// How much faster the shaft was than the model has it, on the scale of the response.
double beyond_model_dps(const ServoResponse& response, const ServoResponse::AtSpeed& seen) {
  return response.scale.value / response.gyro_ratio.value * seen.residual_dps;
}

/// Noise that explains nothing where none is known: a spread then counts as motion.
double known_noise_dps(const GyroErrors& errors) {
  return std::isfinite(errors.noise_dps) ? errors.noise_dps : 0.0;
}

/// What the model of a response leaves unexplained at a speed, one standard deviation: of exposure means
/// against the gyro, or, where nothing was fitted, what servos of the kind are known for.
double model_deviation_dps(const ServoResponse& response, double rate_dps) {
  const bool measured = !response.speeds.empty() || std::isfinite(response.residual_dps);
  if (!response.fitted || !measured) return std::hypot(assumed_ripple_dps, assumed_slope_error * rate_dps);
  if (response.speeds.empty()) return response.residual_dps;
  const double tabled_dps = tabled(response, rate_dps, [](const ServoResponse::AtSpeed& at) {
    return std::hypot(at.residual_dps, at.spread_dps, least_model_error_dps);
  });
  return std::isfinite(tabled_dps) ? tabled_dps : response.residual_dps;
}

/// Noise of a gyro sample while the shaft turns at that speed: as at rest, or more where gears are heard.
/// `so_far_dps`: what was heard of them, where no response was fitted.
double gyro_noise_dps(const GyroErrors& errors, const ServoResponse& response, double rate_dps,
                      double so_far_dps) {
  const double at_rest_dps = known_noise_dps(errors);
  if (!response.fitted || response.speeds.empty()) return std::max(at_rest_dps, so_far_dps);
  const double turning_dps =
      tabled(response, rate_dps, [](const ServoResponse::AtSpeed& at) { return at.noise_dps; });
  return std::fmax(at_rest_dps, turning_dps);
}

/// What the shaft makes of a commanded speed: times `gain`, that of the travel that the shaft passed
/// meanwhile (scale in it), plus what the gyro saw beyond the model over this session's legs of that speed.
/// Where nothing was fitted, what was commanded.
double corrected_dps(const ServoResponse& response, double commanded_dps, double gain) {
  if (!response.fitted) return commanded_dps;
  const ServoResponse::AtSpeed* const seen = known_at(response, commanded_dps);
  return gain * commanded_dps + (seen == nullptr ? 0.0 : beyond_model_dps(response, *seen));
}

/// How far a label may be from the shaft's true speed over an exposure, one standard deviation: its distance
/// from the model, which follows the shaft from frame to frame, and what is uncertain of that. What the gyro
/// saw beyond the model at the commanded speed is added to the model first. `time_dps` for the time of the
/// exposure. NaN without a model (`shaft_dps`).
double label_deviation_dps(const ServoResponse& response, double commanded_dps, double label_dps,
                           double shaft_dps, double time_dps) {
  const double scale_dps = response.scale.uncertainty / response.scale.value * shaft_dps;
  const ServoResponse::AtSpeed* const seen = known_at(response, commanded_dps);
  const double off_dps = label_dps - shaft_dps - (seen == nullptr ? 0.0 : beyond_model_dps(response, *seen));
  const double left_dps = seen == nullptr ? model_deviation_dps(response, commanded_dps)
                                          : std::hypot(seen->spread_dps, least_model_error_dps);
  return std::hypot(std::hypot(off_dps, left_dps), scale_dps, time_dps);
}

/// The gyro's mean, corrected, minus the shaft's speed as the gyro would see it, in units of its standard
/// deviation: bias, noise (of a sample, `noise_dps`), the model's residual, `time_dps` for the time between
/// gyro and model, and the scale between both. `bias_dps`: at that time. 0 where nothing can be said.
double gyro_z_score(const GyroErrors& errors, const ServoResponse& response, const GyroMean& gyro,
                    double noise_dps, double bias_dps, double shaft_dps, double time_dps) {
  if (gyro.saturated || !errors.bias_dps || !(errors.scale.value > 0.0)) return 0.0;
  const double ratio = response.gyro_ratio.value / response.scale.value;
  const double corrected_dps = (gyro.rate_dps - bias_dps) / errors.scale.value;
  const double off_dps = corrected_dps - ratio * shaft_dps;
  const double mean_noise_dps = noise_dps / std::sqrt(static_cast<double>(gyro.count));
  const double deviation_dps =
      std::hypot(std::hypot(errors.bias_dps->uncertainty, mean_noise_dps, least_gyro_error_dps),
                 std::hypot(model_deviation_dps(response, shaft_dps), time_dps,
                            response.gyro_ratio.uncertainty * shaft_dps));
  return std::isfinite(off_dps) ? off_dps / deviation_dps : 0.0;
}

/// Whether gyro_spread is wider than `tolerance_dps`, beyond what such noise of a sample, and chance,
/// explain.
bool is_unsteady(const GyroMean& gyro, double noise_dps, double tolerance_dps) {
  if (gyro.count == 0 || gyro.saturated) return false;
  const double explained_dps2 = noise_dps * noise_dps / gyro.averaged;
  // A variance by n independent values scatters by a share of sqrt(2 / n).
  const double independent = std::max(static_cast<double>(gyro.count) / gyro.averaged, 2.0);
  const double chance_dps2 = chance_deviations * explained_dps2 * std::sqrt(2.0 / independent);
  return gyro.spread_dps * gyro.spread_dps > tolerance_dps * tolerance_dps + explained_dps2 + chance_dps2;
}

constexpr double disagreement = 3.0;     // standard deviations
constexpr double longest_shift_s = 1.0;  // beyond it a time says nothing
constexpr double degree_rad = 3.14159265358979323846 / 180.0;
constexpr double most_apart = 1.4142135623730951;  // of two errors that do not know of each other
constexpr double errors_a_turn = 2.0;              // that a sensor's error repeats twice a turn
constexpr double hardly_turning_dps = 1.0;         // slower, a share of the travel passed is none

/// Of a mean speed when the exposure is moved by half or all of `time_s`, either way. `here_dps`: where it
/// is.
template <typename Mean>
double largest_change_dps(HostTime begin, HostTime end, double time_s, double here_dps,
                          const Mean& mean_dps) {
  double change_dps = 0.0;
  for (const double share : {-1.0, -0.5, 0.5, 1.0}) {
    const HostDuration shift = from_s(share * std::fmin(time_s, longest_shift_s));
    change_dps = std::fmax(change_dps, std::abs(mean_dps(begin + shift, end + shift) - here_dps));
  }
  return change_dps;
}

std::uint32_t bit_if(Reason reason, bool holds) {
  return holds ? bit(reason) : 0U;
}

bool has_pixel_out_of_range(const ThermalFrame& frame) {
  unsigned within = 0;
  for (const float temp_c : frame.temp_c) within += is_temperature(temp_c) ? 1U : 0U;
  return within < frame_pixels;
}

bool has_gap_before(const TimedFrame& frame) {
  return frame.missing_before > 0 || frame.half_lost;
}

/// A half that was lost leaves the one before it in the frame.
HostTime shown_since(const TimedFrame& frame) {
  if (!has_gap_before(frame) || frame.stands_in) return frame.exposure_begin;
  return std::min({frame.exposure_begin, frame.half[0].begin, frame.half[1].begin});
}

/// A recording says something of it, if only that it contradicts the command.
bool is_known(const ServoResponse& response) {
  return response.fitted || !response.speeds.empty();
}

HostDuration settling_time(const LabelConfig& config) {
  return from_s(config.response.fitted ? settle_s(config.response) : config.settle_s);
}
}  // namespace

Labeller::Labeller(const LabelConfig& config)
    : config_(config),
      response_(is_known(config.response) ? config.response : assumed_response(config.servo)),
      wait_(from_s(config.wait_s)),
      settle_(settling_time(config)),
      lag_(from_s(response_.delay_s) + pulse_period),
      command_(PulseScale(config.servo), from_s(config.telemetry_gap_s), from_s(config.history_s)),
      shaft_(config.servo, response_, from_s(config.telemetry_gap_s), from_s(config.history_s)),
      measured_(from_s(config.history_s), from_s(config.bridged_silence_s)),
      gyro_(from_s(config.history_s)),
      bias_(config.gyro.value_or(assumed_gyro_errors(config.gyro_profile))),
      warm_up_(config.warm_up_k_per_min) {}

std::uint32_t Labeller::frame_reasons(const TimedFrame& frame) {
  const bool unsure = static_cast<double>(frame.stamp.uncertainty_s) > config_.clock_limit_s;
  const std::uint32_t reasons = bit_if(Reason::camera_gap, has_gap_before(frame)) |
                                bit_if(Reason::camera_not_fresh, frame.stale && !frame.half_lost) |
                                bit_if(Reason::sync_lost, frame.late || unsure) |
                                bit_if(Reason::checksum, frame.resync_before);
  if (frame.stands_in) return reasons;
  return reasons | bit_if(Reason::warm_up, warm_up_.push(frame.stamp.time, frame.frame.sensor_temp_c)) |
         bit_if(Reason::out_of_range, has_pixel_out_of_range(frame.frame));
}

void Labeller::add(const TimedFrame& frame) {
  assert(frame.exposure_begin <= frame.exposure_end);
  const std::uint32_t reasons = frame_reasons(frame);
  pending_.push_back({frame_count_, frame.stamp, frame.exposure_begin, frame.exposure_end, shown_since(frame),
                      frame.half, reasons});
  ++frame_count_;
}

void Labeller::add(const TimedServo& servo) {
  command_.add(servo, shaft_.add(servo));
}

bool Labeller::has_all_until(HostTime end) const {
  const bool has_servo = config_.by_gyro || (command_.reaches(end) && shaft_.reaches(end));
  const HostDuration behind = from_s(config_.gyro ? MeasuredTrack::reach_s : 0.0);  // live, nobody waits
  return has_servo && gyro_.reaches(end) &&
         (!config_.by_sensor || !measured_.is_there() || measured_.reaches(end + behind));
}

std::vector<LabelledSample> Labeller::take(HostTime now) {
  std::vector<LabelledSample> samples;
  while (!pending_.empty() &&
         (has_all_until(pending_.front().exposure_end) || now - pending_.front().stamp.arrival >= wait_)) {
    samples.push_back(label(pending_.front()));
    pending_.pop_front();
  }
  return samples;
}

std::vector<LabelledSample> Labeller::finish() {
  std::vector<LabelledSample> samples;
  for (const PendingFrame& frame : pending_) samples.push_back(label(frame));
  pending_.clear();
  return samples;
}

LabelledSample Labeller::label(const PendingFrame& frame) {
  LabelledSample sample;
  sample.frame_index = frame.index;
  sample.exposure_begin = frame.shown_since;
  sample.exposure_end = frame.exposure_end;
  sample.time = frame.exposure_end - (frame.exposure_end - frame.exposure_begin) / 4;
  sample.reason_bits = frame.reason_bits;
  if (config_.by_gyro) {
    label_halves(sample, frame);
    label_by_gyro(sample, frame);
  } else {
    label_motion(sample, frame);
    label_halves(sample, frame);
    label_measured(sample, frame);
    label_gyro(sample);
  }
  const std::uint32_t harmless =
      config_.warm_up_invalidates ? warning_bits & ~bit(Reason::warm_up) : warning_bits;
  sample.valid = (sample.reason_bits & ~harmless) == 0;
  number_run(sample);
  return sample;
}

Labeller::Rates Labeller::rates(HostTime begin, HostTime end) const {
  std::optional<double> commanded_dps = command_.constant_rate_dps(begin, end);
  if (!commanded_dps) commanded_dps = command_.mean_rate_dps(begin, end);
  if (!commanded_dps) return {unknown, unknown, unknown};
  const bool modelled = begin < end && shaft_.covers(begin, end);
  return {*commanded_dps,
          corrected_dps(response_, *commanded_dps, modelled ? gain(begin, end) : response_.scale.value),
          modelled ? shaft_.mean_dps(begin, end) : unknown};
}

/// Of the travel that the model has the shaft pass in that time, scale in it. Where it hardly turns, the
/// scale.
double Labeller::gain(HostTime begin, HostTime end) const {
  const ShaftAngle from = shaft_.at(begin), to = shaft_.at(end);
  const double turned_deg = to.plain_deg - from.plain_deg;
  if (!(std::abs(turned_deg) > hardly_turning_dps * to_s(end - begin))) return response_.scale.value;
  return (to.scaled_deg - from.scaled_deg) / turned_deg;
}

void Labeller::label_motion(LabelledSample& sample, const PendingFrame& frame) {
  const HostTime begin = sample.exposure_begin, end = sample.exposure_end;
  const CommandSpan exposure = command_.over(begin, end);
  const Rates mean = rates(begin, end);
  sample.rate_commanded_dps = static_cast<float>(mean.commanded_dps);
  sample.rate_shaft_dps = static_cast<float>(mean.model_dps);
  sample.rate_corrected_dps = static_cast<float>(mean.corrected_dps);
  sample.angle_commanded_deg = static_cast<float>(command_.angle_deg(sample.time));
  sample.leg = command_.leg(sample.time);
  const bool known = std::isfinite(mean.model_dps);
  const ShaftRates shaft = known ? shaft_.over(begin, end) : ShaftRates{};
  sample.rate_shaft_min_dps = static_cast<float>(known ? shaft.range.min_dps : unknown);
  sample.rate_shaft_max_dps = static_cast<float>(known ? shaft.range.max_dps : unknown);
  const double time_s = std::hypot(std::hypot(frame.stamp.uncertainty_s, exposure.time_uncertainty_s),
                                   config_.latency_uncertainty_s, response_.delay_uncertainty_s);
  const double scale_dps = response_.scale.uncertainty / response_.scale.value * mean.model_dps;
  const double model_dps = known ? model_deviation_dps(response_, mean.commanded_dps) : unknown;
  const double time_dps = known ? time_error_dps(sample, time_s) : unknown;
  sample.rate_shaft_uncertainty_dps = static_cast<float>(std::hypot(time_dps, scale_dps, model_dps));
  const auto deviation_dps = [&](double label_dps) {
    return static_cast<float>(
        label_deviation_dps(response_, mean.commanded_dps, label_dps, mean.model_dps, time_dps));
  };
  sample.rate_commanded_uncertainty_dps = deviation_dps(mean.commanded_dps);
  sample.rate_corrected_uncertainty_dps = deviation_dps(mean.corrected_dps);
  sample.reason_bits |= command_reasons(sample) | model_reasons(sample, shaft);
}

double Labeller::time_error_dps(const LabelledSample& sample, double time_s) const {
  return largest_change_dps(sample.exposure_begin, sample.exposure_end, time_s,
                            static_cast<double>(sample.rate_shaft_dps),
                            [this](HostTime begin, HostTime end) { return shaft_.mean_dps(begin, end); });
}

/// The older half of a frame is mostly the newer one of the frame before. A half that is shown again and
/// again keeps its label, though what it was made of may be forgotten by then: its exposure is what it was.
void Labeller::label_halves(LabelledSample& sample, const PendingFrame& frame) {
  for (std::size_t i = 0; i < frame.half.size(); ++i) {
    const auto& [begin, end] = frame.half[i];
    std::optional<Half>& half = halves_[i];
    if (!half || half->exposure != frame.half[i])
      half =
          Half{frame.half[i], rates(begin, end), gyro_.mean_dps(begin, end),
               config_.by_sensor ? measured_.rate_dps(begin, end).value_or(Estimate{unknown, unknown}).value
                                 : unknown};
    sample.rate_commanded_half_dps[i] = static_cast<float>(half->mean.commanded_dps);
    sample.rate_shaft_half_dps[i] = static_cast<float>(half->mean.model_dps);
    sample.rate_corrected_half_dps[i] = static_cast<float>(half->mean.corrected_dps);
    sample.rate_gyro_half_dps[i] = static_cast<float>(half->gyro_dps);
    sample.rate_measured_half_dps[i] = static_cast<float>(half->measured_dps);
    if (!has_all_until(end)) half.reset();  // what still comes may tell more of it
  }
}

double Labeller::measured_time_error_dps(HostTime begin, HostTime end, double time_s) const {
  const auto measured_dps = [this](HostTime from, HostTime to) {
    const auto rate = measured_.rate_dps(from, to);
    return rate ? rate->value : unknown;
  };
  return largest_change_dps(begin, end, time_s, measured_dps(begin, end), measured_dps);
}

/// What a sensor on the shaft says is what the shaft did. How far the commanded speeds are from it is known
/// then, frame by frame.
void Labeller::label_measured(LabelledSample& sample, const PendingFrame& frame) {
  if (!config_.by_sensor) return;
  if (const auto angle = measured_.angle_deg(sample.time)) sample.angle_measured_deg = angle->value;
  const HostTime begin = sample.exposure_begin, end = sample.exposure_end;
  const auto rate = measured_.rate_dps(begin, end);
  if (!rate) return;
  const double time_s =
      std::hypot(std::hypot(double{frame.stamp.uncertainty_s}, double{measured_.time_uncertainty_s(end)}),
                 config_.latency_uncertainty_s, config_.sensor_latency_uncertainty_s);
  const double length_s = to_s(end - begin);
  const double turned_rad = rate->value * length_s * degree_rad;
  const double repeats_deg =
      config_.sensor_error_deg * std::fmin(most_apart, errors_a_turn * std::abs(turned_rad));
  const double own_dps = std::hypot(rate->uncertainty, repeats_deg / length_s);
  const auto uncertainty_dps =
      static_cast<float>(std::hypot(own_dps, measured_time_error_dps(begin, end, time_s)));
  sample.rate_measured_dps = static_cast<float>(rate->value);
  sample.rate_measured_uncertainty_dps = uncertainty_dps;
  sample.rate_shaft_dps = sample.rate_measured_dps;
  sample.rate_shaft_uncertainty_dps = uncertainty_dps;
  sample.rate_shaft_min_dps = std::fmin(sample.rate_shaft_min_dps, sample.rate_shaft_dps);
  sample.rate_shaft_max_dps = std::fmax(sample.rate_shaft_max_dps, sample.rate_shaft_dps);
  for (std::size_t half = 0; half < sample.rate_shaft_half_dps.size(); ++half)
    if (std::isfinite(sample.rate_measured_half_dps[half]))
      sample.rate_shaft_half_dps[half] = sample.rate_measured_half_dps[half];
  sample.rate_commanded_uncertainty_dps =
      std::hypot(sample.rate_commanded_dps - sample.rate_measured_dps, uncertainty_dps);
  sample.rate_corrected_uncertainty_dps =
      std::hypot(sample.rate_corrected_dps - sample.rate_measured_dps, uncertainty_dps);
}

double Labeller::tolerance_dps(const LabelledSample& sample) const {
  const double rate_dps = std::abs(static_cast<double>(sample.rate_commanded_dps));
  return std::max(config_.rate_tolerance_dps, config_.rate_tolerance_share * rate_dps);
}

std::uint32_t Labeller::command_reasons(const LabelledSample& sample) const {
  const HostTime begin = sample.exposure_begin, end = sample.exposure_end;
  const CommandSpan settled = command_.over(begin - settle_, end);
  const CommandSpan shown = command_.over(begin - lag_, end - lag_);
  const double limit_deg = 0.5 * config_.travel_deg - config_.stop_margin_deg;
  const bool beyond = config_.travel_deg > 0.0 && command_.farthest_deg(begin, end) > limit_deg;
  return bit_if(Reason::limit_hit, beyond) |
         bit_if(Reason::outside_leg, shown.outside_leg || sample.leg == 0) |
         bit_if(Reason::leg_change, shown.several_legs) |
         bit_if(Reason::servo_lost, !settled.covered || !settled.able) |
         bit_if(Reason::telemetry_disagrees, settled.disagrees);
}

std::uint32_t Labeller::model_reasons(const LabelledSample& sample, const ShaftRates& shaft) const {
  const auto commanded_dps = static_cast<double>(sample.rate_commanded_dps);
  const auto strays = [&](const RateRange& range) {
    return std::max(commanded_dps - range.min_dps, range.max_dps - commanded_dps) > tolerance_dps(sample);
  };
  const bool ramps = strays(shaft.slow) && strays(shaft.plain_slow);
  const double sign_dps = config_.rate_tolerance_dps;
  return bit_if(Reason::servo_ramp, std::isnan(sample.rate_shaft_dps) || ramps) |
         bit_if(Reason::reversal,
                shaft.plain_slow.min_dps < -sign_dps && shaft.plain_slow.max_dps > sign_dps);
}

GyroMean Labeller::note_gyro(LabelledSample& sample) const {
  const GyroMean mean = gyro_.over(sample.exposure_begin, sample.exposure_end);
  constexpr std::size_t most = std::numeric_limits<std::uint16_t>::max();
  sample.rate_gyro_dps = static_cast<float>(mean.rate_dps);
  sample.gyro_count = static_cast<std::uint16_t>(std::min(mean.count, most));
  sample.gyro_spread_dps = static_cast<float>(mean.count > 0 ? mean.spread_dps : unknown);
  return mean;
}

/// Without a command the speed is the gyro's, less the bias of the recording's rests. Until a rest is known,
/// as in a live run, there is no label.
void Labeller::label_by_gyro(LabelledSample& sample, const PendingFrame& frame) {
  const GyroMean mean = note_gyro(sample);
  const GyroErrors errors = config_.gyro.value_or(GyroErrors());
  const double bias_dps = errors.bias_dps ? bias_dps_at(errors, sample.time) : unknown;
  const auto shaft = [&](double rate_dps) {
    return static_cast<float>((rate_dps - bias_dps) / errors.scale.value);
  };
  sample.rate_commanded_dps = sample.rate_corrected_dps = sample.angle_commanded_deg =
      std::numeric_limits<float>::quiet_NaN();
  sample.rate_shaft_dps = shaft(mean.rate_dps);
  sample.rate_shaft_min_dps = shaft(mean.least_dps);
  sample.rate_shaft_max_dps = shaft(mean.most_dps);
  for (std::size_t half = 0; half < sample.rate_shaft_half_dps.size(); ++half)
    sample.rate_shaft_half_dps[half] = shaft(static_cast<double>(sample.rate_gyro_half_dps[half]));
  sample.rate_shaft_uncertainty_dps = std::numeric_limits<float>::quiet_NaN();
  if (errors.bias_dps && mean.count > 0) {
    const double time_s = std::hypot(std::hypot(frame.stamp.uncertainty_s, mean.time_uncertainty_s),
                                     config_.latency_uncertainty_s, between_samples_s());
    const double time_dps =
        largest_change_dps(sample.exposure_begin, sample.exposure_end, time_s, mean.rate_dps,
                           [this](HostTime begin, HostTime end) { return gyro_.mean_dps(begin, end); });
    const double noise_dps =
        std::isfinite(errors.noise_dps) ? errors.noise_dps / std::sqrt(static_cast<double>(mean.count)) : 0.0;
    const double scale_dps = errors.scale.uncertainty * static_cast<double>(sample.rate_shaft_dps);
    sample.rate_shaft_uncertainty_dps = static_cast<float>(
        std::hypot(std::hypot(errors.bias_dps->uncertainty, noise_dps, time_dps), scale_dps) /
        errors.scale.value);
  }
  const auto tolerance = static_cast<float>(config_.rate_tolerance_dps);
  sample.reason_bits |= bit_if(Reason::no_bias, !errors.bias_dps) |
                        bit_if(Reason::gyro_gap, has_gyro_gap(sample, mean) || mean.saturated) |
                        bit_if(Reason::reversal, sample.rate_shaft_min_dps < -tolerance &&
                                                     sample.rate_shaft_max_dps > tolerance);
}

double Labeller::between_samples_s() const {
  return 1.0 / (std::sqrt(12.0) * config_.gyro_rate_hz);
}

void Labeller::label_gyro(LabelledSample& sample) {
  const GyroMean mean = note_gyro(sample);
  if (sample.leg != 0) motion_noise_.add(mean);
  sample.reason_bits |= gyro_reasons(sample, mean);
  const bool is_measured = std::isfinite(sample.rate_measured_dps);
  if (!is_measured && (sample.reason_bits & bit(Reason::gyro_unsteady)) != 0) widen(sample, mean);
  if (!config_.gyro) learn_bias(sample, mean);
}

/// A shaft that sticks and slips has a mean speed all the same: the gyro's. What labels are off it is part of
/// their uncertainty.
void Labeller::widen(LabelledSample& sample, const GyroMean& gyro) const {
  const GyroErrors& errors = bias_.errors();
  const double bias_dps = bias_dps_at(errors, sample.time);
  const double shown_dps = (gyro.rate_dps - bias_dps) / errors.scale.value;
  const double sigma_dps = errors.bias_dps ? errors.bias_dps->uncertainty : unknown_bias_dps;
  const auto widened = [&](float& uncertainty_dps, float label_dps) {
    const double off_dps = static_cast<double>(label_dps) - shown_dps;
    uncertainty_dps = static_cast<float>(std::hypot(double{uncertainty_dps}, off_dps, sigma_dps));
  };
  if (!std::isfinite(shown_dps)) return;
  widened(sample.rate_shaft_uncertainty_dps, sample.rate_shaft_dps);
  widened(sample.rate_commanded_uncertainty_dps, sample.rate_commanded_dps);
  widened(sample.rate_corrected_uncertainty_dps, sample.rate_corrected_dps);
}

bool Labeller::has_gyro_gap(const LabelledSample& sample, const GyroMean& gyro) const {
  const double expected = to_s(sample.exposure_end - sample.exposure_begin) * config_.gyro_rate_hz;
  const double needed = config_.gyro_gap_share * expected;
  return gyro.count == 0 || static_cast<double>(gyro.count) < needed ||
         lacks_sample(config_.gyro_gaps, sample.exposure_begin, sample.exposure_end) ||
         gyro_.lacks_sample(sample.exposure_begin, sample.exposure_end, 1.0 / config_.gyro_rate_hz);
}

std::uint32_t Labeller::gyro_reasons(const LabelledSample& sample, const GyroMean& gyro) const {
  const double noise_dps =
      gyro_noise_dps(bias_.errors(), response_, sample.rate_commanded_dps, motion_noise_.noise_dps());
  const bool unsteady = is_unsteady(gyro, noise_dps, tolerance_dps(sample));
  return bit_if(Reason::gyro_gap, has_gyro_gap(sample, gyro)) | bit_if(Reason::gyro_unsteady, unsteady) |
         bit_if(Reason::gyro_disagrees,
                gyro_disagrees(sample, gyro, noise_dps, unsteady ? gyro.spread_dps : 0.0));
}

/// `spread_dps`: by which the shaft's speed changes within the exposure, beyond any model.
bool Labeller::gyro_disagrees(const LabelledSample& sample, const GyroMean& gyro, double noise_dps,
                              double spread_dps) const {
  if (contradicts_command(response_, sample.rate_commanded_dps)) return true;
  if (std::isnan(sample.rate_shaft_dps) || gyro.count == 0) return false;
  if (std::isfinite(sample.rate_measured_dps)) return gyro_disagrees_with_sensor(sample, gyro, noise_dps);
  // Whole samples stand for an exposure that begins and ends anywhere between two of them.
  const double time_s =
      std::hypot(response_.delay_uncertainty_s, gyro.time_uncertainty_s, between_samples_s());
  const double time_dps = time_error_dps(sample, time_s);
  const auto shaft_dps = static_cast<double>(sample.rate_shaft_dps);
  const double bias_dps = bias_dps_at(bias_.errors(), sample.time);
  const double deviations = gyro_z_score(bias_.errors(), response_, gyro, noise_dps, bias_dps, shaft_dps,
                                         std::hypot(time_dps, spread_dps));
  return std::abs(deviations) > disagreement;
}

/// What the sensor states holds all that the shaft does within the exposure.
bool Labeller::gyro_disagrees_with_sensor(const LabelledSample& sample, const GyroMean& gyro,
                                          double noise_dps) const {
  const GyroErrors& errors = bias_.errors();
  if (gyro.saturated || !errors.bias_dps || !(errors.scale.value > 0.0)) return false;
  const double corrected_dps = (gyro.rate_dps - bias_dps_at(errors, sample.time)) / errors.scale.value;
  const double measured_dps = sample.rate_measured_dps;
  const double time_dps = measured_time_error_dps(
      sample.exposure_begin, sample.exposure_end,
      std::hypot(double{gyro.time_uncertainty_s}, between_samples_s(), errors.filter_delay_s.uncertainty));
  const double gyro_dps = std::hypot(std::hypot(errors.bias_dps->uncertainty, least_gyro_error_dps,
                                                noise_dps / std::sqrt(static_cast<double>(gyro.count))),
                                     time_dps, errors.scale.uncertainty * measured_dps);
  const double known_dps = std::hypot(gyro_dps, double{sample.rate_measured_uncertainty_dps});
  return std::abs(corrected_dps - measured_dps) > disagreement * known_dps;
}

/// A frame that was exposed while the servo had long been at rest shows the gyro's bias.
void Labeller::learn_bias(const LabelledSample& sample, const GyroMean& gyro) {
  if (command_.rests(sample.exposure_begin - 2 * settle_, sample.exposure_end)) bias_.add(gyro);
}

void Labeller::number_run(LabelledSample& sample) {
  if (sample.valid && (breaks_run(sample.reason_bits) || sample.leg != run_leg_)) ++run_;
  run_leg_ = sample.valid ? std::optional(sample.leg) : std::nullopt;
  if (sample.valid) sample.run = run_;
}

}  // namespace thermorig::labels
