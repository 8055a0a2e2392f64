// SPDX-License-Identifier: MIT
#include "port_list.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <libserialport.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <regex>
#include <sstream>
#include <utility>

#include "i2c_port.h"
#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"
#include "thermorig/io/files/holder.h"
#include "thermorig/io/port.h"

namespace thermorig::io {

namespace {

struct FreePortList {
  void operator()(sp_port** ports) const { sp_free_port_list(ports); }
};

std::string text_or_empty(const char* text) {
  return text == nullptr ? std::string() : device_text(text);
}

std::string sysfs_path_of(const std::string& port) {
  std::error_code error;
  const auto name = std::filesystem::path(port).filename();
  const auto device =
      std::filesystem::canonical(std::filesystem::path("/sys/class/tty") / name / "device", error);
  return error ? std::string() : device.string();
}

std::string usb_id_of(const sp_port* port) {
  int vendor = 0;
  int product = 0;
  if (sp_get_port_usb_vid_pid(port, &vendor, &product) != SP_OK) return {};
  return fmt::format("{:04x}:{:04x}", vendor, product);
}

PortInfo describe(const sp_port* port) {
  PortInfo info;
  info.path = sp_get_port_name(port);
  info.description = text_or_empty(sp_get_port_description(port));
  if (sp_get_port_transport(port) != SP_TRANSPORT_USB) return info;
  const std::string sysfs_path = sysfs_path_of(info.path);
  info.usb_path = usb_topology(sysfs_path);
  info.usb_interface = usb_interface(sysfs_path);
  info.usb_id = usb_id_of(port);
  info.serial = text_or_empty(sp_get_port_usb_serial(port));
  return info;
}

}  // namespace

std::string device_text(std::string_view text) {
  constexpr const char* blanks = " \t\r\n";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return printable(text.substr(first, text.find_last_not_of(blanks) - first + 1));
}

std::string usb_topology(std::string_view sysfs_path) {
  static const std::regex device_folder("/([0-9]+-[0-9]+(\\.[0-9]+)*)(?=/|$)");
  std::string last;
  const std::string path(sysfs_path);
  for (auto match = std::sregex_iterator(path.begin(), path.end(), device_folder);
       match != std::sregex_iterator(); ++match)
    last = (*match)[1];
  return last;
}

std::string usb_interface(std::string_view sysfs_path) {
  static const std::regex interface_folder("/[0-9]+-[0-9]+(\\.[0-9]+)*:([0-9]+\\.[0-9]+)(?=/|$)");
  const std::string path(sysfs_path);
  std::smatch match;
  return std::regex_search(path, match, interface_folder) ? match[2].str() : std::string();
}

bool names_console(const std::string& active_consoles, const std::string& path) {
  std::istringstream names(active_consoles);
  return std::any_of(std::istream_iterator<std::string>(names), {},
                     [&](const std::string& name) { return path == "/dev/" + name; });
}

bool is_system_console(const std::string& path) {
  std::string active_consoles;
  std::ifstream active("/sys/class/tty/console/active");
  std::getline(active, active_consoles);
  return names_console(active_consoles, path);
}

std::vector<PortInfo> list_ports() {
  sp_port** listed = nullptr;
  if (sp_list_ports(&listed) != SP_OK)
    throw Error(ExitCode::failed, "the serial ports cannot be listed", "/sys/class/tty",
                "check that /sys is mounted");
  const std::unique_ptr<sp_port*, FreePortList> owner(listed);
  std::vector<PortInfo> ports;
  for (sp_port** port = listed; *port != nullptr; ++port)
    if (!is_system_console(sp_get_port_name(*port))) ports.push_back(describe(*port));
  for (PortInfo& bus : list_i2c_ports()) ports.push_back(std::move(bus));
  std::sort(ports.begin(), ports.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  return ports;
}

std::string existing_ports_text() {
  std::string text;
  for (const PortInfo& port : list_ports()) {
    text += text.empty() ? "the ports that exist are " : ", ";
    text += port.description.empty() ? port.path : fmt::format("{} ({})", port.path, port.description);
  }
  return text.empty() ? "no serial port is connected to this machine; check the USB cable" : text;
}

namespace {

[[noreturn]] void refuse_in_use(const std::string& path, const std::string& by_whom) {
  throw Error(ExitCode::no_permission, "port is in use" + by_whom, path,
              "stop that program, or choose another port");
}

[[noreturn]] void refuse_in_use(const std::string& path, Refusal refusal) {
  refuse_in_use(path, refusal == Refusal::brief ? "" : " by " + files::holder_of(path));
}

/// Who only reads (`cat`) takes no lock, and takes bytes: each one goes to one of two readers.
std::optional<std::string> other_reader(const std::string& path, Refusal refusal) {
  return refusal == Refusal::brief ? std::nullopt : files::other_holder_of(path);
}

[[noreturn]] void refuse_open(const std::string& path, int error, Refusal refusal) {
  if (error == EACCES || error == EPERM)
    throw Error(ExitCode::no_permission, "you are not allowed to open this port", path,
                "sudo usermod -aG dialout $USER, then log out and in again");
  if (error == EBUSY) refuse_in_use(path, refusal);
  throw Error(ExitCode::device_missing, fmt::format("the port cannot be opened: {}", std::strerror(error)),
              path, existing_ports_text());
}

}  // namespace

files::Descriptor open_exclusively(const std::string& path, Refusal refusal) {
  if (is_system_console(path))  // asked before open(), which already moves its control lines
    throw Error(ExitCode::no_permission, "this port is the system's console", path, existing_ports_text());
  const auto reader = other_reader(path, refusal);  // before open(): bytes that come meanwhile would be lost
  files::Descriptor port(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (!port) refuse_open(path, errno, refusal);
  if (isatty(port.get()) != 1)  // also a /dev/ttyS* without a chip behind it
    throw Error(ExitCode::device_missing, "this is not a serial port, or no device is behind it", path,
                existing_ports_text());
  port = lock_exclusively(std::move(port), path, refusal);
  if (reader) refuse_in_use(path, " by " + *reader);
  return port;
}

files::Descriptor lock_exclusively(files::Descriptor port, const std::string& path, Refusal refusal) {
  // TIOCEXCL does not stop root, so the lock is what two recorders see; pyserial's exclusive=True uses it
  // too.
  if (flock(port.get(), LOCK_EX | LOCK_NB) == 0) return port;
  port.close();  // else this process would be named, which holds it as well
  refuse_in_use(path, refusal);
}

}  // namespace thermorig::io
