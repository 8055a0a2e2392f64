// SPDX-License-Identifier: MIT
// The servo draws its board's supply down, which resets the board: the session says so, and what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "servo_link.h"
#include "simulated_bus.h"

namespace thermorig::rig::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::uint8_t brown_out = 4;  // MCUSR of an AVR
constexpr std::uint8_t hardware_watchdog = 8;

/// Firmware that is reset once: its memory, its clock and its pulses begin anew.
class ResetFirmware : public simulation::Firmware {
 public:
  explicit ResetFirmware(std::int64_t reset_us) : reset_us_(reset_us) {}

  void receive(std::uint8_t byte, std::int64_t time_us) override {
    again_ == nullptr ? first_->receive(byte, time_us) : again_->receive(byte, time_us - reset_us_);
  }

  simulation::FirmwareOutput run_until(std::int64_t time_us) override {
    if (time_us < reset_us_) return first_->run_until(time_us);
    simulation::FirmwareOutput output;
    if (again_ == nullptr) {
      output = first_->run_until(reset_us_ - 1);
      again_ = simulation::make_host_firmware();
    }
    const simulation::FirmwareOutput more = again_->run_until(time_us - reset_us_);
    for (const simulation::UartByte& byte : more.bytes)
      output.bytes.push_back({byte.time_us + reset_us_, byte.value});
    for (const simulation::PulseEdge& pulse : more.pulses)
      output.pulses.push_back({pulse.rise_us + reset_us_, pulse.width_us});
    return output;
  }

  std::string description() const override { return first_->description(); }

 private:
  std::int64_t reset_us_;
  std::unique_ptr<simulation::Firmware> first_ = simulation::make_host_firmware();
  std::unique_ptr<simulation::Firmware> again_;
};

/// The host build knows no cause but power: another one for each frame that tells it.
class CauseOfReset {
 public:
  explicit CauseOfReset(std::uint8_t cause) : cause_(cause) { servo_decoder_reset(&decoder_); }

  std::vector<std::uint8_t> replaced(const std::vector<std::uint8_t>& bytes) {
    std::vector<std::uint8_t> frames;
    for (const std::uint8_t byte : bytes)
      if (servo_decoder_push(&decoder_, byte) == SERVO_DECODED_FRAME) add_frame(frames);
    return frames;
  }

 private:
  void add_frame(std::vector<std::uint8_t>& frames) {
    std::uint8_t* payload = decoder_.body + 2;
    if (decoder_.body[0] == SERVO_WELCOME) payload[5] = cause_;
    if (decoder_.body[0] == SERVO_EVENT && payload[0] == SERVO_EVENT_RESET) payload[1] = cause_;
    std::array<std::uint8_t, SERVO_FRAME_MAX> frame{};
    const std::uint8_t size = servo_frame(frame.data(), decoder_.body[0], decoder_.body[1], payload,
                                          servo_decoder_payload_size(&decoder_));
    frames.insert(frames.end(), frame.begin(), frame.begin() + size);
  }

  std::uint8_t cause_;
  servo_decoder decoder_{};
};

/// The default rig, whose servo board is reset once.
class ResetBus : public DeviceBus {
 public:
  ResetBus(double reset_s, std::uint8_t cause)
      : reset_(HostTime(from_s(reset_s))),
        rig_(simulation::default_rig(4, "kitchen"),
             std::make_unique<ResetFirmware>(static_cast<std::int64_t>(1e6 * reset_s))),
        cause_(cause) {}

  void send(Device to, std::span<const std::uint8_t> bytes, HostTime now) override {
    rig_.send(to, bytes, now);
  }

  std::vector<Chunk> advance(HostTime until) override {
    std::vector<Chunk> chunks = rig_.advance(until);
    for (Chunk& chunk : chunks)
      if (chunk.device == Device::servo && chunk.arrived >= reset_)
        chunk.bytes = cause_.replaced(chunk.bytes);
    std::erase_if(chunks, [](const Chunk& chunk) { return chunk.bytes.empty(); });
    return chunks;
  }

 private:
  HostTime reset_;
  simulation::VirtualRig rig_;
  CauseOfReset cause_;
};

/// The session of the short plan with legs of five seconds, in which the board is reset after `reset_s`.
session::Session recorded_with_reset(double reset_s, std::uint8_t cause) {
  const TemporaryFolder folder;
  ResetBus bus(reset_s, cause);
  VirtualOptions options;
  options.recording = recording_options(folder, simulation::default_profile(), short_plan());
  options.recording.plan.frames_per_leg = 40;
  const RecordingResult result = record_virtual(bus, options);
  EXPECT_EQ(result.state, session::State::complete) << result.message;
  return session::read_session(result.session);
}

std::vector<RecordingEvent> warnings_of_supply(const session::Session& session) {
  std::vector<RecordingEvent> found;
  for (const RecordingEvent& event : session.raw.events)
    if (event.message.find("supply") != std::string::npos) found.push_back(event);
  return found;
}

TEST(BrownOut, IsAnEventOfTheSessionThatNamesItAndSaysWhatToDo) {
  const session::Session session = recorded_with_reset(6.0, brown_out);
  const auto warnings = warnings_of_supply(session);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].kind, EventKind::warning);
  EXPECT_EQ(warnings[0].source, Device::servo);
  EXPECT_GT(warnings[0].time, HostTime(from_s(6.0)));
  EXPECT_THAT(warnings[0].message,
              AllOf(HasSubstr("brown-out"), HasSubstr("a supply of its own"), HasSubstr("470 uF")));
}

TEST(BrownOut, HasItsLegDrivenAgain) {
  const session::Session session = recorded_with_reset(6.0, brown_out);
  int complete = 0, cut = 0;
  for (const LegRecord& leg : session.raw.legs) ++(leg.complete ? complete : cut);
  EXPECT_EQ(complete, 4);
  EXPECT_EQ(cut, 1);
}

TEST(BrownOut, IsNotClaimedOfAnotherReset) {
  EXPECT_TRUE(warnings_of_supply(recorded_with_reset(6.0, hardware_watchdog)).empty());
}

}  // namespace
}  // namespace thermorig::rig::test
