// SPDX-License-Identifier: MIT
#include "calibrated_rig.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>

#include "thermorig/core/error.h"
#include "thermorig/rig/recording/virtual_recording.h"

namespace thermorig::calibration {

namespace {

class TruthfulBus : public rig::DeviceBus {
 public:
  explicit TruthfulBus(const simulation::VirtualRigConfig& config)
      : rig(config, simulation::make_host_firmware()) {
    rig.keep_truth(true);
  }
  void send(Device to, std::span<const std::uint8_t> bytes, HostTime now) override {
    rig.send(to, bytes, now);
  }
  std::vector<Chunk> advance(HostTime until) override { return rig.advance(until); }

  simulation::VirtualRig rig;
};

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "thermorig-calibration-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Least-squares line through measured over true rates; both streams come in the order of their bytes.
GyroTruth gyro_truth(const session::Session& session, const std::vector<simulation::SentMessage>& sent) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  std::size_t next = 0;
  for (const TimedGyro& sample : session.gyro) {
    while (next < sent.size() && sent[next].span.begin < sample.span.begin) ++next;
    if (next == sent.size() || sent[next].span.begin != sample.span.begin) continue;
    const double rate_dps = sent[next].mean_rate_dps;
    n += 1;
    x += rate_dps;
    y += sample.rate_dps;
    xx += rate_dps * rate_dps;
    xy += rate_dps * sample.rate_dps;
  }
  EXPECT_GT(n, 1000);
  const double spread = n * xx - x * x;
  if (spread < 1e-6 * n * n) return {1.0, y / n};  // nothing moved
  const double scale = (n * xy - x * y) / spread;
  return {scale, (y - scale * x) / n};
}

LabelTruth label_truth(const session::Session& session, const std::vector<simulation::SentMessage>& sent) {
  LabelTruth truth;
  std::size_t next = 0;
  for (std::size_t i = 0; i < session.frames.size() && i < session.samples.size(); ++i) {
    while (next < sent.size() && sent[next].span.begin < session.frames[i].span.begin) ++next;
    const LabelledSample& sample = session.samples[i];
    if (!sample.valid || next == sent.size() || sent[next].span.begin != session.frames[i].span.begin)
      continue;
    const double error_dps = sample.rate_shaft_dps - sent[next].mean_rate_dps;
    ++truth.frames;
    truth.error_dps += error_dps * error_dps;
    truth.uncertainty_dps += sample.rate_shaft_uncertainty_dps;
    truth.worst = std::max(truth.worst, std::abs(error_dps) / sample.rate_shaft_uncertainty_dps);
  }
  if (truth.frames == 0) return truth;
  truth.error_dps = std::sqrt(truth.error_dps / truth.frames);
  truth.uncertainty_dps /= truth.frames;
  return truth;
}

/// Least time from the device's instant (0 begin .. 1 end of the exposure) to the first byte on the wire:
/// what a clock from arrivals rests on, a device's own jitter being lateness to it.
double latency_truth_s(const std::vector<simulation::SentMessage>& sent, double instant) {
  double least_s = std::numeric_limits<double>::infinity();
  for (const simulation::SentMessage& message : sent)
    least_s = std::min(least_s, to_s(message.sent - message.exposure_end) +
                                    (1.0 - instant) * to_s(message.exposure_end - message.exposure_begin));
  return least_s;
}

double shaft_angle_deg(const std::vector<simulation::TruthSample>& shaft, HostTime time) {
  const auto at =
      std::lower_bound(shaft.begin(), shaft.end(), time,
                       [](const simulation::TruthSample& sample, HostTime t) { return sample.time < t; });
  return at == shaft.end() ? shaft.back().angle_deg : at->angle_deg;
}

/// Over the steady part of each leg: there the shaft lags by a constant.
double servo_truth(const session::Session& session, const std::vector<simulation::TruthSample>& shaft) {
  std::map<std::uint16_t, std::vector<const TimedServo*>> legs;
  for (const TimedServo& message : session.servo)
    if (message.state.leg != 0 && message.state.motion == ServoMotion::steady)
      legs[message.state.leg].push_back(&message);
  double turned_deg = 0, commanded_deg = 0;
  constexpr std::size_t settling = 50;
  for (const auto& [leg, messages] : legs) {
    if (messages.size() < 2 * settling) continue;
    const TimedServo& first = *messages[settling];
    const TimedServo& last = *messages.back();
    turned_deg +=
        std::abs(shaft_angle_deg(shaft, last.stamp.time) - shaft_angle_deg(shaft, first.stamp.time));
    commanded_deg += std::abs(last.state.angle_deg - first.state.angle_deg);
  }
  return commanded_deg > 0 ? turned_deg / commanded_deg : 1.0;
}

rig::VirtualOptions options_for(const simulation::VirtualRigConfig& config, const rig::SweepPlan& plan,
                                const std::filesystem::path& folder) {
  rig::VirtualOptions options;
  options.recording.environment = "calibration";
  options.recording.output = folder;
  options.recording.profile = config.profile;
  options.recording.plan = plan;
  options.recording.simulated = true;
  options.recording.simulation_seed = config.seed;
  options.recording.simulation = "virtual time, firmware's host build";
  options.recording.creator = "thermorig test";
  options.start = config.start;
  return options;
}

}  // namespace

simulation::VirtualRigConfig rig_with(std::uint64_t seed, const std::string& servo) {
  simulation::VirtualRigConfig config = simulation::default_rig(seed, "laboratory");
  if (servo == "continuous") {
    config.profile.servo.kind = ServoKind::continuous;
    config.profile.servo.travel_deg = 0;
    config.profile.servo.full_rate_dps = 300;
  } else if (servo != "winch") {
    config.profile.servo.travel_deg = std::stod(servo);
  }
  return config;
}

Recorded record(const simulation::VirtualRigConfig& config, const rig::SweepPlan& plan) {
  const Folder folder;
  TruthfulBus bus(config);
  const rig::RecordingResult result = rig::record_virtual(bus, options_for(config, plan, folder.path()));
  EXPECT_FALSE(result.session.empty()) << result.message;
  Recorded recorded{.session = session::read_session(result.session)};
  recorded.gyro = gyro_truth(recorded.session, bus.rig.sent_gyro());
  recorded.label = label_truth(recorded.session, bus.rig.sent_frames());
  recorded.camera_latency_s = latency_truth_s(bus.rig.sent_frames(), 1.0);
  recorded.gyro_latency_s = latency_truth_s(bus.rig.sent_gyro(), 0.5);
  recorded.servo_scale = servo_truth(recorded.session, bus.rig.shaft());
  return recorded;
}

rig::SweepPlan plan_for(rig::CalibrationKind kind, const simulation::VirtualRigConfig& config) {
  return rig::calibration_plan(kind, config.profile.servo, config.profile.camera);
}

std::string refusal(const std::function<void()>& measure) {
  try {
    measure();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::finished_lossy);
    EXPECT_FALSE(error.advice().empty());
    return error.what_happened();
  }
  return "nothing was refused";
}

}  // namespace thermorig::calibration
