// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>

#include "asio.h"
#include "open_port.h"
#include "thermorig/io/port.h"

namespace thermorig::io {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

constexpr std::size_t read_size = 4096;

void rethrow(std::exception_ptr error) {
  if (error) std::rethrow_exception(error);
}

bool is_not_yet(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

/// One open port: a reading coroutine and a queue of bytes to write. Held by whatever waits for it.
class PortTraffic : public std::enable_shared_from_this<PortTraffic> {
 public:
  PortTraffic(asio::io_context& context, const PortProfile& link, Loop::PortHandlers handlers)
      : port_(link), stream_(context, port_.fd()), handlers_(std::move(handlers)) {}
  ~PortTraffic() { close(); }

  void start() { asio::co_spawn(stream_.get_executor(), read_chunks(shared_from_this()), rethrow); }

  void write(std::span<const std::uint8_t> bytes) {
    if (closed_) return;
    queue_.insert(queue_.end(), bytes.begin(), bytes.end());
    if (!waiting_to_write_) write_queue();
  }

  void close() {
    if (closed_) return;
    closed_ = true;
    queue_.clear();
    stream_.release();  // cancels what waits for it; the descriptor itself belongs to port_
    port_.close();
  }

 private:
  /// Waits, reads and takes the time in one go, so that no other handler runs between read() and the clock.
  static asio::awaitable<void> read_chunks(std::shared_ptr<PortTraffic> self) {
    std::array<std::uint8_t, read_size> buffer;
    while (!self->closed_) {
      error_code error;
      co_await self->stream_.async_wait(asio::posix::stream_descriptor::wait_read,
                                        asio::redirect_error(asio::use_awaitable, error));
      if (self->closed_) co_return;
      const ssize_t size = ::read(self->port_.fd(), buffer.data(), buffer.size());
      const int reason = errno;
      const HostTime arrived = now();
      if (size > 0)
        self->handlers_.received(std::span(buffer.data(), static_cast<std::size_t>(size)), arrived);
      else if (size == 0)
        self->lose("unplugged");  // a terminal that has hung up reads as ended
      else if (!is_not_yet(reason))
        self->lose(std::strerror(reason));
    }
  }

  void write_queue() {
    while (!queue_.empty()) {
      const ssize_t written = ::write(port_.fd(), queue_.data(), queue_.size());
      if (written < 0 && is_not_yet(errno)) return wait_to_write();
      if (written < 0) return queue_.clear();  // the port is gone: the reader finds out as well and says so
      queue_.erase(queue_.begin(), queue_.begin() + written);
    }
  }

  void wait_to_write() {
    waiting_to_write_ = true;
    stream_.async_wait(asio::posix::stream_descriptor::wait_write, [self = shared_from_this()](error_code) {
      self->waiting_to_write_ = false;
      if (!self->closed_) self->write_queue();
    });
  }

  void lose(const std::string& why) {
    close();
    if (handlers_.lost) handlers_.lost(why);
  }

  OpenPort port_;
  asio::posix::stream_descriptor stream_;
  Loop::PortHandlers handlers_;
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
  HostDuration period{};
  std::function<void(HostTime)> tick;
  asio::signal_set signals{context};
  std::function<void(int)> signalled;

  void wait_for_tick() {
    timer.async_wait([this](error_code error) {
      const auto late = std::chrono::steady_clock::now() - timer.expiry();
      const bool replaced = late < late.zero();  // every() was called while this one waited its turn
      if (error || replaced || !tick) return;
      timer.expires_at(timer.expiry() + (late / period + 1) * period);
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
  for (const auto& port : impl_->ports) port->close();
  impl_->tick = nullptr;
  impl_->signalled = nullptr;
  impl_->timer.cancel();
  impl_->signals.cancel();
  // Whatever waits is called back, finds itself closed and ends; no handler of the caller's runs.
  impl_->context.restart();
  impl_->context.poll();
}

Loop::PortId Loop::open(const PortProfile& link, PortHandlers handlers) {
  assert(handlers.received);
  impl_->ports.push_back(std::make_shared<PortTraffic>(impl_->context, link, std::move(handlers)));
  impl_->ports.back()->start();
  return impl_->ports.size() - 1;
}

void Loop::write(PortId port, std::span<const std::uint8_t> bytes) {
  impl_->ports.at(port)->write(bytes);
}

void Loop::close(PortId port) {
  impl_->ports.at(port)->close();
}

void Loop::every(HostDuration period, std::function<void(HostTime)> tick) {
  assert(period > HostDuration::zero());
  impl_->period = period;
  impl_->tick = std::move(tick);
  impl_->timer.expires_after(period);
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
