// SPDX-License-Identifier: MIT
// avrdude flashes a board's boot loader on a pseudo terminal. It waits for a board by the clock: what takes
// it more than two seconds is run at night.
#include "thermorig/rig/setup/flash.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include "app/program.h"
#include "boot_loader.h"
#include "simulated_bus.h"
#include "simulated_ports/heard.h"
#include "support/file_text.h"
#include "thermorig/core/error.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::rig::test {
namespace flash {

using ::testing::HasSubstr;

const std::filesystem::path programs = std::filesystem::path(THERMORIG_BINARY_DIR) / "bin";

/// The firmware's image is put onto a board.
class Flash : public ::testing::Test {
 protected:
  std::optional<Error> flash(const std::string& port) {
    try {
      flash_firmware({.port = port,
                      .image = (programs / "servo_firmware.hex").string(),
                      .say = [this](const std::string& line) { said_ += line; },
                      .attempts = 1,
                      .avrdude = avrdude_});
    } catch (const Error& error) {
      return error;
    }
    return std::nullopt;
  }

  static bool is_night() { return std::getenv("THERMORIG_EVERYTHING") != nullptr; }

  std::string avrdude_ = "avrdude", said_;
};

/// As thermorig-avr runs the image that `board` holds.
class FlashedFirmware {
 public:
  explicit FlashedFirmware(const BootLoader& board) {
    std::ofstream(folder_.path() / "servo_firmware.hex") << board.hex();
    std::filesystem::create_symlink(programs / "thermorig-avr", folder_.path() / "thermorig-avr");
    setenv("THERMORIG_LIBEXEC", folder_.path().c_str(), 1);
    firmware = make_firmware(FirmwareChoice::avr_image);
    unsetenv("THERMORIG_LIBEXEC");
  }

 private:
  TemporaryFolder folder_;

 public:
  std::unique_ptr<simulation::Firmware> firmware;
};

TEST_F(Flash, PutsTheImageOnAnUnoAndItBootsInSimavr) {
  BootLoader board(115200);
  const auto error = flash(board.path());
  ASSERT_FALSE(error) << error->what();
  EXPECT_TRUE(board.has_left());
  EXPECT_THAT(said_, HasSubstr("-b 115200"));
  const FlashedFirmware flashed(board);
  ASSERT_EQ(flashed.firmware->description(), "AVR image");
  std::int64_t time_us = 100'000;
  for (const std::uint8_t byte : wire::hello_bytes(0)) flashed.firmware->receive(byte, time_us += 100);
  Heard heard;
  for (const simulation::UartByte& byte : flashed.firmware->run_until(300'000).bytes)
    heard.take(Device::servo, {&byte.value, 1});
  EXPECT_EQ(heard.count<wire::ServoWelcome>(), 1U);
  EXPECT_TRUE(heard.is_undamaged());
}

TEST_F(Flash, SaysThatThereIsNoAvrdude) {
  avrdude_ = "no-such-avrdude";
  const auto error = flash("/dev/null");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ExitCode::failed);
  EXPECT_THAT(error->what_happened(), HasSubstr("is not installed"));
}

TEST_F(Flash, SaysThatThereIsNoPort) {
  const auto error = flash("/dev/no-such-port");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ExitCode::device_missing);
  EXPECT_THAT(error->what_happened(), HasSubstr("there is no such port"));
}

/// The first speed is not heard, the second one is.
TEST_F(Flash, TriesTheSpeedOfANanoWithTheOldBootLoader) {
  if (!is_night()) GTEST_SKIP() << "takes 4 s: tests/nightly.sh runs it";
  BootLoader board(57600);
  const auto error = flash(board.path());
  ASSERT_FALSE(error) << error->what();
  EXPECT_TRUE(board.has_left());
  EXPECT_THAT(said_, HasSubstr("-b 57600"));
  EXPECT_EQ(FlashedFirmware(board).firmware->description(), "AVR image");
}

struct Unflashable {
  const char* name;
  int baud;
  BootFault fault;
  ExitCode code;
  const char* what;
  const char* advice;
};

const Unflashable unflashable[] = {
    {"AnotherChip", 115200, BootFault::other_chip, ExitCode::failed,
     "not an ATmega328P; its signature is 0x1e9801", "an Uno or a Nano"},
    {"NoBootLoader", 115200, BootFault::silent, ExitCode::failed, "no boot loader answers",
     "is it the servo's"},
    {"AnotherSpeed", 9600, BootFault::none, ExitCode::failed, "answers, but not as a boot loader",
     "Nothing was written"},
    {"APlugPulledWhileFlashing", 115200, BootFault::stops_answering, ExitCode::failed,
     "its program is incomplete", "its boot loader is still there"}};

class FlashFails : public Flash, public ::testing::WithParamInterface<Unflashable> {};

INSTANTIATE_TEST_SUITE_P(Because, FlashFails, ::testing::ValuesIn(unflashable),
                         [](const auto& test) { return test.param.name; });

TEST_P(FlashFails, WithWhatStandsInTheWayAndWhatTheBoardHolds) {
  if (!is_night()) GTEST_SKIP() << "takes up to 12 s: tests/nightly.sh runs it";
  BootLoader board(GetParam().baud, GetParam().fault);
  const auto error = flash(board.path());
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), GetParam().code);
  EXPECT_THAT(error->what_happened(), HasSubstr(GetParam().what));
  EXPECT_THAT(error->advice(), HasSubstr(GetParam().advice));
  EXPECT_EQ(error->where(), board.path());
}

TEST_F(Flash, EndsAvrdudeFirstWhereItIsInterrupted) {
  if (!is_night()) GTEST_SKIP() << "takes 2 s: tests/nightly.sh runs it";
  for (const int signal : {SIGINT, SIGTERM}) {
    BootLoader board(115200, BootFault::none, [signal](int page) {
      if (page == 5) kill(getpid(), signal);
      usleep(5'000);
    });
    const auto error = flash(board.path());
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ExitCode::interrupted);
    EXPECT_THAT(error->what_happened(), HasSubstr("its program is incomplete"));
    EXPECT_LT(board.pages(), 76);
    EXPECT_FALSE(flash(board.path())) << "the boot loader is still there";
  }
}

/// Silent until it is flashed; then thermorig-avr runs what it holds.
class FlashedBoard : public simulation::Firmware {
 public:
  void begin(const BootLoader& board) {
    flashed_ = std::make_unique<FlashedFirmware>(board);
    is_flashed_ = true;
  }
  void receive(std::uint8_t byte, std::int64_t time_us) override {
    if (begin_us_) flashed_->firmware->receive(byte, time_us - *begin_us_);
  }
  simulation::FirmwareOutput run_until(std::int64_t time_us) override {
    if (is_flashed_ && !begin_us_) begin_us_ = time_us;
    if (!begin_us_ || time_us <= *begin_us_) return {};
    simulation::FirmwareOutput output = flashed_->firmware->run_until(time_us - *begin_us_);
    for (simulation::UartByte& byte : output.bytes) byte.time_us += *begin_us_;
    for (simulation::PulseEdge& pulse : output.pulses) pulse.rise_us += *begin_us_;
    return output;
  }
  std::string description() const override { return "AVR image"; }

 private:
  std::unique_ptr<FlashedFirmware> flashed_;
  std::atomic<bool> is_flashed_{false};
  std::optional<std::int64_t> begin_us_;
};

class FlashedBySetup : public tests::ProgramTest {
 protected:
  template <class Done>
  void wait_until(Done done) const {
    for (int i = 0; i < 600 && !done(); ++i) usleep(100'000);
    EXPECT_TRUE(done()) << tests::file_text(folder() / "background_err.txt");
  }
};

/// The board has the same name before and behind: its firmware is on a pseudo terminal of its own.
TEST_F(FlashedBySetup, IsFoundAsAServo) {
  if (std::getenv("THERMORIG_EVERYTHING") == nullptr) GTEST_SKIP() << "takes 20 s: tests/nightly.sh runs it";
  BootLoader board(115200);
  auto firmware = std::make_unique<FlashedBoard>();
  FlashedBoard& flashed = *firmware;
  SimulatedPorts ports(simulation::default_rig(1, "kitchen"), std::move(firmware));
  ports.start();
  std::filesystem::create_symlink(board.path(), folder() / "servo");
  const pid_t setup = start({"setup", "--flash", "--yes", "--json", "--save", "./rig.toml",
                             ports.paths()[Device::camera], ports.paths()[Device::gyro], "./servo"});
  wait_until([&] { return board.has_left(); });
  flashed.begin(board);
  std::filesystem::create_symlink(ports.paths()[Device::servo], folder() / "flashed");
  std::filesystem::rename(folder() / "flashed", folder() / "servo");
  const auto out = [this] { return tests::file_text(folder() / "background_out.txt"); };
  wait_until([&] { return out().find("\"step\":\"look\"") != std::string::npos; });
  kill(setup, SIGINT);
  EXPECT_NE(wait(setup).code, 0);
  EXPECT_THAT(out(), HasSubstr("flashed"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "rig.toml"));
}

}  // namespace flash
}  // namespace thermorig::rig::test
