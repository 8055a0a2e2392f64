// SPDX-License-Identifier: MIT
// Devices that stay plugged in and are wrong all the same: garbage, messages that repeat for ever, resets.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <random>
#include <thread>

#include "rig/recording/frozen_watch.h"
#include "simulated_bus.h"
#include "support/at_s.h"
#include "thermorig/rig/recording/port_recording.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/wire/camera_scanner.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::rig::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

bool within(HostTime now, double begin_s, double end_s) {
  return now >= at_s(begin_s) && now < at_s(end_s);
}

SimulatedBus::Damage garbage(double begin_s, double end_s) {
  return [=, random = std::mt19937(7)](std::vector<std::uint8_t> bytes, HostTime now) mutable {
    if (within(now, begin_s, end_s))
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    return bytes;
  };
}

/// From `begin_s` to `end_s` the device repeats its last message, as often as it would have sent others.
template <typename Message, typename Scanner>
SimulatedBus::Damage frozen(Scanner scanner, double begin_s, double end_s) {
  struct State {
    Scanner scanner;
    std::vector<Message> messages;
    std::vector<std::uint8_t> before;
    std::size_t owed = 0;
  };
  return [=, state = std::make_shared<State>(State{std::move(scanner), {}, {}, 0})](
             std::vector<std::uint8_t> bytes, HostTime now) {
    if (now < at_s(begin_s)) {
      state->scanner.push(bytes, state->messages);
      state->before.insert(state->before.end(), bytes.begin(), bytes.end());
    }
    if (!within(now, begin_s, end_s)) return bytes;
    const StreamSpan span = state->messages.back().span;
    const auto message = std::span(state->before).subspan(span.begin, span.size());
    std::vector<std::uint8_t> repeated;
    for (state->owed += bytes.size(); state->owed >= message.size(); state->owed -= message.size())
      repeated.insert(repeated.end(), message.begin(), message.end());
    return repeated;
  };
}

SimulatedBus::Damage frozen_camera(double begin_s, double end_s) {
  return frozen<wire::CameraMessage>(wire::CameraScanner(), begin_s, end_s);
}
SimulatedBus::Damage frozen_gyro(double begin_s, double end_s) {
  return frozen<wire::GyroMessage>(sensors::gyro_scanner({}), begin_s, end_s);
}

/// A recording of the short plan with legs of five seconds.
struct Troubled {
  explicit Troubled(double patience_s = 30.0) {
    options.recording = recording_options(folder, simulation::default_profile(), short_plan());
    options.recording.plan.frames_per_leg = 40;
    options.recording.replug_patience_s = patience_s;
    options.progress = [this](const RecordingProgress& progress) {
      events.insert(events.end(), progress.events.begin(), progress.events.end());
    };
  }
  std::vector<std::string> told(EventKind kind) const {
    std::vector<std::string> messages;
    for (const RecordingEvent& event : events)
      if (event.kind == kind) messages.push_back(event.message);
    return messages;
  }

  TemporaryFolder folder;
  SimulatedBus bus{simulation::default_rig(4, "kitchen")};
  VirtualOptions options;
  std::vector<RecordingEvent> events;
};

TEST(Trouble, GarbageInTheMiddleIsNamedAndWaitedFor) {
  for (const Device device : all_devices) {
    Troubled run;
    run.bus.from_device[index_of(device)] = garbage(4.0, 12.0);
    const RecordingResult result = record_virtual(run.bus, run.options);
    EXPECT_EQ(result.state, session::State::complete) << result.message;
    ASSERT_EQ(run.told(EventKind::device_lost).size(), 1U) << name_of(device);
    if (device != Device::servo) {  // which is given up sooner, for a command that is not answered
      EXPECT_THAT(run.told(EventKind::device_lost)[0], AllOf(HasSubstr("it has sent"), HasSubstr("but no ")));
    }
    EXPECT_EQ(run.told(EventKind::device_back).size(), 1U);
  }
}

TEST(Trouble, LinesThatGoOnWithAnotherColumnAreTold) {
  simulation::VirtualRigConfig config = simulation::default_rig(4, "kitchen");
  config.profile.gyro.protocol = "text";
  Troubled run;
  run.options.recording.profile = config.profile;
  SimulatedBus bus(config);
  bus.from_device[index_of(Device::gyro)] = [](std::vector<std::uint8_t> bytes, HostTime now) {
    std::vector<std::uint8_t> changed;
    for (const std::uint8_t byte : bytes) {
      if (byte == '\r' && now > at_s(6.0)) changed.insert(changed.end(), {',', '7'});
      changed.push_back(byte);
    }
    return changed;
  };
  const RecordingResult result = record_virtual(bus, run.options);
  const auto warnings = run.told(EventKind::warning);
  EXPECT_EQ(std::count_if(warnings.begin(), warnings.end(),
                          [](const std::string& message) {
                            return message.find("number of columns") != std::string::npos;
                          }),
            1)
      << result.message;
}

TEST(Trouble, EndlessGarbageEndsItWithAdvice) {
  Troubled run(6.0);
  run.bus.from_device[index_of(Device::camera)] = garbage(4.0, 1000.0);
  const RecordingResult result = record_virtual(run.bus, run.options);
  EXPECT_EQ(result.exit, ExitCode::device_lost);
  EXPECT_THAT(result.message, AllOf(HasSubstr("but no camera frames in them"), HasSubstr("within 6 s"),
                                    HasSubstr("too few messages of the camera")));
  EXPECT_THAT(result.advice, HasSubstr("(460800 is expected)"));
}

TEST(Trouble, ACameraThatRepeatsAFrameForEverIsNoticed) {
  Troubled run;
  run.bus.from_device[index_of(Device::camera)] = frozen_camera(4.0, 12.0);
  const RecordingResult result = record_virtual(run.bus, run.options);
  EXPECT_EQ(result.state, session::State::complete) << result.message;
  ASSERT_EQ(run.told(EventKind::device_lost).size(), 1U);
  EXPECT_THAT(run.told(EventKind::device_lost)[0], AllOf(HasSubstr("the same frame"), HasSubstr("it hangs")));
  EXPECT_EQ(run.told(EventKind::device_back).size(), 1U);
  const session::Session session = session::read_session(result.session);
  for (const LabelledSample& sample : session.samples)
    if (sample.exposure_begin > at_s(4.2) && sample.exposure_end < at_s(12.0)) {
      EXPECT_FALSE(sample.valid);
    }
}

TEST(Trouble, AGyroThatRepeatsASampleForEverIsNoticedWhileTheServoTurns) {
  Troubled run;
  run.bus.from_device[index_of(Device::gyro)] = frozen_gyro(4.0, 12.0);
  const RecordingResult result = record_virtual(run.bus, run.options);
  EXPECT_EQ(result.state, session::State::complete) << result.message;
  ASSERT_EQ(run.told(EventKind::device_lost).size(), 1U);
  EXPECT_THAT(run.told(EventKind::device_lost)[0],
              HasSubstr("the same sample for 1 s while the servo turned"));
  EXPECT_EQ(run.told(EventKind::device_back).size(), 1U);
}

TEST(Trouble, AFrozenDeviceThatStaysSoIsNotTakenForBack) {
  for (const Device device : {Device::camera, Device::gyro}) {
    Troubled run(8.0);
    run.bus.from_device[index_of(device)] =
        device == Device::camera ? frozen_camera(4.0, 1000.0) : frozen_gyro(4.0, 1000.0);
    const RecordingResult result = record_virtual(run.bus, run.options);
    EXPECT_EQ(result.exit, ExitCode::device_lost) << name_of(device);
    EXPECT_THAT(result.message, AllOf(HasSubstr("it hangs"), HasSubstr("within 8 s")));
    EXPECT_THAT(result.advice, HasSubstr("plug it in again"));
  }
}

TEST(Trouble, ARigThatZeroesItsGyroAtRestIsNotFrozen) {
  Troubled run;
  simulation::VirtualRigConfig config = simulation::default_rig(4, "kitchen");
  config.gyro_zeroes_itself = true;
  SimulatedBus bus(config);
  const RecordingResult result = record_virtual(bus, run.options);
  EXPECT_TRUE(run.told(EventKind::device_lost).empty());
  EXPECT_EQ(result.state, session::State::complete);
}

TEST(Trouble, ARigThatZeroesItsGyroIsNotFrozenWhileTheServoIsAway) {
  Troubled run;
  simulation::VirtualRigConfig config = simulation::default_rig(4, "kitchen");
  config.gyro_zeroes_itself = true;
  SimulatedBus bus(config);
  bus.unplugged = {{Device::servo, at_s(4.0), at_s(12.0)}};
  const RecordingResult result = record_virtual(bus, run.options);
  EXPECT_EQ(result.state, session::State::complete) << result.message;
  ASSERT_EQ(run.told(EventKind::device_lost).size(), 1U);
  EXPECT_THAT(run.told(EventKind::device_lost)[0], HasSubstr("servo"));
}

TEST(Trouble, AFrozenGyroThatIsNotNeededIsNotTakenForBack) {
  Troubled run;
  run.options.recording.needed[Device::gyro] = false;
  run.bus.from_device[index_of(Device::gyro)] = frozen_gyro(4.0, 12.0);
  const RecordingResult result = record_virtual(run.bus, run.options);
  EXPECT_EQ(result.exit, ExitCode::finished_lossy) << result.message;
  ASSERT_EQ(run.told(EventKind::missing).size(), 1U);
  ASSERT_EQ(run.told(EventKind::device_back).size(), 1U);
  const auto back = std::find_if(run.events.begin(), run.events.end(), [](const RecordingEvent& event) {
    return event.kind == EventKind::device_back;
  });
  EXPECT_GT(back->time, at_s(12.0));
}

/// A gyro's samples and the servo's telemetry, 100 a second.
struct Watched {
  FrozenWatch watch;
  int step = 0;
  void turn(double commanded_dps, std::array<float, 3> rate_dps, bool saturated, int steps) {
    for (int i = 0; i < steps; ++i, ++step) {
      TimedServo servo;
      servo.stamp.arrival = at_s(0.01 * step);
      servo.state.mcu_us = static_cast<std::uint32_t>(10'000 * step);
      servo.state.rate_dps = commanded_dps;
      watch.servo(servo);
      TimedGyro gyro;
      gyro.stamp.arrival = at_s(0.01 * step);
      gyro.reading.rate_dps = rate_dps;
      gyro.reading.saturated = saturated;
      watch.gyro(gyro);
    }
  }
};

TEST(Trouble, AGyroOfOneAxisInWholeDegreesASecondIsNotFrozen) {
  Watched rig;
  for (int leg = 0; leg < 4; ++leg) {
    const double rate_dps = leg % 2 == 0 ? 60.0 : -60.0;
    rig.turn(rate_dps, {0.0F, 0.0F, static_cast<float>(-rate_dps)}, false, 15);  // the shaft follows late
    rig.turn(rate_dps, {0.0F, 0.0F, static_cast<float>(rate_dps)}, false, 500);
    EXPECT_FALSE(rig.watch.trouble(Device::gyro));
    rig.turn(0.0, {0.0F, 0.0F, 0.0F}, false, 100);
  }
}

TEST(Trouble, AGyroOfOneAxisThatStaysOverAChangeOfTheSpeedIsFrozen) {
  Watched rig;
  rig.turn(60.0, {0.0F, 0.0F, 60.0F}, false, 300);
  rig.turn(-60.0, {0.0F, 0.0F, 60.0F}, false, 90);
  EXPECT_FALSE(rig.watch.trouble(Device::gyro));
  rig.turn(-60.0, {0.0F, 0.0F, 60.0F}, false, 20);
  EXPECT_TRUE(rig.watch.trouble(Device::gyro));
}

TEST(Trouble, AGyroAtTheEndOfItsRangeIsNotFrozen) {
  Watched rig;
  rig.turn(200.0, {1.0F, 2.0F, 150.0F}, true, 300);
  rig.turn(220.0, {1.0F, 2.0F, 150.0F}, true, 300);
  EXPECT_FALSE(rig.watch.trouble(Device::gyro));
}

TEST(Trouble, ACameraThatGoesBehindTheLastFrameDoesNotEndACompletePlan) {
  for (const Device device : {Device::camera, Device::gyro}) {
    Troubled run;
    const auto progress = run.options.progress;
    run.options.progress_period = std::chrono::milliseconds(1);
    run.options.progress = [&, progress](const RecordingProgress& now) {
      progress(now);
      if (now.sweep.phase == SweepPhase::halting && run.bus.unplugged.empty())
        run.bus.unplugged = {{device, now.time, at_s(1000.0)}};
    };
    const RecordingResult result = record_virtual(run.bus, run.options);
    EXPECT_EQ(result.state, session::State::complete) << result.message;
    EXPECT_EQ(result.exit, ExitCode::ok) << result.message;
    ASSERT_FALSE(run.bus.unplugged.empty());
    const auto warnings = run.told(EventKind::warning);
    EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& message) {
      return message.find("after the plan's last frame") != std::string::npos;
    }));
  }
}

TEST(Trouble, AServoWhoseClockStandsStillIsNoticed) {
  FrozenWatch watch;
  TimedServo servo;
  servo.state.mcu_us = 77;
  for (int i = 0; i <= 150; ++i) {
    servo.stamp.arrival = at_s(0.01 * i);
    watch.servo(servo);
  }
  ASSERT_TRUE(watch.trouble(Device::servo));
  EXPECT_THAT(*watch.trouble(Device::servo), HasSubstr("stood still"));
  servo.state.mcu_us = 78;
  EXPECT_TRUE(watch.servo(servo));
  EXPECT_FALSE(watch.trouble(Device::servo));
}

TEST(Trouble, ACameraThatStartsAnewWithinItsPatienceIsMissingFrames) {
  Troubled run;
  run.bus.is_cut = [](Device device, HostTime now) {
    return device == Device::camera && within(now, 4.0, 5.6);
  };
  const RecordingResult result = record_virtual(run.bus, run.options);
  EXPECT_EQ(result.state, session::State::complete) << result.message;
  EXPECT_TRUE(run.told(EventKind::device_lost).empty());
  const session::Session session = session::read_session(result.session);
  const auto gap =
      std::max_element(session.frames.begin(), session.frames.end(),
                       [](const auto& a, const auto& b) { return a.missing_before < b.missing_before; });
  EXPECT_NEAR(gap->missing_before, 13, 2);
  EXPECT_FALSE(session.samples.at(static_cast<std::size_t>(gap - session.frames.begin())).valid);
}

/// A rig whose servo board is another one from `since_s` on, just switched on: one that was reset.
class ResetBoard : public SimulatedBus {
 public:
  ResetBoard(const simulation::VirtualRigConfig& config, double since_s)
      : SimulatedBus(config),
        since_(at_s(since_s)),
        board_(started(config, since_), simulation::make_host_firmware()) {}

  void send(Device to, std::span<const std::uint8_t> bytes, HostTime now) override {
    if (to == Device::servo && now >= since_ && is_plugged(now))
      board_.send(to, bytes, now);
    else
      SimulatedBus::send(to, bytes, now);
  }
  std::vector<Chunk> advance(HostTime until) override {
    std::vector<Chunk> chunks = SimulatedBus::advance(until);
    if (until < since_) return chunks;
    std::erase_if(
        chunks, [&](const Chunk& chunk) { return chunk.device == Device::servo && chunk.arrived >= since_; });
    for (Chunk& chunk : board_.advance(until))
      if (chunk.device == Device::servo && is_plugged(chunk.arrived)) chunks.push_back(std::move(chunk));
    return chunks;
  }

 private:
  static simulation::VirtualRigConfig started(simulation::VirtualRigConfig config, HostTime since) {
    config.start = since;
    return config;
  }
  bool is_plugged(HostTime time) const {
    return std::none_of(unplugged.begin(), unplugged.end(), [&](const simulation::Outage& outage) {
      return outage.device == Device::servo && outage.begin <= time && time < outage.end;
    });
  }
  HostTime since_;
  simulation::VirtualRig board_;
};

TEST(Trouble, AServoBoardThatIsResetIsGreetedAndTheLegDrivenAgain) {
  Troubled run;
  ResetBoard bus(simulation::default_rig(4, "kitchen"), 4.0);
  const RecordingResult result = record_virtual(bus, run.options);
  EXPECT_EQ(result.state, session::State::complete) << result.message;
  EXPECT_FALSE(run.told(EventKind::leg_repeated).empty());
  const session::Session session = session::read_session(result.session);
  EXPECT_GE(session.sync.clock[Device::servo].epochs.size(), 2U);
}

TEST(Trouble, AServoBoardThatLosesItsPowerWithItsPlugIsArmedAnew) {
  Troubled run;
  ResetBoard bus(simulation::default_rig(4, "kitchen"), 6.0);
  bus.unplugged = {{Device::servo, at_s(4.0), at_s(7.0)}};
  const RecordingResult result = record_virtual(bus, run.options);
  EXPECT_EQ(result.state, session::State::complete) << result.message;
  EXPECT_EQ(run.told(EventKind::device_back).size(), 1U);
  const session::Session session = session::read_session(result.session);
  EXPECT_EQ(session.sync.clock[Device::servo].epochs.size(), 2U);
}

TEST(Trouble, ASecondProgramThatTakesBytesIsVisibleAsLoss) {
  const TemporaryFolder folder;
  SimulatedPorts ports(simulation::default_rig(1, "kitchen"), FirmwareChoice::host_build);
  ports.start();
  PortOptions options;
  options.recording = recording_options(folder, simulation::default_profile(), short_plan());
  options.recording.virtual_time = false;
  for (const Device device : all_devices) options.recording.profile.link(device).port = ports.paths()[device];
  constexpr int enough = 500;  // bytes
  std::atomic<bool> steals = false, ends = false;
  std::atomic<int> taken = 0;
  std::thread thief([&] {
    const int port = open(ports.paths()[Device::gyro].c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
    std::array<char, 7> bytes;  // never a whole message: those nobody would miss
    while (!ends) {
      if (!steals || taken >= enough)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      else if (const ssize_t size = read(port, bytes.data(), bytes.size()); size > 0) {
        taken += static_cast<int>(size);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));  // so that the rest is the recorder's
      }
    }
    close(port);
  });
  std::uint64_t spoilt = 0;
  options.progress_period = std::chrono::milliseconds(100);
  options.progress = [&](const RecordingProgress& progress) {
    steals = progress.elapsed_s > 1.5;
    const DeviceHealth& gyro = progress.health[Device::gyro];
    spoilt = gyro.lost + gyro.bad + gyro.skipped_bytes;
  };
  const RecordingResult result = record_ports(options);
  ends = true;
  thief.join();
  ASSERT_GT(taken, 0);
  EXPECT_GT(spoilt, 0U);
  const session::Session session = session::read_session(result.session);
  const auto lost = std::count_if(session.gyro.begin(), session.gyro.end(),
                                  [](const TimedGyro& sample) { return sample.lost_before; });
  EXPECT_GT(lost, 0);
}

}  // namespace
}  // namespace thermorig::rig::test
