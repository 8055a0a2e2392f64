// SPDX-License-Identifier: MIT
// Servos that do not carry our firmware, in virtual time: whole recordings, and what stops when the host
// dies.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <deque>
#include <thread>

#include "struck_leg.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/discovery/detect.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/rig/sweep/servo_driver.h"
#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::rig::test::bus_servos {
namespace {

using ::testing::HasSubstr;

constexpr double until_rest_s = 0.5;

simulation::VirtualRigConfig rig_config(std::uint64_t seed, const std::string& protocol = "dynamixel") {
  simulation::VirtualRigConfig config = simulation::default_rig(seed, "garden");
  sensors::choose_servo(protocol, config.profile.servo);
  if (protocol == "dynamixel") config.profile.servo.link.baud = 1'000'000;
  return config;
}

class BusServoRig : public ::testing::Test {
 protected:
  RecordingResult record(const simulation::VirtualRigConfig& config, const SweepPlan& plan,
                         const std::optional<ServoProfile>& profile = {}) {
    bus_.emplace(config, simulation::make_servo(config));
    VirtualOptions options;
    options.recording = recording_options(folder_, config.profile, plan);
    if (profile) options.recording.profile.servo = *profile;
    return record_virtual(*bus_, options);
  }

  TemporaryFolder folder_;
  std::optional<SimulatedBus> bus_;
};

class EachBusServo : public BusServoRig, public ::testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Protocols, EachBusServo, ::testing::Values("dynamixel", "grbl", "sts3215"),
                         [](const auto& protocol) { return std::string(protocol.param); });

TEST_P(EachBusServo, DrivesAPlanAndItsTelemetryCarriesTheLegs) {
  const simulation::VirtualRigConfig config = rig_config(1, GetParam());
  const RecordingResult result = record(config, short_plan());
  ASSERT_EQ(result.exit, ExitCode::ok) << result.message;
  const session::Session session = session::read_session(result.session);
  EXPECT_FALSE(session.raw.header.firmware.empty());
  ASSERT_EQ(session.raw.legs.size(), 4U);
  constexpr double half_a_unit_dps = 0.69;
  for (const LegRecord& leg : session.raw.legs) {
    EXPECT_TRUE(std::any_of(session.samples.begin(), session.samples.end(),
                            [&](const LabelledSample& sample) {
                              return sample.leg == leg.leg && sample.valid &&
                                     std::abs(sample.rate_commanded_dps - leg.rate_dps) < half_a_unit_dps;
                            }))
        << leg.leg;
  }
}

TEST_P(EachBusServo, HasItsValidFramesCountedOnTheWay) {
  PlanOverrides overrides;
  overrides.magnitudes_dps = {90.0};
  const RecordingResult result =
      record(rig_config(4, GetParam()), load_plan("quick", "garden", 1, overrides));
  ASSERT_EQ(result.exit, ExitCode::ok) << result.message;
  for (const RecordingEvent& event : session::read_raw(result.session).events)
    EXPECT_THAT(event.message, testing::Not(HasSubstr("valid frames short")));
}

TEST_P(EachBusServo, IsFoundByPortsWithAllThatAProfileNeeds) {
  simulation::VirtualRigConfig config = rig_config(8, GetParam());
  if (config.profile.servo.protocol != "grbl") config.profile.servo.bus_id = 7;
  VirtualPorts ports(config, simulation::make_servo(config));
  ports.set_baud(Device::servo, config.profile.servo.link.baud);
  const auto findings = identify_devices({{.path = ports.paths()[Device::servo]}}, ports);
  ASSERT_EQ(findings.at(0).role, Device::servo) << findings[0].how;
  std::vector<std::string> ambiguous;
  const ServoProfile found = apply_findings(simulation::default_profile(), findings, ambiguous).servo;
  EXPECT_EQ(found.protocol, GetParam());
  EXPECT_EQ(found.bus_id, config.profile.servo.bus_id);
  EXPECT_EQ(found.link.baud, config.profile.servo.link.baud);
}

TEST_P(EachBusServo, OnAPortWithoutABaudRateGetsItsUsualOne) {
  const simulation::VirtualRigConfig config = rig_config(8, GetParam());
  VirtualPorts ports(config, simulation::make_servo(config));
  const auto findings = identify_devices({{.path = ports.paths()[Device::servo]}}, ports);
  std::vector<std::string> ambiguous;
  const ServoProfile found = apply_findings(simulation::default_profile(), findings, ambiguous).servo;
  EXPECT_EQ(found.protocol, GetParam());
  EXPECT_EQ(found.link.baud, sensors::servo_protocol(GetParam()).bauds.front().baud);
}

TEST_P(EachBusServo, MeasuresTheSimulatedShaftWhereItsProtocolSaysSo) {
  simulation::VirtualRigConfig config = rig_config(8, GetParam());
  config.has_encoder = true;  // which only our own firmware would ask
  EXPECT_NE(simulation::measures_shaft(config), sensors::servo_protocol(GetParam()).shaft_sensor.empty());
}

class EachServoWithAnId : public BusServoRig, public ::testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Protocols, EachServoWithAnId, ::testing::Values("dynamixel", "sts3215"),
                         [](const auto& protocol) { return std::string(protocol.param); });

TEST_P(EachServoWithAnId, IsReadAllTheSameThroughAnAdapterThatEchoes) {
  simulation::VirtualRigConfig config = rig_config(2, GetParam());
  config.dynamixel.echoes = config.sts3215.echoes = true;
  const RecordingResult result = record(config, two_legs(12));
  EXPECT_EQ(result.exit, ExitCode::ok) << result.message;
}

TEST_P(EachBusServo, TurnsBackAtTheEndsOfItsTravelInALegThatIsLonger) {
  simulation::VirtualRigConfig config = rig_config(3, GetParam());
  config.profile.servo.travel_deg = 270.0;
  const RecordingResult result = record(config, two_legs(40));
  EXPECT_EQ(result.exit, ExitCode::ok) << result.message;
  const session::Session session = session::read_session(result.session);
  // What its sensor says is all that is known of an STS3215, whose speed is uneven.
  const double limit_deg = *angle_limit_deg(config.profile.servo) + 1.0;
  for (const TimedServo& servo : session.servo) EXPECT_LE(std::abs(servo.state.angle_deg), limit_deg);
}

TEST_P(EachServoWithAnId, IsNamedWhereItIsAnotherOne) {
  const simulation::VirtualRigConfig config = rig_config(4, GetParam());
  ServoProfile other_id = config.profile.servo;
  other_id.bus_id = 3;
  try {
    record(config, two_legs(12), other_id);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::device_missing);
    EXPECT_THAT(error.what_happened(), HasSubstr("the servo with ID 1 answers, but none with ID 3"));
  }
}

using GrblRig = BusServoRig;

TEST_F(GrblRig, SpeedsAreThoseOfItsStepsByTheHostsClockAndNotOfItsResonator) {
  simulation::VirtualRigConfig config = rig_config(6, "grbl");
  config.grbl.clock_error = 0.005;
  const RecordingResult result = record(config, two_legs(50));
  ASSERT_EQ(result.exit, ExitCode::ok) << result.message;
  const session::Session session = session::read_session(result.session);
  std::size_t steady = 0;
  for (const TimedServo& servo : session.servo) {
    if (servo.state.motion != ServoMotion::steady) continue;
    EXPECT_NEAR(std::abs(servo.state.rate_dps), 90.0 * 1.005, 90.0 * 0.0015);
    ++steady;
  }
  EXPECT_GT(steady, 100U);
  EXPECT_NEAR(session.sync.clock[Device::servo].skew_ppm, -5000.0, 1500.0);
}

TEST_F(GrblRig, StepsADegreeThatAreSetWrongAreNamed) {
  simulation::VirtualRigConfig config = rig_config(7, "grbl");
  config.grbl.steps_error = -0.2;
  const RecordingResult result = record(config, two_legs(60));
  const session::Session session = session::read_session(result.session);
  EXPECT_THAT(session.sync.witnesses.cause, HasSubstr("$100 = 28.444"));
  EXPECT_THAT(session.sync.witnesses.remedy, HasSubstr("set $100=3"));
}

using Sts3215Rig = BusServoRig;

TEST_F(Sts3215Rig, TurnsByMoreThanTheOneTurnOfItsSettingsAndItsSensorMeasuresTheShaft) {
  simulation::VirtualRigConfig config = rig_config(3, "sts3215");
  config.sts3215.complains = true;
  const RecordingResult result = record(config, two_legs(40));
  ASSERT_EQ(result.exit, ExitCode::ok) << result.message;
  const session::Session session = session::read_session(result.session);
  EXPECT_EQ(session.raw.header.shaft_sensor, "STS3215");
  const auto [least, most] = std::minmax_element(
      session.shaft.begin(), session.shaft.end(),
      [](const auto& a, const auto& b) { return a.reading.angle_deg < b.reading.angle_deg; });
  EXPECT_GT(most->reading.angle_deg - least->reading.angle_deg, 400.0);
}

TEST_F(Sts3215Rig, AnotherServoThatAnswersAlikeIsRefused) {
  simulation::VirtualRigConfig config = rig_config(4, "sts3215");
  config.sts3215.model = 5;
  try {
    record(config, two_legs(12));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::device_missing);
    EXPECT_THAT(error.what_happened(), HasSubstr("not an STS3215"));
  }
}

TEST_F(Sts3215Rig, OneThatDoesNotAnswerWritesIsNamed) {
  simulation::VirtualRigConfig config = rig_config(4, "sts3215");
  config.sts3215.answers_writes = false;
  try {
    record(config, two_legs(12));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::device_missing);
    EXPECT_THAT(error.advice(), HasSubstr("register 8"));
  }
}

/// From then on it is another one that was just switched on, which knows nothing of the first.
class LosesItsSupply : public simulation::Firmware {
 public:
  LosesItsSupply(const simulation::VirtualRigConfig& config, double at_s)
      : at_us_(std::llround(1e6 * at_s)),
        before_(simulation::make_servo(config)),
        after_(simulation::make_servo(config)) {}

  void receive(std::uint8_t byte, std::int64_t time_us) override {
    time_us < at_us_ ? before_->receive(byte, time_us) : after_->receive(byte, time_us - at_us_);
  }
  simulation::FirmwareOutput run_until(std::int64_t time_us) override {
    if (time_us < at_us_) return before_->run_until(time_us);
    simulation::FirmwareOutput output = after_->run_until(time_us - at_us_);
    for (simulation::UartByte& byte : output.bytes) byte.time_us += at_us_;
    return output;
  }
  std::optional<double> shaft_deg(double time_us) const override {
    const auto at_us = static_cast<double>(at_us_);
    return time_us < at_us ? before_->shaft_deg(time_us) : after_->shaft_deg(time_us - at_us);
  }
  std::string description() const override { return before_->description(); }

 private:
  std::int64_t at_us_;
  std::unique_ptr<simulation::Firmware> before_, after_;
};

TEST_P(EachBusServo, ThatWasOffForAMomentInALegIsNotDrivenOnFromAnAngleThatItDoesNotKnow) {
  const simulation::VirtualRigConfig config = rig_config(9, GetParam());
  bus_.emplace(config, std::make_unique<LosesItsSupply>(config, 5.0));
  VirtualOptions options;
  options.recording = recording_options(folder_, config.profile, two_legs(40));
  const RecordingResult result = record_virtual(*bus_, options);
  EXPECT_EQ(result.exit, ExitCode::device_lost) << result.message;
  EXPECT_THAT(result.message, testing::AnyOf(HasSubstr("its supply may have failed"),
                                             HasSubstr("GRBL has not answered a line")));  // it boots
}

/// Without a watchdog a leg, of up to ten seconds here, is turned to its end.
double rest_after_s(const std::string& protocol) {
  return protocol == "sts3215" ? 10.5 : until_rest_s;
}

/// The servo comes to rest though nobody speaks to it any more.
class HostDies : public ::testing::TestWithParam<const char*>, protected StruckLeg {
 protected:
  HostDies() : StruckLeg(rig_config(5, GetParam())) {}

  void expect_rest_until(HostTime end) {
    ASSERT_TRUE(struck_);
    EXPECT_GT(fastest_dps(*struck_ - from_s(1.0), *struck_), moving_dps);
    ASSERT_LT(*struck_ + from_s(rest_after_s(GetParam())), end);
    EXPECT_LT(fastest_dps(*struck_ + from_s(rest_after_s(GetParam())), end), rest_dps);
  }
};

INSTANTIATE_TEST_SUITE_P(Protocols, HostDies, ::testing::Values("dynamixel", "grbl", "sts3215"),
                         [](const auto& protocol) { return std::string(protocol.param); });

TEST_P(HostDies, ByACableThatIsPulledAndTheServoRests) {
  const RecordingResult result = suffer([this] { ports_.unplug(Device::servo); });
  EXPECT_EQ(result.exit, ExitCode::device_lost) << result.message;
  ports_.let_pass(std::chrono::seconds(11));
  expect_rest_until(ports_.now());
}

TEST_P(HostDies, ForASecondAndTheSessionIsComplete) {
  constexpr auto a_second = std::chrono::seconds(1);
  const RecordingResult result = suffer([&] { ports_.stand_still(a_second); });
  EXPECT_EQ(result.state, session::State::complete) << result.message;
  // One that drives its leg to the end is driven on by then.
  if (from_s(rest_after_s(GetParam())) < a_second) expect_rest_until(*struck_ + a_second);
}

TEST_P(HostDies, ForLongerThanALegAndTheServoRests) {
  constexpr auto longer = std::chrono::seconds(12);
  suffer([&] { ports_.stand_still(longer); });
  expect_rest_until(*struck_ + longer);
}

constexpr double killed_at_s = 6.0;  // in the first leg

/// The shaft after a recorder was killed (-9) in the first leg, for half a minute.
std::vector<simulation::TruthSample> shaft_after_a_kill(const simulation::VirtualRigConfig& config) {
  SimulatedBus bus(config, simulation::make_servo(config));
  bus.rig.keep_truth(true);
  const TemporaryFolder folder;
  RunOptions run;
  run.give_up_at_s = killed_at_s;
  const DrivenRun driven = run_to_journal(bus, recording_options(folder, config.profile, two_legs(80)), run);
  EXPECT_FALSE(driven.failure);
  bus.advance(HostTime{} + from_s(killed_at_s));
  EXPECT_GT(std::abs(bus.rig.shaft().back().rate_dps), moving_dps);
  bus.advance(HostTime{} + from_s(killed_at_s + 30.0));
  return bus.rig.shaft();
}

class KilledRecorder : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Protocols, KilledRecorder, ::testing::Values("dynamixel", "grbl"),
                         [](const auto& protocol) { return std::string(protocol.param); });

TEST_P(KilledRecorder, LeavesTheServoAtRest) {
  for (const simulation::TruthSample& sample : shaft_after_a_kill(rig_config(6, GetParam())))
    if (sample.time > HostTime{} + from_s(killed_at_s + until_rest_s)) {
      ASSERT_LT(std::abs(sample.rate_dps), rest_dps);
    }
}

class ServoWithoutAWatchdog : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Protocols, ServoWithoutAWatchdog, ::testing::Values("dynamixel", "sts3215"),
                         [](const auto& protocol) { return std::string(protocol.param); });

TEST_P(ServoWithoutAWatchdog, RestsAtTheEndOfItsLegAfterAKill) {
  simulation::VirtualRigConfig config = rig_config(6, GetParam());
  config.dynamixel.has_watchdog = false;
  const auto shaft = shaft_after_a_kill(config);
  EXPECT_LT(std::abs(shaft.back().rate_dps), rest_dps);
  EXPECT_LT(std::abs(shaft.back().angle_deg), config.profile.servo.travel_deg / 2.0);
}

/// GRBL has no such state: what was noted is all that telemetry has of it.
TEST(GrblDriver, NotesADisarmThatOvertakesAnArm) {
  const ServoProfile servo = rig_config(1, "grbl").profile.servo;
  const auto made = make_servo_driver(servo);
  ServoDriver& driver = *made;
  HostTime now = HostTime{} + from_s(10.0);
  const auto said = [&] {
    const auto bytes = driver.poll(now += std::chrono::milliseconds(10));
    return std::string(bytes.begin(), bytes.end());
  };
  const auto answer = [&](const std::string& line) {
    driver.answer({.body = wire::ServoReply{.data = {line.begin(), line.end()}}}, now);
  };
  const auto report_rest = [&] {
    TimedServo report;
    report.stamp.arrival = report.stamp.time = now += std::chrono::milliseconds(10);
    driver.telemetry(report);
  };
  driver.greet();
  driver.answer({.body = wire::ServoWelcome{}}, now);
  EXPECT_EQ(said(), "$$\n");
  answer(fmt::format("$120={}", servo.acceleration_dps2));
  answer("ok");
  report_rest();
  ASSERT_TRUE(driver.greeted());
  driver.arm(0.0);
  EXPECT_THAT(said(), HasSubstr("(armed)"));
  driver.disarm();
  answer("ok");  // to the note before
  EXPECT_FALSE(driver.idle());
  EXPECT_THAT(said(), HasSubstr("\x85"));
  report_rest();
  EXPECT_THAT(said(), HasSubstr("(disarmed)"));
  answer("ok");
  EXPECT_FALSE(driver.armed());
  EXPECT_TRUE(driver.idle());
}

TEST(GrblDriver, TimesAReportThatTakesLongerThanThePeriodOfItsRequests) {
  const ServoProfile servo = rig_config(1, "grbl").profile.servo;
  const auto driver = make_servo_driver(servo);
  const HostTime start = HostTime{} + from_s(10.0);
  HostTime now = start;
  const auto answer = [&](const std::string& line) {
    driver->answer({.body = wire::ServoReply{.data = {line.begin(), line.end()}}}, now);
  };
  driver->greet();
  driver->answer({.body = wire::ServoWelcome{}}, now);
  driver->poll(now);
  answer(fmt::format("$120={}", servo.acceleration_dps2));
  answer("ok");
  constexpr auto takes = std::chrono::milliseconds(120);
  std::deque<HostTime> reports;
  int timed = 0;
  for (; now < start + std::chrono::seconds(2); now += std::chrono::milliseconds(10)) {
    while (!reports.empty() && reports.front() <= now) {
      TimedServo report;
      report.stamp.arrival = report.stamp.time = reports.front();
      reports.pop_front();
      const auto took = driver->telemetry(report);
      ASSERT_TRUE(took);
      EXPECT_EQ(*took, takes);
      ++timed;
    }
    const auto bytes = driver->poll(now);
    if (std::find(bytes.begin(), bytes.end(), std::uint8_t{'?'}) != bytes.end())
      reports.push_back(now + takes);
  }
  EXPECT_GT(timed, 10);
}

/// By the clock: the recorder is a process of its own, and something happens to it in its first leg.
enum class Blow : std::uint8_t { stopped, killed, unplugged };
struct Struck {
  const char* protocol;
  Blow blow;
};

class BusServoDrill : public ::testing::TestWithParam<Struck> {
 protected:
  /// Records until it is ended, and writes a byte to `moves` for each frame of a leg.
  static void record(const SimulatedPorts& ports, const RecordingOptions& recording, int moves) {
    alarm(60);
    PortOptions options;
    options.recording = recording;
    options.recording.virtual_time = false;
    for (const Device device : all_devices)
      options.recording.profile.link(device).port = ports.paths()[device];
    options.progress_period = std::chrono::milliseconds(50);
    options.progress = [&](const RecordingProgress& progress) {
      if (progress.sweep.phase == SweepPhase::leg && progress.sweep.frames >= 4 && write(moves, "m", 1) < 1)
        _exit(1);
    };
    SystemPortLoop loop;
    try {
      record_ports(options, loop);
    } catch (const std::exception&) {
    }
    _exit(0);
  }
};

std::string name_of(const Struck& struck) {
  constexpr std::array names{"Stopped", "Killed", "Unplugged"};
  return fmt::format("{}{}", struck.protocol, names[static_cast<std::size_t>(struck.blow)]);
}

INSTANTIATE_TEST_SUITE_P(Servos, BusServoDrill,
                         ::testing::Values(Struck{"dynamixel", Blow::stopped}, Struck{"grbl", Blow::stopped},
                                           Struck{"sts3215", Blow::stopped}, Struck{"sts3215", Blow::killed},
                                           Struck{"sts3215", Blow::unplugged}),
                         [](const auto& struck) { return name_of(struck.param); });

TEST_P(BusServoDrill, LeavesTheServoOnPseudoTerminalsAtRest) {
  // A leg of 0.75 s, with what is added to its goal 3.2 s; others rest in 0.4. More for a machine that is
  // busy: one that never rests turns for longer than ten.
  const bool rests_soon = std::string_view(GetParam().protocol) != "sts3215";
  const double rests_within_s = rests_soon ? 0.8 : 3.9;
  const simulation::VirtualRigConfig config = rig_config(7, GetParam().protocol);
  const TemporaryFolder folder;
  SimulatedPorts ports(config, FirmwareChoice::host_build);
  ports.keep_truth();
  int moves[2];
  ASSERT_EQ(pipe(moves), 0);
  const pid_t recorder = fork();
  if (recorder == 0)
    record(ports, recording_options(folder, config.profile, two_legs(rests_soon ? 80 : 6)), moves[1]);
  close(moves[1]);
  ports.start();
  char moving = 0;
  EXPECT_EQ(read(moves[0], &moving, 1), 1);
  if (GetParam().blow == Blow::unplugged)
    ports.unplug(Device::servo);
  else
    kill(recorder, GetParam().blow == Blow::stopped ? SIGSTOP : SIGKILL);
  const HostTime struck = io::now();
  std::this_thread::sleep_for(std::chrono::duration<double>(rests_within_s + 0.2));
  ports.stop();
  kill(recorder, SIGKILL);
  waitpid(recorder, nullptr, 0);
  close(moves[0]);
  double fastest_before_dps = 0.0, fastest_after_dps = 0.0;
  for (const simulation::TruthSample& sample : ports.rig().shaft()) {
    const double rate_dps = std::abs(sample.rate_dps);
    if (sample.time < struck) fastest_before_dps = std::max(fastest_before_dps, rate_dps);
    if (sample.time > struck + from_s(rests_within_s))
      fastest_after_dps = std::max(fastest_after_dps, rate_dps);
  }
  EXPECT_GT(fastest_before_dps, moving_dps);
  EXPECT_LT(fastest_after_dps, rest_dps);
}

}  // namespace
}  // namespace thermorig::rig::test::bus_servos
