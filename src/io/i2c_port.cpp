// SPDX-License-Identifier: MIT
#include "i2c_port.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <grp.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <thread>

#include "port_list.h"
#include "thermorig/core/error.h"
#include "thermorig/io/host.h"
#include "thermorig/io/i2c_camera.h"

namespace thermorig::io {

namespace {

namespace fs = std::filesystem;

constexpr unsigned i2c_major = 89;  // Documentation/admin-guide/devices.txt

/// /dev/i2c-N.
class DeviceBus final : public I2cBus {
 public:
  explicit DeviceBus(files::Descriptor bus) : bus_(std::move(bus)) {}

  int transfer(std::uint8_t device, std::span<const std::uint8_t> written,
               std::span<std::uint8_t> read) override {
    std::array<i2c_msg, 2> messages{};
    unsigned count = 0;
    if (!written.empty())
      messages[count++] = {.addr = device,
                           .flags = 0,
                           .len = static_cast<std::uint16_t>(written.size()),
                           .buf = const_cast<std::uint8_t*>(written.data())};
    if (!read.empty())
      messages[count++] = {.addr = device,
                           .flags = I2C_M_RD,
                           .len = static_cast<std::uint16_t>(read.size()),
                           .buf = read.data()};
    i2c_rdwr_ioctl_data all{.msgs = messages.data(), .nmsgs = count};
    const int done = ioctl(bus_.get(), I2C_RDWR, &all);
    if (done == static_cast<int>(count)) return 0;
    return done < 0 ? errno : EIO;
  }

  int fd() const { return bus_.get(); }

 private:
  files::Descriptor bus_;
};

std::string first_line_of(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

std::string group_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || status.st_gid == 0) return {};
  const group* entry = getgrgid(status.st_gid);
  return entry == nullptr ? std::string() : entry->gr_name;
}

[[noreturn]] void refuse_open(const std::string& path, int error) {
  if (error == ENOENT || error == ENODEV || error == ENXIO) refuse_missing_i2c_bus(path);
  if (error != EACCES && error != EPERM)
    throw Error(ExitCode::device_missing, fmt::format("the bus cannot be opened: {}", std::strerror(error)),
                path, "unplug a bridge and plug it in again");
  const std::string group = group_of(path);
  throw Error(ExitCode::no_permission, "you are not allowed to open this bus", path,
              group.empty()
                  ? "sudo apt install i2c-tools (it gives buses to the group i2c), then sudo usermod "
                    "-aG i2c $USER, then log out and in again"
                  : fmt::format("sudo usermod -aG {} $USER, then log out and in again", group));
}

files::Descriptor open_bus(const std::string& path, Refusal refusal) {
  files::Descriptor bus(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (!bus) refuse_open(path, errno);
  struct stat status {};
  if (fstat(bus.get(), &status) != 0 || !S_ISCHR(status.st_mode) || major(status.st_rdev) != i2c_major)
    throw Error(ExitCode::device_missing, "this is not an I2C bus", path, existing_ports_text());
  unsigned long functions = 0;
  if (ioctl(bus.get(), I2C_FUNCS, &functions) != 0 || (functions & I2C_FUNC_I2C) == 0)
    throw Error(ExitCode::device_missing, "this bus cannot read blocks of bytes (it knows SMBus alone)", path,
                "a bus on the pins of a Raspberry Pi, or a USB bridge such as an MCP2221A");
  return lock_exclusively(std::move(bus), path, refusal);
}

/// A camera on a bus, with the thread that a transfer may hold up.
class I2cReader final : public PortSource {
 public:
  I2cReader(files::Descriptor bus, const std::string& path, files::Descriptor end)
      : bus_(std::move(bus)),
        end_(std::move(end)),
        camera_(bus_, path, now, [this](std::span<const std::uint8_t> bytes) { send(bytes); }) {
    camera_.find();
    thread_ = std::thread([this] { run(); });
  }
  /// Waits for the transfer that is under way.
  ~I2cReader() override {
    ::shutdown(end_.get(), SHUT_RDWR);
    if (thread_.joinable()) thread_.join();
  }

  std::string why_ended() const override {
    const std::lock_guard lock(mutex_);
    return why_ended_.empty() ? "unplugged" : why_ended_;
  }

 private:
  void run() {
    take_no_signals();
    while (const std::optional<HostTime> next = camera_.turn())
      if (!listen_until(*next)) return;
    const std::lock_guard lock(mutex_);
    why_ended_ = camera_.why_gone();
    ::shutdown(end_.get(), SHUT_WR);  // its other half stays: who writes to it is not to be ended by SIGPIPE
  }

  /// False: the program has closed its end.
  bool listen_until(HostTime next) {
    const std::int64_t wait_ns = std::max<std::int64_t>((next - now()).count(), 0);
    const timespec wait{.tv_sec = wait_ns / 1'000'000'000, .tv_nsec = wait_ns % 1'000'000'000};
    pollfd end{.fd = end_.get(), .events = POLLIN, .revents = 0};
    if (ppoll(&end, 1, &wait, nullptr) <= 0) return true;
    std::array<std::uint8_t, 256> heard{};
    const ssize_t size = ::recv(end_.get(), heard.data(), heard.size(), MSG_DONTWAIT);
    if (size > 0) camera_.hear(std::span(heard).first(static_cast<std::size_t>(size)));
    return size > 0 || (size < 0 && (errno == EAGAIN || errno == EINTR));
  }

  /// Waits where the program has not read for long; fails, and is not heard of, once it has gone.
  void send(std::span<const std::uint8_t> bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(end_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) return;
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
  }

  DeviceBus bus_;
  files::Descriptor end_;
  I2cCamera camera_;
  mutable std::mutex mutex_;
  std::string why_ended_;
  std::thread thread_;
};

fs::path sysfs_of(const std::string& path) {
  return fs::path("/sys/class/i2c-dev") / fs::path(path).filename();
}

PortInfo described(const std::string& path, const fs::path& adapter) {
  PortInfo info{.path = path};
  info.description = device_text(first_line_of(sysfs_of(path) / "name"));
  info.usb_path = usb_topology(adapter.string());
  info.usb_interface = usb_interface(adapter.string());
  for (fs::path folder = adapter; folder.has_relative_path(); folder = folder.parent_path()) {
    std::error_code none;
    if (!fs::exists(folder / "idVendor", none)) continue;
    info.usb_id = first_line_of(folder / "idVendor") + ":" + first_line_of(folder / "idProduct");
    info.serial = device_text(first_line_of(folder / "serial"));
    break;
  }
  return info;
}

/// A screen's cable and a mainboard's chips hang on such buses as well: nothing is sent to those. The screens
/// of a Raspberry Pi are named by their addresses ("fef04500.i2c").
bool may_be_asked(const fs::path& adapter, const std::string& name) {
  if (!usb_topology(adapter.string()).empty()) return true;
  // HID bridges hang on their USB device by way of its HID device.
  std::error_code none;
  if (adapter.string().find("/0003:") != std::string::npos) return true;
  return fs::exists(adapter / "of_node", none) && !name.ends_with(".i2c");
}

/// A read alone, of what the device has ready, changes nothing in any of them.
bool has_camera(const std::string& path) {
  files::Descriptor bus(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (!bus) return errno == EACCES || errno == EPERM;  // to be named with the reason
  if (flock(bus.get(), LOCK_EX | LOCK_NB) != 0) return true;
  DeviceBus device(std::move(bus));
  std::array<std::uint8_t, 2> word{};
  for (const std::uint8_t address : {std::uint8_t{0x33}, std::uint8_t{0x66}})
    if (device.transfer(address, {}, word) == 0) return true;
  return false;
}

}  // namespace

void refuse_missing_i2c_bus(const std::string& path) {
  throw Error(
      ExitCode::device_missing, "there is no such I2C bus", path,
      "Raspberry Pi: sudo raspi-config nonint do_i2c 0; a USB bridge: plug it in, sudo modprobe i2c-dev; "
      "ls /dev/i2c-* shows which there are");
}

I2cPort open_i2c_port(const std::string& path, Refusal refusal) {
  files::Descriptor bus = open_bus(path, refusal);
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw Error(ExitCode::failed, std::strerror(errno), path, "close files and programs that are not needed");
  files::Descriptor mine(ends[0]), theirs(ends[1]);
  fcntl(mine.get(), F_SETFL, O_NONBLOCK);
  auto reader = std::make_unique<I2cReader>(std::move(bus), path, std::move(theirs));
  return {.end = std::move(mine), .source = std::move(reader)};
}

std::vector<PortInfo> list_i2c_ports() {
  std::vector<PortInfo> ports;
  std::error_code none;
  for (fs::directory_iterator bus("/sys/class/i2c-dev", none), end; !none && bus != end;
       bus.increment(none)) {
    const std::string path = "/dev/" + bus->path().filename().string();
    const fs::path adapter = fs::canonical(bus->path() / "device", none);
    if (none || !may_be_asked(adapter, first_line_of(bus->path() / "name")) || !has_camera(path)) continue;
    ports.push_back(described(path, adapter));
  }
  return ports;
}

}  // namespace thermorig::io
