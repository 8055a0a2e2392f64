// SPDX-License-Identifier: MIT
#include "thermorig/learning/interchange/formats.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <numbers>
#include <span>
#include <vector>

#include "facts.h"
#include "thermorig/core/validity.h"
#include "thermorig/learning/dataset/run_estimators.h"
#include "thermorig/pipeline/labels/label_config.h"
#include "thermorig/pipeline/labels/servo_model.h"
#include "thermorig/pipeline/labels/shaft_track.h"

namespace thermorig::interchange {

namespace {

labels::ShaftTrack track_of(const session::Session& session) {
  const ServoProfile& servo = session.raw.header.profile.servo;
  const labels::LabelConfig config;
  return {servo, session.sync.servo.fitted ? session.sync.servo : labels::assumed_response(servo),
          from_s(config.telemetry_gap_s), from_s(config.history_s)};
}

/// The shaft by the servo's model at the end of each frame's exposure, but where telemetry is missing or says
/// that the servo does not hold.
std::vector<AngleAt> shaft_angles(const session::Session& session) {
  const HostTime reference = session.raw.header.time_reference;
  labels::ShaftTrack track = track_of(session);
  std::span left(session.servo);
  std::vector<AngleAt> angles;
  for (std::size_t i = 0; i < session.frames.size(); ++i) {
    const HostTime time = session.frames[i].exposure_end;
    if (!is_of_recording(time, reference)) continue;
    for (; !left.empty() && !track.reaches(time); left = left.subspan(1))
      if (is_of_recording(left.front().stamp.time, reference)) track.add(left.front());
    const bool is_lost = (session.samples[i].reason_bits & bit(Reason::servo_lost)) != 0;
    if (is_lost || !track.covers(time, time)) continue;
    const double angle_deg = track.at(time).scaled_deg;
    if (std::isfinite(angle_deg)) angles.push_back({time, angle_deg});
  }
  return angles;
}

/// The shaft as a sensor on it measured it.
std::vector<AngleAt> measured_angles(const session::Session& session) {
  std::vector<AngleAt> angles;
  for (const TimedShaft& shaft : session.shaft)
    if (std::isfinite(shaft.angle_deg) &&
        is_of_recording(shaft.stamp.time, session.raw.header.time_reference))
      angles.push_back({shaft.stamp.time, shaft.angle_deg});
  return angles;
}

void add(Trajectory& trajectory, HostTime time, double angle_deg) {
  if (std::isfinite(angle_deg)) trajectory.angles.push_back({time, angle_deg});
}

std::vector<Trajectory> as_shown_live(const RawRecording& raw) {
  std::vector<Trajectory> trajectories;
  for (std::size_t i = 0; i < raw.header.estimators.size(); ++i) {
    Trajectory& trajectory = trajectories.emplace_back(Trajectory{raw.header.estimators[i].name, {}});
    for (const EstimateRow& row : raw.estimates)
      add(trajectory, row.exposure_end, row.estimates[i].angle_deg);
  }
  return trajectories;
}

std::vector<Trajectory> without_network(const session::Session& session) {
  estimators::Bank bank({}, std::nullopt, session.raw.header.profile);
  std::vector<Trajectory> trajectories;
  for (const estimators::Entry* entry : bank.entries())
    trajectories.push_back({std::string(entry->name), {}});
  dataset::run_estimators(session, bank, [&](std::size_t frame, std::span<const RateEstimate> estimates) {
    for (std::size_t k = 0; k < trajectories.size(); ++k)
      add(trajectories[k], session.frames[frame].exposure_end, estimates[k].angle_deg);
  });
  return trajectories;
}

std::string line_of(std::uint64_t unix_ns, double angle_deg) {
  const double half_rad = angle_deg * std::numbers::pi / 360.0;
  return fmt::format("{}.{:09} 0 0 0 0 0 {} {}\n", unix_ns / second_ns, unix_ns % second_ns,
                     std::sin(half_rad), std::cos(half_rad));
}

}  // namespace

std::vector<Trajectory> trajectories_of(const session::Session& session) {
  std::vector<Trajectory> trajectories{{"shaft", shaft_angles(session)}};
  if (has_measured_shaft(session.raw)) trajectories.push_back({"measured", measured_angles(session)});
  std::vector<Trajectory> others =
      session.raw.estimates.empty() ? without_network(session) : as_shown_live(session.raw);
  std::move(others.begin(), others.end(), std::back_inserter(trajectories));
  return trajectories;
}

void write_tum(const RecordingHeader& header, const Trajectory& trajectory, Sink& sink) {
  sink.write(std::string_view("# timestamp x y z q_x q_y q_z q_w\n"));
  for (const AngleAt& at : trajectory.angles) sink.write(line_of(unix_ns(header, at.time), at.angle_deg));
}

}  // namespace thermorig::interchange
