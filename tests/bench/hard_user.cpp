// SPDX-License-Identifier: MIT
#include "hard_user.h"

#include <array>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/rig/calibration/calibration.h"
#include "thermorig/rig/recording/virtual_recording.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::bench {
namespace {

using rig::CalibrationKind;
using rig::test::SimulatedBus;

/// The same seed and environment are the same devices before the same walls, whatever the world.
simulation::VirtualRigConfig rig_in(const HardCase& hard, const std::string& environment,
                                    const std::string& world, const RigProfile* profile) {
  simulation::VirtualRigConfig config = simulation::default_rig(hard.seed, environment);
  simulation::put_in_world(simulation::world_named(world, hard.seed), config);
  simulation::choose_camera(hard.camera, config);
  config.has_encoder = hard.has_encoder;
  sensors::choose_servo(hard.servo, config.profile.servo);
  if (hard.servo == "dynamixel") config.profile.servo.link.baud = 1'000'000;
  if (profile != nullptr) config.profile = *profile;
  return config;
}

struct Recorded {
  std::unique_ptr<SimulatedBus> bus;
  rig::RecordingResult result;
  std::optional<session::Session> session;
};

Recorded record(const simulation::VirtualRigConfig& config, const rig::SweepPlan& plan,
                const rig::test::TemporaryFolder& folder) {
  Recorded recorded{std::make_unique<SimulatedBus>(config, simulation::make_servo(config)), {}, {}};
  recorded.bus->rig.keep_truth(true);
  rig::VirtualOptions options;
  options.recording = rig::test::recording_options(folder, config.profile, plan);
  options.recording.environment = config.environment;
  options.recording.simulation_seed = config.seed;
  options.recording.preflight = rig::PreflightMode::refuse;
  options.recording.simulation += ", world " + simulation::text_of(config.world);
  options.start = config.start;
  recorded.result = rig::record_virtual(*recorded.bus, options);
  if (!recorded.result.session.empty()) recorded.session = session::read_session(recorded.result.session);
  return recorded;
}

void measure(CalibrationKind kind, const session::Session& session, RigProfile& profile) {
  const std::string& utc = session.raw.header.start_time_utc;
  switch (kind) {
    case CalibrationKind::orientation:
      return calibration::apply(calibration::measure_orientation(session), utc, profile);
    case CalibrationKind::scale:
      return calibration::apply(calibration::measure_scale(session), utc, profile);
    case CalibrationKind::latency:
      return calibration::apply(calibration::measure_latency(session), utc, profile);
    case CalibrationKind::bias:
      return calibration::apply(calibration::measure_bias(session), utc, profile);
    case CalibrationKind::lens:
      return calibration::apply(calibration::measure_lens(session), utc, profile);
    case CalibrationKind::encoder:
      return calibration::apply(calibration::measure_encoder(session), utc, profile);
    case CalibrationKind::check:  // says whether a profile still holds, and changes nothing in it
      break;
  }
}

void calibrate(CalibrationKind kind, const std::string& name, const HardCase& hard, RigProfile& profile,
               std::vector<RefusedCalibration>& refused) {
  const rig::test::TemporaryFolder folder;
  // Without --environment a calibration is recorded under its own name, before the laboratory's walls.
  const auto config = rig_in(hard, "calibration", hard.calibrated_in, &profile);
  try {
    const Recorded recorded =
        record(config, rig::calibration_plan(kind, profile.servo, profile.camera), folder);
    if (!recorded.session) return refused.push_back({name, recorded.result.message});
    measure(kind, *recorded.session, profile);
  } catch (const Error& error) {
    refused.push_back({name, error.what_happened()});
  }
}

}  // namespace

HardRecording use(const HardCase& hard) {
  HardRecording made;
  RigProfile profile = rig_in(hard, hard.environment, hard.world, nullptr).profile;
  constexpr std::array<std::pair<CalibrationKind, const char*>, 3> calibrations{
      {{CalibrationKind::orientation, "orientation"},
       {CalibrationKind::scale, "scale"},
       {CalibrationKind::latency, "latency"}}};
  for (const auto& [kind, name] : calibrations)
    calibrate(kind, name, hard, profile, made.refused_calibrations);
  if (simulation::measures_shaft(rig_in(hard, hard.environment, hard.world, nullptr)))
    calibrate(CalibrationKind::encoder, "encoder", hard, profile, made.refused_calibrations);
  const rig::test::TemporaryFolder folder;
  try {
    Recorded recorded = record(rig_in(hard, hard.environment, hard.world, &profile),
                               rig::load_plan("paper", hard.environment, hard.seed), folder);
    made.result = std::move(recorded.result);
    made.session = std::move(recorded.session);
    made.bus = std::move(recorded.bus);
    if (!made.session) made.refusal = made.result.message;
  } catch (const Error& error) {
    made.refusal = error.what_happened();
  }
  return made;
}

}  // namespace thermorig::bench
