// SPDX-License-Identifier: MIT
#include "open_port.h"

#include <fmt/format.h>
#include <libserialport.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "exclusive.h"
#include "thermorig/core/error.h"
#include "thermorig/io/port.h"

namespace thermorig::io {

namespace {

constexpr int ftdi_vendor = 0x0403;
constexpr std::uint32_t most_baud = 20'000'000;
constexpr double baud_tolerance = 0.025;  // beyond it 8N1 does not survive
constexpr std::chrono::milliseconds reset_pulse{50};

std::string last_error_text() {
  char* text = sp_last_error_message();
  std::string copy = text == nullptr ? "unknown error" : text;
  sp_free_error_message(text);
  return copy;
}

void require(sp_return result, const std::string& path, const std::string& what) {
  if (result == SP_OK) return;
  const std::string reason = result == SP_ERR_ARG ? "not supported" : last_error_text();
  throw Error(ExitCode::device_missing, fmt::format("{}: {}", what, reason), path,
              "unplug the device and plug it in again, and check its baud in the profile");
}

/// What the driver has made of the baud rate that it was asked for; none if it does not tell.
std::optional<int> baud_set(sp_port* port) {
  sp_port_config* config = nullptr;
  if (sp_new_config(&config) != SP_OK) return std::nullopt;
  int baud = 0;
  const bool told = sp_get_config(port, config) == SP_OK && sp_get_config_baudrate(config, &baud) == SP_OK;
  sp_free_config(config);
  return told && baud > 0 ? std::optional(baud) : std::nullopt;
}

/// A driver that cannot set a rate takes another one (ftdi_sio: 9600) and says nothing.
void require_baud(sp_port* port, std::uint32_t baud, const std::string& path) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ExitCode::device_missing, what, path, "check the device's baud in the profile");
  };
  if (baud > most_baud) refuse(fmt::format("{} baud cannot be set: no serial port is so fast", baud));
  require(sp_set_baudrate(port, static_cast<int>(baud)), path, fmt::format("{} baud cannot be set", baud));
  const std::optional<int> set = baud_set(port);
  if (set && std::abs(*set - static_cast<double>(baud)) > baud_tolerance * baud)
    refuse(fmt::format("{} baud cannot be set: the port's driver sets {} instead", baud, *set));
}

/// Raw bytes, no line discipline's help; a read returns as soon as there is one byte.
void make_raw(int fd) {
  termios settings{};
  if (tcgetattr(fd, &settings) != 0) return;
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(HUPCL);  // DTR stays up at close: boards are not reset by it
  settings.c_cc[VMIN] = 1;                            // libserialport leaves 0, with which a read says "end"
  settings.c_cc[VTIME] = 0;
  tcsetattr(fd, TCSANOW, &settings);
}

/// An FTDI holds a partial packet back for 16 ms unless told otherwise. Best effort: drivers may refuse.
void ask_low_latency(int fd, const sp_port* port) {
  int vendor = 0;
  int product = 0;
  serial_struct settings{};
  if (sp_get_port_usb_vid_pid(port, &vendor, &product) != SP_OK || vendor != ftdi_vendor) return;
  if (ioctl(fd, TIOCGSERIAL, &settings) != 0) return;
  settings.flags |= ASYNC_LOW_LATENCY;
  ioctl(fd, TIOCSSERIAL, &settings);
}

void pulse_dtr(sp_port* port) {
  sp_set_dtr(port, SP_DTR_OFF);
  std::this_thread::sleep_for(reset_pulse);
  sp_set_dtr(port, SP_DTR_ON);
}

struct ClosePort {
  void operator()(sp_port* port) const {
    sp_close(port);
    sp_free_port(port);
  }
};
using SerialPort = std::unique_ptr<sp_port, ClosePort>;

/// libserialport knows the ports that have a driver in sysfs; none of a pty.
SerialPort serial_port_at(const std::string& path) {
  sp_port* port = nullptr;
  return SerialPort(sp_get_port_by_name(path.c_str(), &port) == SP_OK ? port : nullptr);
}

/// libserialport opens the port once more. The settings are the port's: they stay when that one is closed.
void configure_serial(sp_port* port, int fd, const PortProfile& link, const std::string& path) {
  require(sp_open(port, SP_MODE_READ_WRITE), path, "the port cannot be opened");
  if (link.baud != 0) require_baud(port, link.baud, path);
  require(sp_set_bits(port, 8), path, "8 data bits cannot be set");
  require(sp_set_parity(port, SP_PARITY_NONE), path, "no parity cannot be set");
  require(sp_set_stopbits(port, 1), path, "1 stop bit cannot be set");
  require(sp_set_flowcontrol(port, SP_FLOWCONTROL_NONE), path, "no flow control cannot be set");
  make_raw(fd);
  // Not on ptys: there the mark outlives the last close and would lock out the next program.
  ioctl(fd, TIOCEXCL);
  ask_low_latency(fd, port);
  if (link.reset_on_open) pulse_dtr(port);
}

}  // namespace

files::Descriptor open_port(const PortProfile& link, Refusal refusal) {
  const std::string path = resolve_port(link.port);
  files::Descriptor port = open_exclusively(path, refusal);
  if (const SerialPort serial = serial_port_at(path))
    configure_serial(serial.get(), port.get(), link, path);
  else
    make_raw(port.get());
  tcflush(port.get(), TCIFLUSH);  // what piled up before is older than any session
  return port;
}

}  // namespace thermorig::io
