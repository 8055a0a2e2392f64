// SPDX-License-Identifier: MIT
// What is recorded, held against what the simulated rig did in truth: the bytes on pseudo terminals, and what
// is made of them in virtual time.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "recorder.h"
#include "rig/simulated_bus.h"
#include "rig/virtual_ports.h"
#include "servo_link.h"
#include "thermorig/rig/recording/port_recording.h"

namespace thermorig::tests {
namespace {

using simulation::PulseEdge;
using simulation::SentMessage;

constexpr int frames_per_leg = 10;
constexpr double clock_start_s = 0.0005;
constexpr double resolution_deg = 0.01;  // of an angle in telemetry
constexpr double late_ticks = 3.0;       // of an edge in simavr: the cycles of the instruction in hand
constexpr std::size_t camera_message_bytes = 1544, gyro_message_bytes = 11;

/// The built program on pseudo terminals.
class RecordedBytes : public RecorderOnPorts {
 protected:
  session::Session recorded() {
    const Outcome outcome = wait(start_recording(frames_per_leg));
    rig_.ports().stop();
    if (outcome.code != 0 && outcome.code != 3) throw std::runtime_error(outcome.out + outcome.err);
    return only_session();
  }
};

/// A gyro's sample stands for the middle of its interval: that half is in the profile's latency, not in the
/// board's.
simulation::VirtualRigConfig rig_as_late_as_its_profile_says() {
  simulation::VirtualRigConfig config = simulation::default_rig(3, "garden");
  config.camera_latency_s = config.profile.camera.link.latency_s;
  config.gyro_latency_s = config.profile.gyro.link.latency_s - 0.5 / config.profile.gyro.output_rate_hz;
  return config;
}

/// The same rig in virtual time, the AVR image in its servo where that is built. The devices have sent for a
/// while when the recorder opens their ports, in the middle of messages.
class RecordedTruth : public testing::Test {
 protected:
  session::Session recorded() {
    rig::PlanOverrides overrides;
    overrides.magnitudes_dps = {90.0};
    overrides.frames_per_leg = frames_per_leg;
    overrides.opening_rest_s = overrides.closing_rest_s = 0.3;
    rig::PortOptions options;
    options.recording = rig::test::recording_options(folder_, simulation::default_profile(),
                                                     rig::load_plan("quick", "garden", 1, overrides));
    for (const Device device : all_devices)
      options.recording.profile.link(device).port = ports_.paths()[device];
    ports_.let_pass(std::chrono::microseconds(1'234'567));
    const rig::RecordingResult result = rig::record_ports(options, ports_);
    EXPECT_TRUE(result.exit == ExitCode::ok || result.exit == ExitCode::finished_lossy) << result.message;
    return session::read_session(result.session);
  }

  rig::test::TemporaryFolder folder_;
  rig::test::VirtualPorts ports_{rig_as_late_as_its_profile_says(), make_firmware(FirmwareChoice::avr_image)};
};

/// At opening the program throws away what came before: the head. Between its last read and the closing of
/// the port more may be delivered: the tail. Everything between the two is in the file.
TEST_F(RecordedBytes, HoldEveryByteThatWasDeliveredFromTheFirstReadToTheLast) {
  const session::Session session = recorded();
  const PerDevice<std::size_t> bytes_per_s{{8 * camera_message_bytes, 200 * gyro_message_bytes, 100 * 30}};
  for (const Device device : all_devices) {
    const Extent extent = extent_of(device, session);
    EXPECT_LT(extent.head, bytes_per_s[device]) << name_of(device);
    EXPECT_LT(extent.tail, bytes_per_s[device]) << name_of(device);
    EXPECT_EQ(extent.size, read_from(device).value_or(read_ledger_port{extent.size, 0}).bytes)
        << name_of(device);
    EXPECT_EQ(rig_.ports().tally().ports[device].bytes_overrun, 0U) << name_of(device);
  }
}

TEST_F(RecordedTruth, HoldsEveryFrameAndEveryGyroSampleInOrder) {
  const session::Session session = recorded();
  const wire::Counters& camera = session.counters[Device::camera];
  const wire::Counters& gyro = session.counters[Device::gyro];
  EXPECT_EQ(camera.bytes_in_messages, session.frames.size() * camera_message_bytes);
  EXPECT_EQ(gyro.bytes_in_messages, (gyro.messages + gyro.replies) * gyro_message_bytes);
  EXPECT_EQ(gyro.messages, session.gyro.size());
  // All other bytes are the end of the message during which the port was opened, or the begin of the last.
  for (const auto& [counters, size] : {std::pair(camera, camera_message_bytes), {gyro, gyro_message_bytes}}) {
    EXPECT_LT(counters.bytes_skipped, size);
    EXPECT_LT(counters.bytes_pending, size);
    EXPECT_EQ(counters.bytes_in_damaged, 0U);
  }
  EXPECT_EQ(session.counters[Device::servo].lost, 0U);
  // What was sent and neither came unheard nor was delivered is still under way.
  const std::size_t sent = ports_.rig().sent_gyro().size() * gyro_message_bytes;
  const std::size_t arrived = ports_.bytes_unheard(Device::gyro) + ports_.delivered(Device::gyro).size();
  EXPECT_GT(ports_.bytes_unheard(Device::gyro), 0U);
  EXPECT_GE(sent, arrived);
  EXPECT_LT(sent - arrived, 20 * gyro_message_bytes);  // 100 ms
}

double pulse_angle_deg(const ServoProfile& servo, double width_us) {
  const double middle_us = (servo.pulse_min_us + servo.pulse_max_us) / 2.0;
  return (width_us - middle_us) / (servo.pulse_max_us - servo.pulse_min_us) * servo.travel_deg;
}

/// The pulse that rose last by `mcu_us`.
const PulseEdge* pulse_at(const std::vector<PulseEdge>& pulses, std::int64_t mcu_us) {
  const auto after = std::upper_bound(pulses.begin(), pulses.end(), mcu_us,
                                      [](std::int64_t us, const PulseEdge& p) { return us < p.rise_us; });
  return after == pulses.begin() ? nullptr : &*(after - 1);
}

/// The commanded angle `us` before telemetry, as its own speed tells.
double angle_before_deg(const ServoState& state, std::int64_t us) {
  return state.angle_deg - state.rate_dps * static_cast<double>(us) * 1e-6;
}

/// The firmware sets a pulse 1 ms before it rises, every 20 ms; telemetry comes every 10 ms. The pulse that
/// rose at or just before a telemetry message shows the angle of 1 ms before its rise, rounded to a tick of
/// a sixteenth of a microsecond; simavr shows each edge up to 3 ticks late. Timing adds what the speed may
/// change by between the two instants, and the start of the firmware's clock: less than half a millisecond
/// after the reset, from which the pulses are timed.
TEST_F(RecordedTruth, TelemetryNamesTheAngleOfThePulsesThatTheServoReallyGot) {
  const session::Session session = recorded();
  const ServoProfile& servo = session.raw.header.profile.servo;
  const double tick_deg =
      1.0 / SERVO_TICKS_PER_US / (servo.pulse_max_us - servo.pulse_min_us) * servo.travel_deg;
  const auto& pulses = ports_.rig().pulses();
  int compared = 0;
  for (const TimedServo& telemetry : session.servo) {
    const ServoState& state = telemetry.state;
    const PulseEdge* pulse = pulse_at(pulses, telemetry.mcu_time_us + 1000);
    if (pulse == nullptr || state.motion == ServoMotion::disarmed) continue;
    const std::int64_t age_us = telemetry.mcu_time_us - (pulse->rise_us - 1000);
    if (age_us > 21'000 || state.pulse_us == 0.0F) continue;  // it was armed after that
    EXPECT_NEAR(state.pulse_us, pulse->width_us, late_ticks / SERVO_TICKS_PER_US) << telemetry.mcu_time_us;
    const double age_s = static_cast<double>(age_us) * 1e-6;
    const double change_dps2 =
        state.fault == ServoFault::none ? servo.acceleration_dps2 : SERVO_EMERGENCY_DPS2;
    const double timing_deg =
        0.5 * change_dps2 * age_s * age_s + std::abs(state.rate_dps) * clock_start_s + resolution_deg;
    EXPECT_NEAR(pulse_angle_deg(servo, pulse->width_us), angle_before_deg(state, age_us),
                (0.5 + late_ticks) * tick_deg + timing_deg)
        << telemetry.mcu_time_us;
    ++compared;
  }
  EXPECT_GT(compared, 200);
}

/// The frame that the rig really sent, by its bytes: what came while no program had the port open is not in
/// the session.
const SentMessage& truth_of(const TimedFrame& frame, std::uint64_t unheard,
                            const std::vector<SentMessage>& sent) {
  const std::uint64_t end = frame.span.end + unheard;
  const auto at =
      std::lower_bound(sent.begin(), sent.end(), end,
                       [](const SentMessage& message, std::uint64_t e) { return message.span.end < e; });
  if (at == sent.end() || at->span.end != end) throw std::runtime_error("no such frame was sent");
  return *at;
}

/// The boards are as late as the profile says, so what is left of a time's error is the clocks' own. The
/// servo's scale is not calibrated, and so short a sweep tells it to a percent.
TEST_F(RecordedTruth, ValidLabelsAndTheirTimesAreTrueAsFarAsIsSaid) {
  const session::Session session = recorded();
  const std::uint64_t unheard = ports_.bytes_unheard(Device::camera);
  std::size_t valid = 0;
  for (const LabelledSample& sample : session.samples) {
    const SentMessage& truth =
        truth_of(session.frames.at(sample.frame_index), unheard, ports_.rig().sent_frames());
    if (!sample.valid) continue;
    ++valid;
    EXPECT_LT(std::abs(to_s(sample.exposure_end - truth.exposure_end)), 0.001) << sample.frame_index;
    EXPECT_LT(std::abs(to_s(sample.exposure_begin - truth.exposure_begin)), 0.001) << sample.frame_index;
    const double error_dps = std::abs(double{sample.rate_shaft_dps} - truth.mean_rate_dps);
    EXPECT_LT(error_dps, 3.0 * double{sample.rate_shaft_uncertainty_dps}) << sample.frame_index;
    EXPECT_LT(error_dps, 1.0) << sample.frame_index;
    EXPECT_NEAR(std::abs(sample.rate_shaft_dps), 90.0, 0.02 * 90.0)
        << sample.frame_index;  // rule V0's own limit
  }
  EXPECT_GE(valid, 8U);
}

}  // namespace
}  // namespace thermorig::tests
