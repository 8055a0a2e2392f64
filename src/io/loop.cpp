// SPDX-License-Identifier: MIT
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>

#include "asio.h"
#include "open_port.h"
#include "read_watch.h"
#include "thermorig/io/emergency_bytes.h"
#include "thermorig/io/port.h"
#include "tick_schedule.h"

namespace thermorig::io {

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
  PortTraffic(asio::io_context& context, files::Descriptor port, Loop::PortHandlers handlers)
      : port_(std::move(port)), context_(context), writing_(context), handlers_(std::move(handlers)) {}
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
      lose("unplugged");  // a terminal that has hung up reads as ended
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
  return attach(open_port(link, refusal), std::move(handlers));
}

Loop::PortId Loop::attach(files::Descriptor port, PortHandlers handlers) {
  assert(port && handlers.received);
  impl_->ports.push_back(std::make_shared<PortTraffic>(impl_->context, std::move(port), std::move(handlers)));
  impl_->ports.back()->start();
  return impl_->ports.size() - 1;
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
