// SPDX-License-Identifier: MIT
// Asio's fences are beyond ThreadSanitizer, which g++ warns about where they are inlined. The loop runs on
// one thread; what it shares with others it shares through locks and atomics.
#if defined(__SANITIZE_THREAD__)
#pragma GCC diagnostic ignored "-Wtsan"
#endif
#include <fmt/format.h>
#include <libserialport.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "i2c_port.h"
#include "port_list.h"
#include "read_watch.h"
#include "thermorig/core/error.h"
#include "thermorig/core/profile.h"
#include "thermorig/io/emergency_bytes.h"
#include "thermorig/io/files/descriptor.h"
#include "thermorig/io/port.h"
#include "tick_schedule.h"

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

/// A port, opened exclusively and set up: raw, 8N1, one byte wakes a reader; what came before is thrown away.
/// Real ports are configured by libserialport; a pty (which libserialport cannot open) and any other terminal
/// by termios alone. Throws what open_exclusively() throws; device_missing when the driver refuses the
/// settings.
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

}  // namespace

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

constexpr std::size_t read_size = 4096;
constexpr auto write_again = std::chrono::milliseconds(1);  // a few bytes, at the slowest of the ports

bool is_not_yet(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

/// One open port: what is read of it, and a queue of bytes to write. Nothing here asks the terminal whether
/// it is ready: that may take long, see read_watch.h. How it was opened is no matter here.
class PortTraffic : public std::enable_shared_from_this<PortTraffic> {
 public:
  PortTraffic(asio::io_context& context, files::Descriptor port, std::unique_ptr<PortSource> source,
              Loop::PortHandlers handlers)
      : port_(std::move(port)),
        source_(std::move(source)),
        context_(context),
        writing_(context),
        handlers_(std::move(handlers)) {}
  ~PortTraffic() { close(); }

  void start() {
    watch_.emplace(port_.get(), [this, weak = weak_from_this()] { read_soon(weak); });
  }

  void write(std::span<const std::uint8_t> bytes) {
    if (closed_) return;
    queue_.insert(queue_.end(), bytes.begin(), bytes.end());
    if (!waiting_to_write_) write_queue();
  }

  void keep_emergency_bytes(std::span<const std::uint8_t> bytes) {
    if (!closed_) io::keep_emergency_bytes(port_.get(), bytes);
  }

  void close() {
    if (closed_) return;
    closed_ = true;
    forget_emergency_bytes(port_.get());
    queue_.clear();
    writing_.cancel();
    watch_.reset();
    port_.close();
    source_.reset();
  }

 private:
  /// From any thread.
  void read_soon(std::weak_ptr<PortTraffic> weak) {
    asio::post(context_, [weak = std::move(weak)] {
      if (const auto self = weak.lock()) self->read_what_waits();
    });
  }

  /// One chunk at a time: other ports and the timer have their turn in between.
  void read_what_waits() {
    if (closed_) return;
    watch_->again();
    if (!has_something() || !read_chunk() || closed_) return;
    if (has_something()) read_soon(weak_from_this());
  }

  /// To read an empty terminal may take as long as to ask it. Of one that has hung up read() tells why.
  bool has_something() const {
    int waiting = 0;
    return ioctl(port_.get(), FIONREAD, &waiting) != 0 || waiting > 0 || watch_->has_hung_up();
  }

  /// Reads and takes the time in one go, so that no other handler runs between read() and the clock. True if
  /// there was something.
  bool read_chunk() {
    std::array<std::uint8_t, read_size> buffer;
    const ssize_t size = ::read(port_.get(), buffer.data(), buffer.size());
    const int reason = errno;
    const HostTime arrived = now();
    if (size > 0)
      handlers_.received(std::span(buffer.data(), static_cast<std::size_t>(size)), arrived);
    else if (size == 0)
      lose(source_ ? source_->why_ended() : "unplugged");  // a terminal that has hung up reads as ended
    else if (!is_not_yet(reason))
      lose(std::strerror(reason));
    return size > 0;
  }

  void write_queue() {
    while (!queue_.empty()) {
      const ssize_t written = ::write(port_.get(), queue_.data(), queue_.size());
      if (written < 0 && is_not_yet(errno)) return wait_to_write();
      if (written < 0) return queue_.clear();  // the port is gone: the reader finds out as well and says so
      queue_.erase(queue_.begin(), queue_.begin() + written);
    }
  }

  void wait_to_write() {
    waiting_to_write_ = true;
    writing_.expires_after(write_again);
    writing_.async_wait([self = shared_from_this()](error_code) {
      self->waiting_to_write_ = false;
      if (!self->closed_) self->write_queue();
    });
  }

  void lose(const std::string& why) {
    close();
    if (handlers_.lost) handlers_.lost(why);
  }

  files::Descriptor port_;
  std::unique_ptr<PortSource> source_;  // of a port that is no device file of its own
  asio::io_context& context_;
  asio::steady_timer writing_;
  Loop::PortHandlers handlers_;
  std::optional<ReadWatch> watch_;
  std::vector<std::uint8_t> queue_;  // not yet taken by the system
  bool waiting_to_write_ = false;
  bool closed_ = false;
};

}  // namespace

struct Loop::Impl {
  asio::io_context context{1};
  asio::executor_work_guard<asio::io_context::executor_type> stays_up = asio::make_work_guard(context);
  std::vector<std::shared_ptr<PortTraffic>> ports;

  PortId add(files::Descriptor port, std::unique_ptr<PortSource> source, PortHandlers handlers) {
    assert(port && handlers.received);
    ports.push_back(
        std::make_shared<PortTraffic>(context, std::move(port), std::move(source), std::move(handlers)));
    ports.back()->start();
    return ports.size() - 1;
  }
  asio::steady_timer timer{context};
  TickSchedule schedule;
  std::function<void(HostTime)> tick;
  asio::signal_set signals{context};
  std::function<void(int)> signalled;

  void wait_for_tick() {
    timer.expires_after(schedule.due() - now());
    timer.async_wait([this](error_code error) {
      // Not due: every() was called while this one waited its turn.
      if (error || !tick || !schedule.take(now())) return;
      wait_for_tick();
      const auto current = tick;  // the call may replace it
      current(now());
    });
  }

  void wait_for_signal() {
    signals.async_wait([this](error_code error, int signal) {
      if (error || !signalled) return;
      wait_for_signal();
      const auto current = signalled;
      current(signal);
    });
  }
};

Loop::Loop() : impl_(std::make_unique<Impl>()) {}

Loop::~Loop() {
  send_emergency_bytes();  // of ports that nobody closed: an exception is on its way
  for (const auto& port : impl_->ports) port->close();
  impl_->tick = nullptr;
  impl_->signalled = nullptr;
  impl_->timer.cancel();
  impl_->signals.cancel();
  // Whatever waits is called back, finds itself closed and ends; no handler of the caller's runs.
  impl_->context.restart();
  impl_->context.poll();
}

Loop::PortId Loop::open(const PortProfile& link, PortHandlers handlers, Refusal refusal) {
  if (!is_i2c_bus(link.port)) return attach(open_port(link, refusal), std::move(handlers));
  I2cPort port = open_i2c_port(resolve_port(link.port), refusal);
  return impl_->add(std::move(port.end), std::move(port.source), std::move(handlers));
}

Loop::PortId Loop::attach(files::Descriptor port, PortHandlers handlers) {
  return impl_->add(std::move(port), nullptr, std::move(handlers));
}

void Loop::write(PortId port, std::span<const std::uint8_t> bytes) {
  impl_->ports.at(port)->write(bytes);
}

void Loop::keep_emergency_bytes(PortId port, std::span<const std::uint8_t> bytes) {
  impl_->ports.at(port)->keep_emergency_bytes(bytes);
}

void Loop::close(PortId port) {
  impl_->ports.at(port)->close();
}

void Loop::every(HostDuration period, std::function<void(HostTime)> tick) {
  impl_->schedule = TickSchedule(period, now());
  impl_->tick = std::move(tick);
  impl_->wait_for_tick();
}

void Loop::on_signal(std::function<void(int signal)> handler) {
  const bool waits = impl_->signalled != nullptr;
  impl_->signalled = std::move(handler);
  if (waits) return;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) impl_->signals.add(signal);
  impl_->wait_for_signal();
}

void Loop::run() {
  impl_->context.run();
  impl_->context.restart();
}

void Loop::stop() {
  impl_->context.stop();
}

}  // namespace thermorig::io
