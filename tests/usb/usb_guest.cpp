// SPDX-License-Identifier: MIT
// Runs inside the guest of tests/usb/run.sh, on the kernel's real drivers of usb-serial and of a bridge to
// I2C. Talks to the script over the console: a line "@ WORD" asks it to do something to the USB bus; it
// answers with a line on standard input.
#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>
#include <string>
#include <thread>

#include "made_mcp2221.h"
#include "thermorig/core/error.h"
#include "thermorig/io/find_again.h"
#include "thermorig/io/port.h"
#include "thermorig/sensors/camera_protocol.h"

namespace thermorig {
namespace {

using namespace std::chrono_literals;

int failures = 0;

void expect(bool holds, const std::string& what) {
  std::cout << (holds ? "ok   " : "FAIL ") << what << std::endl;
  failures += holds ? 0 : 1;
}

void ask(const std::string& word) {
  std::cout << "@ " << word << std::endl;
  std::string answer;
  std::getline(std::cin, answer);
}

std::vector<io::PortInfo> usb_ports() {
  std::vector<io::PortInfo> ports = io::list_ports();
  std::erase_if(ports,
                [](const io::PortInfo& info) { return info.usb_path.empty() || io::is_i2c_bus(info.path); });
  return ports;
}

template <typename Condition>
bool comes_true(Condition condition, HostDuration patience = 5s) {
  const HostTime end = io::now() + patience;
  while (!condition() && io::now() < end) std::this_thread::sleep_for(50ms);
  return condition();
}

/// One port on a loop of its own: what it hears, and whether it was lost.
class Ear {
 public:
  explicit Ear(const PortProfile& link) {
    io::Loop::PortHandlers handlers;
    handlers.received = [this](std::span<const std::uint8_t> bytes, HostTime) {
      heard_.append(bytes.begin(), bytes.end());
    };
    handlers.lost = [this](const std::string& why) { lost_ = why; };
    port_ = loop_.open(link, std::move(handlers));
  }

  /// Writes `text`, listens for at most `patience` until the echo has come or the port is lost.
  bool hears(const std::string& text, HostDuration patience = 3s) {
    heard_.clear();
    loop_.write(port_, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
    return listens_until([&] { return heard_.find(text) != std::string::npos; }, patience);
  }
  bool loses_it(HostDuration patience = 3s) {
    return listens_until([this] { return !lost_.empty(); }, patience);
  }
  const std::string& lost() const { return lost_; }
  const std::string& listens_for(HostDuration time) {
    listens_until([] { return false; }, time);
    return heard_;
  }

 private:
  template <typename Condition>
  bool listens_until(Condition condition, HostDuration patience) {
    const HostTime end = io::now() + patience;
    loop_.every(10ms, [&](HostTime now) {
      if (condition() || now >= end) loop_.stop();
    });
    loop_.run();
    return condition();
  }

  io::Loop loop_;
  io::Loop::PortId port_ = 0;
  std::string heard_;
  std::string lost_;
};

std::string error_of(const PortProfile& link) {
  try {
    Ear ear(link);
  } catch (const Error& error) {
    return error.what_happened();
  }
  return "";
}

/// What an ordinary user's open() says while the port is held.
int errno_of_another_user(const std::string& path) {
  chmod(path.c_str(), 0666);
  const pid_t child = fork();
  if (child == 0) {
    if (setuid(1000) != 0) _exit(1);
    _exit(open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK) >= 0 ? 0 : errno);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WEXITSTATUS(status);
}

void lists_and_opens(const std::vector<io::PortInfo>& ports) {
  expect(ports.size() == 2, "two USB ports are listed");
  for (const io::PortInfo& port : ports) {
    std::cout << "     " << port.path << " " << port.usb_path << " " << port.usb_id << " " << port.serial
              << std::endl;
    expect(port.usb_id == "0403:6001", "vendor and product of " + port.path);
  }
  for (const std::uint32_t baud : {9600U, 115200U, 250000U, 460800U, 921600U}) {
    Ear ear({.port = ports[0].path, .baud = baud});
    expect(ear.hears("echo at " + std::to_string(baud)), std::to_string(baud) + " baud: bytes go and come");
  }
  for (const std::uint32_t baud : {12'000'000U, 4'000'000'000U}) {
    const std::string refused = error_of({.port = ports[0].path, .baud = baud});
    expect(refused.find("baud cannot be set") != std::string::npos, "a refused baud is named: " + refused);
  }
}

void is_exclusive(const io::PortInfo& port) {
  Ear ear({.port = port.path, .baud = 115200});
  expect(errno_of_another_user(port.path) == EBUSY, "another user's program gets EBUSY (TIOCEXCL)");
  const std::string refused = error_of({.port = port.path, .baud = 115200});
  expect(refused.find("in use") != std::string::npos, "a second recorder: " + refused);
  expect(ear.hears("still mine"), "and the first one goes on");
}

/// Both plugs are pulled and put back in the other order: their names are exchanged.
void finds_them_again(const std::vector<io::PortInfo>& ports) {
  const io::KnownPort camera = io::know_port(ports[0].path);
  const io::KnownPort gyro = io::know_port(ports[1].path);
  {
    Ear ear({.port = ports[0].path, .baud = 460800});
    expect(ear.hears("before"), "the camera's port works before");
    const HostTime asked = io::now();
    ask("unplug camera");
    const bool noticed = ear.loses_it();
    expect(noticed, "the unplugging is noticed: " + ear.lost());
    std::cout << "     " << to_s(io::now() - asked) << " s after it was asked for" << std::endl;
  }
  ask("unplug gyro");
  expect(comes_true([] { return usb_ports().empty(); }), "no port is left");
  expect(!io::find_again(camera, {gyro}), "an absent port is not found");
  ask("plug gyro");
  expect(comes_true([] { return usb_ports().size() == 1; }), "the gyro's port is back");
  const auto of_gyro = io::find_again(gyro, {camera});
  expect(of_gyro == ports[0].path, "under the camera's name: " + of_gyro.value_or("not found"));
  expect(!io::find_again(camera, {gyro}), "which is not taken for the camera's");
  ask("plug camera");
  expect(comes_true([] { return usb_ports().size() == 2; }), "the camera's port is back");
  const auto of_camera = io::find_again(camera, {gyro});
  expect(of_camera == ports[1].path, "under the gyro's name: " + of_camera.value_or("not found"));
  if (!of_camera) return;
  Ear ear({.port = *of_camera, .baud = 460800});
  expect(ear.hears("after"), "and its bytes come again");
}

/// A program that keeps the dead node open: the kernel takes another number.
void finds_it_under_a_new_name(const io::PortInfo& port) {
  const io::KnownPort known = io::know_port(port.path);
  const int held = open(port.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  const std::string word = known.info.usb_path.ends_with("1") ? "camera" : "gyro";
  ask("unplug " + word);
  expect(comes_true([] { return usb_ports().size() == 1; }), "one port is gone");
  ask("plug " + word);
  expect(comes_true([&] { return io::find_again(known, {}).has_value(); }), "and found again");
  const std::string found = io::find_again(known, {}).value_or("");
  expect(!found.empty() && found != port.path, port.path + " is now " + found);
  close(held);
}

simulation::RawMlx90640::HalfFrame measured(unsigned subpage) {
  static float temp_c = 20.0F;
  std::array<float, frame_pixels> all_c{};
  all_c.fill(temp_c += 0.125F);
  return simulation::RawMlx90640(1).half_frame(all_c, subpage, {});
}

std::vector<io::PortInfo> buses() {
  std::vector<io::PortInfo> ports = io::list_ports();
  std::erase_if(ports, [](const io::PortInfo& info) { return !io::is_i2c_bus(info.path); });
  return ports;
}

std::string path_of_bus(const std::string& name) {
  for (int i = 0; i < 16; ++i) {
    std::ifstream file("/sys/class/i2c-dev/i2c-" + std::to_string(i) + "/name");
    std::string line;
    if (std::getline(file, line) && line.find(name) != std::string::npos)
      return "/dev/i2c-" + std::to_string(i);
  }
  return "";
}

void reads_a_camera(const std::string& path) {
  Ear ear({.port = path});
  ear.hears("MXR2\n", 1ms);  // a guest on a busy machine reads one in 0.1 to 0.3 s
  const std::string& heard = ear.listens_for(5s);
  CameraProfile profile;
  profile.protocol = "mlx-raw";
  sensors::CameraScanner scanner = sensors::camera_scanner(profile);
  std::vector<wire::CameraMessage> images;
  scanner.push(std::span(reinterpret_cast<const std::uint8_t*>(heard.data()), heard.size()), images);
  const wire::Counters& counters = scanner.counters();
  std::cout << "     " << images.size() << " images in 5 s, " << counters.bad_value << " torn" << std::endl;
  expect(images.size() >= 5, "2 half-frames a second are read from " + path);
  expect(counters.bad_value <= 3 && counters.bad_checksum == 0, "few are torn, and none damaged");
  const bool is_warm =
      !images.empty() && images.back().frame.temp_c[100] > 20.0F && images.back().frame.temp_c[100] < 60.0F;
  expect(is_warm, "and they are those that the sensor measured");
  const std::string refused = error_of({.port = path});
  expect(refused.find("in use") != std::string::npos, "a second recorder: " + refused);
}

void is_a_bus(MadeMcp2221& bridge) {
  expect(comes_true([] { return buses().size() == 1; }, 40s), "one bus with a camera is listed");
  if (buses().size() != 1) return;
  const io::PortInfo bus = buses()[0];
  std::cout << "     " << bus.path << " " << bus.description << std::endl;
  reads_a_camera(bus.path);
  bridge.move_sensor_to(0x29);
  const std::string absent = error_of({.port = bus.path});
  expect(absent.find("no thermal sensor answers") != std::string::npos, "without a sensor: " + absent);
  expect(buses().empty(), "and the bus is not listed any more");
  const std::string simple = error_of({.port = path_of_bus("SMBus stub")});
  expect(simple.find("cannot read blocks") != std::string::npos, "a bus that knows SMBus alone: " + simple);
  const std::string missing = error_of({.port = "/dev/i2c-15"});
  expect(missing.find("no such I2C bus") != std::string::npos, "one that is not there: " + missing);
  bridge.move_sensor_to(0x33);
  Ear ear({.port = bus.path});
  bridge.unplug();
  const bool noticed = ear.loses_it(20s);
  expect(noticed, "the unplugging is noticed: " + ear.lost());
}

int run() {
  // Its driver takes ten seconds to bind. It outlives all else: its thread waits in the kernel.
  MadeMcp2221& bridge = *new MadeMcp2221(measured);
  expect(bridge.is_made(), "a bridge to I2C is made up");
  expect(comes_true([] { return usb_ports().size() == 2; }, 20s), "the kernel's driver has bound");
  const std::vector<io::PortInfo> ports = usb_ports();
  if (ports.size() != 2) return failures;
  lists_and_opens(ports);
  is_exclusive(ports[0]);
  finds_them_again(ports);
  finds_it_under_a_new_name(usb_ports().at(0));
  is_a_bus(bridge);
  return failures;
}

}  // namespace
}  // namespace thermorig

int main() {
  int failures = 1;
  try {
    failures = thermorig::run();
  } catch (const std::exception& error) {
    std::cout << "FAIL " << error.what() << std::endl;
  }
  std::cout << "@ done " << failures << std::endl;
}
