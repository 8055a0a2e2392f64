// SPDX-License-Identifier: MIT
#include "timing_remarks.h"

#include <fmt/format.h>

#include <algorithm>

#include "output.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::app {

namespace {

class Remarks {
 public:
  void say(const std::string& sentence) { remarks_.sentences.push_back(sentence); }
  void advise(const std::string& command) {
    auto& advice = remarks_.advice;
    if (std::find(advice.begin(), advice.end(), command) == advice.end()) advice.push_back(command);
  }
  TimingRemarks take() { return std::move(remarks_); }

 private:
  TimingRemarks remarks_;
};

/// Simulated ports stand still with the program that serves them.
void remark_clock(Device device, const ClockReport& clock, bool simulated, Remarks& remarks) {
  if (clock.method.empty())
    return remarks.say(fmt::format("too little came from the {} to fit its clock", name_of(device)));
  if (clock.epochs.size() < 2) return;
  if (simulated) remarks.say("a simulator that stood still for a moment looks like a clock that was reset");
  remarks.advise(simulated
                     ? "record again on an idle computer, or with --fast: virtual time never stands still"
                     : "record again on an idle computer, with the board on a USB hub of its own");
}

void remark_offset(const session::Session& session, Remarks& remarks) {
  const PortProfile& link = session.raw.header.profile.camera.link;
  const CameraOffset& offset = session.sync.camera_offset;
  if (offset.applied || !link.latency_measured_utc.empty()) return;
  remarks.say(fmt::format("the camera's delay is assumed (+- {:.1f} ms){}",
                          1e3 * session.sync.clock[Device::camera].latency_uncertainty_s,
                          offset.why_not.empty() ? "" : ": " + offset.why_not));
  remarks.advise("thermorig calibrate latency");
}

void remark_gyro(const GyroErrors& gyro, bool has_servo, Remarks& remarks) {
  if (gyro.bias_dps) return;
  remarks.say("the gyro's bias is not known");
  if (!gyro.zeroes_itself)
    remarks.advise(has_servo ? "thermorig calibrate bias" : "record again, and begin with a rest of 10 s");
}

/// What the session says against its profile; the verdict has the figures.
void remark_constants(const session::Session& session, Remarks& remarks) {
  const GyroErrors& gyro = session.sync.gyro;
  if (gyro.scale_contradicts) remarks.advise("thermorig calibrate scale");
  if (session.sync.camera_offset.contradicts) remarks.advise("thermorig calibrate latency");
  if (gyro.filter_source.empty() || gyro.filter_contradicts) {
    if (!gyro.filter_contradicts)
      remarks.say("the delay of the gyro's filter is not known: all times may be shifted together");
    remarks.advise("state the gyro's bandwidth_hz in the profile, as its settings or its data sheet have it");
  }
  if (are_rows_apart(session.sync.camera_offset))
    remarks.say("the camera reads its rows one after the other: labels hold for the middle rows");
}

void remark_servo(const ServoResponse& servo, Remarks& remarks) {
  if (!servo.fitted) remarks.say("the servo's delay was not measured: the default is used");
  if (servo.scale_calibrated) return;
  remarks.say(
      fmt::format("the servo's scale is not calibrated (+- {:.1f} %)", 100 * servo.scale.uncertainty));
  remarks.advise("thermorig calibrate scale");
}

}  // namespace

bool has_timing(const session::Session& session) {
  return std::any_of(all_devices.begin(), all_devices.end(),
                     [&](Device device) { return !session.sync.clock[device].method.empty(); });
}

TimingRemarks timing_remarks(const session::Session& session) {
  if (!has_timing(session)) return {};
  Remarks remarks;
  const RigProfile& profile = session.raw.header.profile;
  const bool servo_sends_time = sensors::servo_protocol(profile.servo.protocol).clock.sends_time();
  if (profile.servo.is_there() && !servo_sends_time)
    remarks.say("the servo sends no time: it has no clock to fit");
  for (const Device device : all_devices)
    if (profile.has(device) && (device != Device::servo || servo_sends_time))
      remark_clock(device, session.sync.clock[device], session.raw.header.simulated, remarks);
  remark_offset(session, remarks);
  remark_gyro(session.sync.gyro, profile.servo.is_there(), remarks);
  remark_constants(session, remarks);
  if (profile.servo.is_there()) remark_servo(session.sync.servo, remarks);
  return remarks.take();
}

}  // namespace thermorig::app
