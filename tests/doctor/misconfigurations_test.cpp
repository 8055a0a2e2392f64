// SPDX-License-Identifier: MIT
// Rigs and machines that are wrong in one way each: doctor or the preflight check names what is wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>

#include "made_host.h"
#include "storage/memory_disk.h"
#include "thermorig/sensors/wire/reset_cause.h"
#include "wrong_rigs.h"

namespace thermorig::doctor::test {
namespace {

// ---- the machine --------------------------------------------------------------------------------------

std::vector<Check> host_with(const std::function<void(const MadeHost&)>& wrong) {
  const MadeHost host;
  wrong(host);
  return judge_host(host.facts());
}

const std::string user_outside = "root:x:0:\ndialout:x:20:\n";

void take_group_away(const MadeHost& host) {
  host.write("/proc/self/status",
             "Uid:\t77777\t77777\t77777\t77777\nGid:\t1000\t1000\t1000\t1000\nGroups:\t1000 \n");
  host.write("/etc/passwd", "anna:x:77777:1000::/home/anna:/bin/sh\n");
}

void plug_in_bus(const MadeHost& host, const std::string& clock_frequency) {
  host.write("/dev/i2c-1", "");
  std::filesystem::permissions(host.root() / "dev/i2c-1", std::filesystem::perms(0666));
  host.write("/sys/class/i2c-dev/i2c-1/device/name", "bcm2835 (i2c@7e804000)\n");
  host.write("/sys/class/i2c-dev/i2c-1/device/of_node/clock-frequency", clock_frequency);
}

std::vector<Misconfiguration> wrong_machines() {
  return {
      {"no permission for the port",
       [] {
         return host_with([](const MadeHost& host) {
           take_group_away(host);
           host.write("/etc/group", user_outside);
           std::filesystem::permissions(host.root() / "dev/ttyUSB0", std::filesystem::perms(0600));
         });
       },
       "camera port", "may not be opened", "60-thermorig.rules", ExitCode::no_permission},
      {"put into the group, not logged in again", [] { return host_with(take_group_away); }, "user",
       "this login began before that", "log out and in again", std::nullopt},
      {"another program holds the port",
       [] {
         return host_with([](const MadeHost& host) {
           host.write("/proc/4711/comm", "screen\n");
           host.link("/proc/4711/fd/5", "/dev/ttyUSB0");
         });
       },
       "camera port", "process 4711 (screen)", "stop that program", ExitCode::no_permission},
      {"the port is not there",
       [] { return host_with([](const MadeHost& host) { host.remove("/dev/ttyUSB1"); }); }, "gyro port",
       "/dev/ttyUSB1 is not there", "USB cable", ExitCode::device_missing},
      {"a bus at the speed that a Raspberry Pi begins with",
       [] {
         const MadeHost host;
         plug_in_bus(host, std::string("\x00\x01\x86\xA0", 4));
         return judge_host(look_at_host(host.root(), {{"/dev/i2c-1", Device::camera}}));
       },
       "camera port speed", "100 kHz", "i2c_arm_baudrate=400000", std::nullopt},
      {"a bus that the user may not open",
       [] {
         const MadeHost host;
         plug_in_bus(host, std::string("\x00\x06\x1A\x80", 4));
         std::filesystem::permissions(host.root() / "dev/i2c-1", std::filesystem::perms(0600));
         return judge_host(look_at_host(host.root(), {{"/dev/i2c-1", Device::camera}}));
       },
       "camera port", "may not be opened", "usermod -aG", ExitCode::no_permission},
      {"no bus of that number",
       [] {
         const MadeHost host;
         return judge_host(look_at_host(host.root(), {{"/dev/i2c-1", Device::camera}}));
       },
       "camera port", "/dev/i2c-1 is not there", "raspi-config", ExitCode::device_missing},
      {"brltty's rule is installed",
       [] {
         return host_with([](const MadeHost& host) {
           host.write(
               "/usr/lib/udev/rules.d/85-brltty.rules",
               "# 10C4:EA60 is only named here\n"
               "ENV{PRODUCT}==\"1a86/7523/*\", ENV{BRLTTY_BRAILLE_DRIVER}=\"bm\", GOTO=\"brltty_usb_run\"\n");
         });
       },
       "brltty", "1a86:7523", "85-brltty.rules", std::nullopt},
      {"brltty has taken the adapter",
       [] {
         return host_with([](const MadeHost& host) {
           host.write("/lib/udev/rules.d/85-brltty.rules",
                      "ATTR{idVendor}==\"10C4\", ATTR{idProduct}==\"EA60\", RUN+=\"brltty\"\n");
           host.plug_in("", "1-5", "10c4:ea60", "");
           host.remove("/dev/ttyUSB1");
         });
       },
       "brltty", "10c4:ea60 is plugged in and has no port", "apt remove brltty", ExitCode::device_missing},
      {"ModemManager runs",
       [] { return host_with([](const MadeHost& host) { host.write("/proc/801/comm", "ModemManager\n"); }); },
       "ModemManager", "it runs", "ID_MM_PORT_IGNORE", std::nullopt},
      {"a port that nobody asked for is held",
       [] {
         const MadeHost host;
         host.write("/proc/4711/comm", "screen\n");
         host.link("/proc/4711/fd/5", "/dev/ttyUSB0");
         return judge_host(look_at_host(host.root(), {}));
       },
       "/dev/ttyUSB0", "process 4711 (screen)", "stop that program", std::nullopt},
      {"USB autosuspend",
       [] {
         return host_with([](const MadeHost& host) {
           host.write("/sys/devices/usb1/1-4.1/power/control", "auto\n");
           host.write("/sys/devices/usb1/1-4.1/power/autosuspend_delay_ms", "2000\n");
         });
       },
       "camera port power", "autosuspend", "sudo tee /sys/devices/usb1/1-4.1/power/control", std::nullopt},
      {"the clock is jiffies",
       [] {
         return host_with([](const MadeHost& host) {
           host.write("/sys/devices/system/clocksource/clocksource0/current_clocksource", "jiffies\n");
         });
       },
       "clock", "jiffies", "clocksource=", ExitCode::failed},
      {"the processor is kept slow",
       [] {
         return host_with([](const MadeHost& host) {
           host.write("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave\n");
           host.write("/sys/devices/system/cpu/cpu0/cpufreq/scaling_driver", "acpi-cpufreq\n");
         });
       },
       "processor", "powersave", "scaling_governor", std::nullopt},
      {"on battery",
       [] {
         return host_with([](const MadeHost& host) {
           host.write("/sys/class/power_supply/AC/type", "Mains\n");
           host.write("/sys/class/power_supply/AC/online", "0\n");
         });
       },
       "power", "on battery", "systemd-inhibit", std::nullopt},
      {"an old HDF5 plugin path",
       [] {
         return host_with([](const MadeHost& host) {
           host.write("/proc/self/environ", std::string("HDF5_PLUGIN_PATH=/opt/hdf5-1.8/plugin\0", 38));
         });
       },
       "HDF5 plugins", "/opt/hdf5-1.8/plugin\", which is not there", "unset HDF5_PLUGIN_PATH", std::nullopt},
      {"root",
       [] {
         return host_with([](const MadeHost& host) {
           host.write("/proc/self/status", "Uid:\t0\t0\t0\t0\nGid:\t0\t0\t0\t0\nGroups:\t0 \n");
         });
       },
       "user", "you are root", "a user in the group dialout", std::nullopt},
  };
}

// ---- the disk -----------------------------------------------------------------------------------------

/// A disk that refuses, or takes its time.
class SickDisk : public storage_test::MemoryDisk {
 public:
  SickDisk() : MemoryDisk({.files = {}, .folders = {"/recordings"}}) {}
  int create_error = 0;
  int append_error = 0;
  bool takes_nothing = false;  // and gives no reason
  double sync_s = 0.001;
  HostTime now{};

  files::Answer<files::OpenFile> create(const Path& path, unsigned mode) override {
    if (create_error != 0) return {files::OpenFile::none, create_error};
    return MemoryDisk::create(path, mode);
  }
  files::Answer<std::size_t> append(files::OpenFile file,
                                    std::span<const std::span<const std::byte>> parts) override {
    if (append_error != 0 || takes_nothing) return {0, append_error};
    now += std::chrono::milliseconds(1);
    return MemoryDisk::append(file, parts);
  }
  int sync(files::OpenFile file) override {
    now += from_s(sync_s);
    return MemoryDisk::sync(file);
  }
};

std::vector<Check> disk_with(const std::function<void(SickDisk&)>& wrong) {
  SickDisk disk;
  wrong(disk);
  try {
    return {judge_disk(measure_disk(disk, "/recordings", [&] { return disk.now; }), 20e3)};
  } catch (const Error& error) {
    return {{.name = "disk speed",
             .code = error.code(),
             .result = error.what_happened(),
             .advice = error.advice()}};
  }
}

std::vector<Misconfiguration> wrong_disks() {
  return {
      {"the disk is full", [] { return disk_with([](SickDisk& disk) { disk.append_error = ENOSPC; }); },
       "disk speed", "No space left", "--output", ExitCode::storage},
      {"the folder is read-only", [] { return disk_with([](SickDisk& disk) { disk.create_error = EROFS; }); },
       "disk speed", "Read-only", "permissions", ExitCode::storage},
      {"a slow disk", [] { return disk_with([](SickDisk& disk) { disk.sync_s = 20.0; }); }, "disk speed",
       "too slow", "a disk of this machine", ExitCode::storage},
      {"a disk whose syncs take long", [] { return disk_with([](SickDisk& disk) { disk.sync_s = 0.5; }); },
       "disk speed", "more than 125 ms", "a disk of this machine", std::nullopt},
  };
}

std::vector<Misconfiguration> all_misconfigurations() {
  std::vector<Misconfiguration> all = wrong_machines();
  for (const auto& more : {wrong_disks(), wrong_rigs()}) all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::string text_of(const std::vector<Check>& checks) {
  std::string text;
  for (const Check& check : checks)
    text += fmt::format("  {}: {}: {}\n", check.name, check.grade(), check.result);
  return text;
}

TEST(Misconfigurations, AreNamedEachOfThem) {
  const auto all = all_misconfigurations();
  std::size_t named = 0;
  for (const Misconfiguration& wrong : all) {
    const std::vector<Check> checks = wrong.look();
    const auto found = std::find_if(checks.begin(), checks.end(), [&](const Check& check) {
      return check.name == wrong.check && (check.failed() || check.warning) &&
             check.result.find(wrong.says) != std::string::npos;
    });
    if (found == checks.end()) {
      ADD_FAILURE() << wrong.name << " is not named:\n" << text_of(checks);
      continue;
    }
    EXPECT_EQ(found->code, wrong.code.value_or(ExitCode::ok)) << wrong.name;
    EXPECT_EQ(found->warning, !wrong.code.has_value()) << wrong.name;
    EXPECT_THAT(found->advice, ::testing::HasSubstr(wrong.advises)) << wrong.name;
    fmt::print("{:<55} {:<8} {}\n", wrong.name, found->grade(), found->result);
    ++named;
  }
  fmt::print("{} of {} misconfigurations are named\n", named, all.size());
  EXPECT_GE(all.size(), 20U);
}

TEST(Misconfigurations, AnFtdiAsItComesIsNone) {
  const auto checks = host_with(
      [](const MadeHost& host) { host.write("/sys/bus/usb-serial/devices/ttyUSB1/latency_timer", "16\n"); });
  const auto latency = std::find_if(checks.begin(), checks.end(),
                                    [](const Check& check) { return check.name == "gyro port latency"; });
  ASSERT_NE(latency, checks.end());
  EXPECT_EQ(latency->grade(), "ok");
  EXPECT_THAT(latency->result, ::testing::HasSubstr("asks for 1 ms"));
}

TEST(Misconfigurations, TheRulesOfThePackageKeepBrlttyOffAndNeedNoGroup) {
  const auto checks = host_with([](const MadeHost& host) {
    host.write("/usr/lib/udev/rules.d/85-brltty.rules",
               "ENV{PRODUCT}==\"1a86/7523/*\", ENV{BRLTTY_BRAILLE_DRIVER}=\"bm\"\n");
    for (const std::string name : {"60-thermorig.rules", "91-thermorig-brltty.rules"})
      std::filesystem::copy_file(THERMORIG_SOURCE_DIR "/app/packaging/" + name,
                                 host.root() / "usr/lib/udev/rules.d" / name);
    take_group_away(host);
    host.write("/etc/group", user_outside);
  });
  const auto named = [&](const std::string& name) {
    return *std::find_if(checks.begin(), checks.end(),
                         [&](const Check& check) { return check.name == name; });
  };
  EXPECT_EQ(named("brltty").result, "it leaves a rig's adapters alone");
  EXPECT_EQ(named("user").result, "anna may open the ports without being in the group dialout");
  EXPECT_FALSE(named("user").warning);
}

TEST(Misconfigurations, WhereNothingIsPluggedInThatIsSaid) {
  const auto checks = judge_host(HostFacts{});
  const auto ports =
      std::find_if(checks.begin(), checks.end(), [](const Check& check) { return check.name == "ports"; });
  ASSERT_NE(ports, checks.end());
  EXPECT_EQ(ports->grade(), "warning");
  EXPECT_THAT(ports->advice, ::testing::HasSubstr("USB data cables"));
}

TEST(Misconfigurations, OnlyASupplyThatWasOnCanBreakDown) {
  EXPECT_TRUE(wire::was_brown_out(0x04));
  EXPECT_TRUE(wire::was_brown_out(0x06));
  EXPECT_FALSE(wire::was_brown_out(0x05));  // switched on
  EXPECT_FALSE(wire::was_brown_out(0x02));
}

TEST(Misconfigurations, TheDiskTestLeavesNoFileWhereverItEnds) {
  SickDisk disk;
  int named = 0;
  measure_disk(disk, "/recordings", [&] {
    named += static_cast<int>(disk.list("/recordings").value.size());
    return disk.now;
  });
  EXPECT_EQ(named, 0);
}

TEST(Misconfigurations, ADiskThatTakesNothingIsFull) {
  const auto checks = disk_with([](SickDisk& disk) { disk.takes_nothing = true; });
  EXPECT_EQ(checks.front().code, ExitCode::storage);
  EXPECT_THAT(checks.front().result, ::testing::HasSubstr("No space left"));
}

TEST(Misconfigurations, AGoodMachineAndAGoodRigAreOk) {
  const MadeHost host;
  std::vector<Check> checks = judge_host(host.facts());
  for (const auto& more : {rig_with([](rig::test::SimulatedBus&) {}), disk_with([](SickDisk&) {})})
    checks.insert(checks.end(), more.begin(), more.end());
  EXPECT_GT(checks.size(), 12U);
  for (const Check& check : checks) EXPECT_EQ(check.grade(), "ok") << check.name << ": " << check.result;
  EXPECT_EQ(exit_code_of(checks), ExitCode::ok);
}

TEST(Misconfigurations, TheFirstThatFailedGivesTheExitCode) {
  EXPECT_EQ(exit_code_of({{.name = "a", .warning = true},
                          {.name = "b", .code = ExitCode::storage},
                          {.name = "c", .code = ExitCode::no_permission}}),
            ExitCode::storage);
}

TEST(Misconfigurations, AServoWithoutAWatchdogIsNoneAndHowItRestsIsSaid) {
  rig::PreflightReport report;
  report.facts.answers = {.requests = 100,
                          .answered = 99,
                          .round_trip_s = 0.004,
                          .firmware = "3.10",
                          .limit_rate_dps = 270.0,
                          .how_it_rests = "it rests where its leg ends"};
  const std::vector<Check> checks = judge_rig(report);
  ASSERT_EQ(checks.size(), 2U);
  EXPECT_EQ(checks[0].result, "firmware 3.10, at most 270 deg/s, no watchdog: it rests where its leg ends");
  EXPECT_EQ(checks[1].result, "99 of 100 requests, 4.0 ms there and back");
  report.facts.answers->firmware.clear();  // it has not greeted
  EXPECT_EQ(judge_rig(report).size(), 1U);
}

}  // namespace
}  // namespace thermorig::doctor::test
