// SPDX-License-Identifier: MIT
#include "thermorig/io/find_again.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "support/hand_clock.h"
#include "thermorig/io/files/holder.h"

namespace thermorig::io {
namespace {

PortInfo usb(const std::string& path, const std::string& socket, const std::string& id) {
  return {.path = path, .description = "", .usb_path = socket, .usb_id = id, .serial = ""};
}

const KnownPort known_camera{"/dev/ttyUSB0", usb("/dev/ttyUSB0", "1-4.1", "1a86:7523")};
const KnownPort known_gyro{"/dev/ttyUSB1", usb("/dev/ttyUSB1", "1-4.2", "1a86:7523")};

TEST(FindAgain, TakesTheSameSocketUnderWhateverName) {
  const std::vector<PortInfo> listed{usb("/dev/ttyUSB0", "1-4.2", "1a86:7523"),
                                     usb("/dev/ttyUSB7", "1-4.1", "1a86:7523")};
  EXPECT_EQ(choose_again(known_camera, listed, "/dev/ttyUSB0", {known_gyro}), "/dev/ttyUSB7");
}

TEST(FindAgain, TakesTheNameThatWasGivenInAnotherSocket) {
  const std::vector<PortInfo> listed{usb("/dev/ttyUSB3", "2-1", "1a86:7523")};
  EXPECT_EQ(choose_again(known_camera, listed, "/dev/ttyUSB3", {known_gyro}), "/dev/ttyUSB3");
}

TEST(FindAgain, DoesNotTakeAnotherKindOfDevice) {
  EXPECT_FALSE(
      choose_again(known_camera, {usb("/dev/ttyUSB0", "1-4.1", "0403:6001")}, "/dev/ttyUSB0", {known_gyro}));
}

TEST(FindAgain, DoesNotTakeTheSocketOfAnotherDeviceOfTheRig) {
  EXPECT_FALSE(
      choose_again(known_camera, {usb("/dev/ttyUSB0", "1-4.2", "1a86:7523")}, "/dev/ttyUSB0", {known_gyro}));
}

PortInfo on_adapter(const std::string& path, const std::string& interface) {
  PortInfo info = usb(path, "1-4", "0403:6010");
  info.usb_interface = interface;
  return info;
}

TEST(FindAgain, DoesNotExchangeTheTwoPortsOfOneAdapter) {
  const KnownPort first{"/dev/ttyUSB0", on_adapter("/dev/ttyUSB0", "1.0")};
  const KnownPort second{"/dev/ttyUSB1", on_adapter("/dev/ttyUSB1", "1.1")};
  const std::vector<PortInfo> exchanged{on_adapter("/dev/ttyUSB0", "1.1"), on_adapter("/dev/ttyUSB1", "1.0")};
  EXPECT_EQ(choose_again(first, exchanged, "/dev/ttyUSB0", {second}), "/dev/ttyUSB1");
  EXPECT_EQ(choose_again(second, exchanged, "/dev/ttyUSB1", {first}), "/dev/ttyUSB0");
  EXPECT_FALSE(choose_again(first, {exchanged[0]}, "/dev/ttyUSB0", {second}));
}

TEST(FindAgain, DoesNotTakeWhatAnotherDeviceOfTheRigHasOpen) {
  KnownPort holder = known_gyro;
  holder.open_path = "/dev/ttyUSB5";
  EXPECT_FALSE(
      choose_again(known_camera, {usb("/dev/ttyUSB5", "2-1", "1a86:7523")}, "/dev/ttyUSB5", {holder}));
  EXPECT_FALSE(choose_again(known_camera, {}, "/dev/ttyUSB5", {holder}));
}

TEST(FindAgain, OfWhatIsNotListedTakesTheName) {
  const KnownPort link{"/tmp/port",
                       {.path = "/dev/pts/3", .description = "", .usb_path = "", .usb_id = "", .serial = ""}};
  EXPECT_EQ(choose_again(link, {}, "/dev/pts/9", {known_gyro}), "/dev/pts/9");
  EXPECT_FALSE(choose_again(link, {}, std::nullopt, {known_gyro}));
}

// As of a simulated rig that was started again, and of a shell that got its number.
TEST(FindAgain, TakesTheNumberOfAPseudoTerminalUnlessAnotherProgramHasItOpen) {
  const Pty pty;
  const KnownPort port = know_port(pty.path());
  EXPECT_EQ(find_again(port, {known_gyro}), pty.path());
  const pid_t shell = fork();
  if (shell == 0) {
    if (open(pty.path().c_str(), O_RDWR | O_NOCTTY) >= 0) pause();
    _exit(1);
  }
  EXPECT_TRUE(tests::comes_true([&] { return files::other_holder_of(pty.path()).has_value(); }));
  EXPECT_FALSE(find_again(port, {known_gyro}));
  kill(shell, SIGKILL);
  waitpid(shell, nullptr, 0);
}

TEST(FindAgain, FollowsALinkToAnotherDeviceFile) {
  const auto link = std::filesystem::temp_directory_path() / ("thermorig-link-" + std::to_string(getpid()));
  std::filesystem::create_symlink("/dev/null", link);
  const KnownPort port = know_port(link);
  EXPECT_EQ(port.info.path, "/dev/null");
  std::filesystem::remove(link);
  EXPECT_FALSE(find_again(port, {}));
  std::filesystem::create_symlink("/dev/zero", link);
  EXPECT_EQ(find_again(port, {}), "/dev/zero");
  std::filesystem::remove(link);
}

}  // namespace
}  // namespace thermorig::io
