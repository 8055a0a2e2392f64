// SPDX-License-Identifier: MIT
#include "timing_verdict.h"

#include <fmt/format.h>

#include <algorithm>

#include "output.h"

namespace thermorig::app {

namespace {

// A clock that is not known to a millisecond moves a label of a fast frame by more than its own error; ten
// milliseconds are what plain arrival times do.
constexpr double good_clock_us = 1000.0;
constexpr double bad_clock_us = 10'000.0;
// The label rule's own measure of a steady speed: 1 deg/s.
constexpr double good_residual_dps = 1.0;
constexpr double bad_residual_dps = 5.0;

class Judge {
 public:
  void usable(const std::string& reason) { against(reason, "usable"); }
  void bad(const std::string& reason) { against(reason, "bad"); }
  void advise(const std::string& command) {
    auto& advice = verdict_.advice;
    if (std::find(advice.begin(), advice.end(), command) == advice.end()) advice.push_back(command);
  }
  TimingVerdict take() { return std::move(verdict_); }

 private:
  void against(const std::string& reason, const std::string& word) {
    verdict_.reasons.push_back(reason);
    if (verdict_.word != "bad") verdict_.word = word;
  }
  TimingVerdict verdict_{.word = "good"};
};

void judge_clock(Device device, const ClockReport& clock, Judge& judge) {
  const std::string name(name_of(device));
  if (clock.method.empty()) return judge.bad("too little came from the " + name + " to fit its clock");
  if (clock.uncertainty_us > bad_clock_us)
    judge.bad(fmt::format("the {}'s times are known to {:.1f} ms only", name, clock.uncertainty_us / 1e3));
  else if (clock.uncertainty_us > good_clock_us)
    judge.usable(fmt::format("the {}'s times are known to {:.1f} ms only", name, clock.uncertainty_us / 1e3));
  if (clock.epochs.size() > 1)
    judge.usable(fmt::format("the {}'s clock began anew {} times: {}", name, clock.epochs.size() - 1,
                             printable(clock.epochs.back().reason)));
}

void judge_offset(const session::Session& session, Judge& judge) {
  const PortProfile& link = session.raw.header.profile.camera.link;
  const CameraOffset& offset = session.sync.camera_offset;
  if (offset.applied || !link.latency_measured_utc.empty()) return;
  judge.usable(fmt::format("how late the camera is rests on an assumption (+- {:.1f} ms){}",
                           1e3 * link.latency_uncertainty_s,
                           offset.why_not.empty() ? "" : ": " + printable(offset.why_not)));
  judge.advise("thermorig calibrate latency");
}

void judge_gyro(const GyroErrors& gyro, Judge& judge) {
  if (gyro.zeroes_itself) judge.usable("the gyro sets itself to zero at rest and hides its bias");
  if (!gyro.bias_dps) {
    judge.usable("the gyro's bias is not known");
    if (!gyro.zeroes_itself) judge.advise("thermorig calibrate bias");
  }
}

void judge_servo(const ServoResponse& servo, Judge& judge) {
  if (!servo.fitted) judge.usable("how the shaft follows the servo's pulses was not fitted");
  if (!servo.scale_calibrated) {
    judge.usable(
        fmt::format("the labels' scale is not calibrated (+- {:.1f} %)", 100 * servo.scale.uncertainty));
    judge.advise("thermorig calibrate scale");
  }
  if (!servo.fitted || servo.residual_dps <= good_residual_dps) return;
  const std::string reason = fmt::format("gyro and labels differ by {:.1f} deg/s", servo.residual_dps);
  if (servo.residual_dps > bad_residual_dps)
    judge.bad(reason);
  else
    judge.usable(reason);
}

}  // namespace

bool has_timing(const session::Session& session) {
  return std::any_of(all_devices.begin(), all_devices.end(),
                     [&](Device device) { return !session.sync.clock[device].method.empty(); });
}

TimingVerdict timing_verdict(const session::Session& session) {
  if (!has_timing(session)) return {.word = "unknown"};
  Judge judge;
  for (const Device device : all_devices) judge_clock(device, session.sync.clock[device], judge);
  judge_offset(session, judge);
  judge_gyro(session.sync.gyro, judge);
  judge_servo(session.sync.servo, judge);
  return judge.take();
}

}  // namespace thermorig::app
