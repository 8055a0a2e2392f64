// SPDX-License-Identifier: MIT
#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "bench.h"
#include "simulation/simulated_ports/avr_firmware.h"
#include "thermorig/core/error.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::firmware_test {
namespace {

/// A folder that stands for $THERMORIG_LIBEXEC while it lives.
class Libexec {
 public:
  Libexec() : path_(testing::TempDir() + "libexec_" + std::to_string(getpid())) {
    std::filesystem::create_directories(path_);
    setenv("THERMORIG_LIBEXEC", path_.c_str(), 1);
  }
  ~Libexec() {
    unsetenv("THERMORIG_LIBEXEC");
    std::filesystem::remove_all(path_);
  }
  void put(const std::string& name, const std::string& text) {
    std::ofstream(path_ / name) << text;
    std::filesystem::permissions(path_ / name, std::filesystem::perms::owner_all);
  }

 private:
  std::filesystem::path path_;
};

TEST(AvrFirmware, IsNoneWhereTheImageIsMissing) {
  Libexec libexec;
  EXPECT_EQ(make_avr_firmware(), nullptr);
  libexec.put("thermorig-avr", "#!/bin/sh\n");
  EXPECT_EQ(make_avr_firmware(), nullptr);
}

TEST(ServoFirmwareImage, IsThereWithoutTheSimulatorToo) {
  Libexec libexec;
  EXPECT_FALSE(servo_firmware_image());
  libexec.put("servo_firmware.hex", "");
  ASSERT_TRUE(servo_firmware_image());
  EXPECT_EQ(servo_firmware_image()->filename(), "servo_firmware.hex");
}

TEST(AvrFirmware, SaysSoWhenItsProcessDies) {
  Libexec libexec;
  libexec.put("thermorig-avr", "#!/bin/sh\nexit 3\n");
  libexec.put("servo_firmware.hex", "");
  const auto firmware = make_avr_firmware();
  ASSERT_NE(firmware, nullptr);
  EXPECT_THROW(firmware->run_until(1000), Error);
}

TEST(HostFirmware, TheSameBytesGiveTheSameOutput) {
  const auto run = [] {
    Bench bench(simulation::make_host_firmware());
    bench.open(winch());
    bench.command(SERVO_RUN, payload_of(servo_run{1, 1, 12345, 3000, 2000}));
    bench.run_refreshed(2'000'000);
    std::vector<double> all;
    for (const auto& pulse : bench.pulses())
      all.push_back(pulse.width_us + static_cast<double>(pulse.rise_us));
    for (const auto& message : bench.telemetry_frames()) all.push_back(static_cast<double>(message.time_us));
    return all;
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace thermorig::firmware_test
