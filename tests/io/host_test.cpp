// SPDX-License-Identifier: MIT
#include "thermorig/io/host.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <ctime>

#include "io/port_list.h"
#include "thermorig/io/port.h"

namespace thermorig::io {
namespace {

TEST(UtcText, ShowsMicrosecondsOfTheRealTime) {
  // date -u -d '2026-07-25T14:35:12' +%s
  const std::int64_t realtime_ns = 1'784'990'112'123'456'789;
  EXPECT_EQ(utc_text(host_time_ns(1000), realtime_ns - 1000), "2026-07-25T14:35:12.123456Z");
  EXPECT_EQ(utc_text(host_time_ns(0), -1), "1969-12-31T23:59:59.999999Z");
}

TEST(Clock, OffsetLeadsFromTheSteadyClockToTheRealTime) {
  using std::chrono::nanoseconds;
  const auto real = std::chrono::system_clock::now().time_since_epoch();
  const nanoseconds ours(to_ns(now()) + realtime_offset_ns());
  EXPECT_LT(std::chrono::abs(ours - real), std::chrono::seconds(5));
}

TEST(Host, CountsTheProcessorTimeOfTheThread) {
  timespec used{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  const double before_s = static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
  while (thread_cpu_s() - before_s < 0.01) {
  }
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  EXPECT_GE(static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec), before_s + 0.01);
}

TEST(Host, HasAKernel) {
  EXPECT_EQ(kernel_release().substr(0, 6), "Linux ");
}

TEST(Host, HasMemory) {
  EXPECT_GT(memory_bytes(), 16U << 20U);
  EXPECT_LE(memory_bytes(), static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                                static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)));
}

TEST(DeviceText, HasNoBlanksAroundItAndNothingThatSteersATerminal) {
  EXPECT_EQ(device_text("  USB \x1b[31mSerial\x07 \r\n"), "USB \\u{1B}[31mSerial\\u{07}");
  EXPECT_EQ(device_text("Gerät"), "Gerät");
  EXPECT_EQ(device_text(" \t "), "");
}

TEST(UsbTopology, IsTheLastDeviceFolderOfTheSysfsPath) {
  const std::string root = "/sys/devices/pci0000:00/0000:00:14.0/usb1/";
  EXPECT_EQ(usb_topology(root + "1-4/1-4.2/1-4.2:1.0/ttyUSB0"), "1-4.2");
  EXPECT_EQ(usb_topology(root + "1-4/1-4:1.0"), "1-4");
  EXPECT_EQ(usb_topology(root + "1-10/1-10.3/1-10.3.1/1-10.3.1:1.1"), "1-10.3.1");
  EXPECT_EQ(usb_topology("/sys/devices/platform/serial8250"), "");
  EXPECT_EQ(usb_interface(root + "1-4/1-4.2/1-4.2:1.1/ttyUSB0"), "1.1");
  EXPECT_EQ(usb_interface(root + "1-4/1-4:1.2"), "1.2");
  EXPECT_EQ(usb_interface("/sys/devices/platform/serial8250"), "");
}

TEST(SystemConsole, IsWhatTheKernelNamesWhole) {
  EXPECT_TRUE(names_console("tty0 ttyS0", "/dev/ttyS0"));
  EXPECT_TRUE(names_console("ttyS0\n", "/dev/ttyS0"));
  EXPECT_FALSE(names_console("ttyS0", "/dev/ttyS01"));
  EXPECT_FALSE(names_console("ttyS01", "/dev/ttyS0"));
  EXPECT_FALSE(names_console("", "/dev/ttyS0"));
}

TEST(SystemConsole, IsNotListedAsAPort) {
  for (const PortInfo& port : list_ports()) EXPECT_FALSE(is_system_console(port.path)) << port.path;
}

}  // namespace
}  // namespace thermorig::io
