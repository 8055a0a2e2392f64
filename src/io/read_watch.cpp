// SPDX-License-Identifier: MIT
#include "read_watch.h"

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/io/files/descriptor.h"
#include "thermorig/io/host.h"

namespace thermorig::io {

namespace {

void require(const files::Descriptor& descriptor) {
  if (!descriptor)
    throw Error(ExitCode::failed, std::strerror(errno), "epoll",
                "close files and programs that are not needed: the system has no room for more of them");
}

void add(int set, int fd, std::uint32_t events) {
  epoll_event event{.events = events, .data = {.fd = fd}};
  epoll_ctl(set, EPOLL_CTL_ADD, fd, &event);
}

}  // namespace

struct ReadWatch::Shared {
  explicit Shared(std::function<void()> call)
      : set(epoll_create1(EPOLL_CLOEXEC)),
        stop(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
        readable(std::move(call)) {
    require(set);
    require(stop);
    add(set.get(), stop.get(), EPOLLIN);
  }

  /// Asks the terminal for the first time; nobody closes it meanwhile. False: nobody listens any more.
  bool begin(int fd) {
    const std::lock_guard lock(mutex);
    if (!ended) add(set.get(), fd, EPOLLIN | EPOLLRDHUP | EPOLLET);
    return !ended;
  }

  /// False: nobody listens any more.
  bool tell(std::uint32_t event) {
    const std::lock_guard lock(mutex);
    if (ended) return false;
    if ((event & (EPOLLHUP | EPOLLRDHUP)) != 0) hung_up = true;
    if (!std::exchange(told, true)) readable();
    return true;
  }

  files::Descriptor set, stop;  // what is waited for; what ends the wait
  std::mutex mutex;             // of all below
  bool told = false;
  bool hung_up = false;
  bool ended = false;
  std::function<void()> readable;
};

ReadWatch::ReadWatch(int fd, std::function<void()> readable)
    : shared_(std::make_shared<Shared>(std::move(readable))) {
  std::thread([shared = shared_, fd] { run(*shared, fd); }).detach();
}

ReadWatch::~ReadWatch() {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->ended = true;
  }
  const std::uint64_t one = 1;
  while (::write(shared_->stop.get(), &one, sizeof one) < 0 && errno == EINTR) {
  }
}

void ReadWatch::again() {
  const std::lock_guard lock(shared_->mutex);
  shared_->told = false;
}

bool ReadWatch::has_hung_up() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->hung_up;
}

void ReadWatch::run(Shared& shared, int fd) {
  take_no_signals();
  if (!shared.begin(fd)) return;
  std::array<epoll_event, 2> events{};
  while (true) {
    const int count = epoll_wait(shared.set.get(), events.data(), static_cast<int>(events.size()), -1);
    for (int i = 0; i < count; ++i) {
      const epoll_event& event = events.at(static_cast<std::size_t>(i));
      if (event.data.fd == shared.stop.get() || !shared.tell(event.events)) return;
    }
  }
}

}  // namespace thermorig::io
