// SPDX-License-Identifier: MIT
#include "output_writer.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <cstdio>
#include <cstring>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "output.h"
#include "thermorig/io/host.h"

namespace thermorig::app {

namespace {

constexpr auto look_period = std::chrono::milliseconds(50);  // for Ctrl-C

/// All of `text`, or errno.
int written(int descriptor, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t count = ::write(descriptor, text.data() + at, text.size() - at);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) {  // somebody made it non-blocking: its reader is slow, not gone
      pollfd room{.fd = descriptor, .events = POLLOUT, .revents = 0};
      poll(&room, 1, -1);
      continue;
    }
    if (count < 0) return errno;
    at += static_cast<std::size_t>(count);
  }
  return 0;
}

/// Later texts must not wait for the reader that was given up.
void silence(int descriptor) {
  const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nothing < 0) return;
  dup2(nothing, descriptor);
  close(nothing);
}

}  // namespace

struct OutputWriter::Parts {
  explicit Parts(OutputOptions chosen) : options(std::move(chosen)) {}

  OutputOptions options;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::string> texts;  // the first one is being written
  std::size_t bytes = 0;          // of them
  std::uint64_t taken = 0;        // texts that were written
  DroppedTexts dropped;           // and not yet told
  bool skipping = false;          // frames were dropped, and half of their room is not free yet
  bool ending = false;
  bool given_up = false;  // the reader, at the end
  int error = 0;
  std::thread thread;

  bool hurried() const { return options.hurried && options.hurried(); }
  std::size_t frame_room() const { return options.bytes / 4; }

  void run() {
    io::take_no_signals();
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [this] { return ending || !texts.empty(); });
      if (texts.empty()) return;
      const std::string& text = texts.front();  // stays where it is while others are added
      lock.unlock();
      const int failure = written(options.descriptor, text);
      lock.lock();
      ++taken;
      bytes -= texts.front().size();
      texts.pop_front();
      if (failure != 0) give_up(failure);
      changed.notify_all();
    }
  }

  void give_up(int failure) {
    error = failure;
    texts.clear();
    bytes = 0;
  }

  void push(std::string text) {
    if (text.empty()) return;
    bytes += text.size();
    texts.push_back(std::move(text));
    changed.notify_all();
  }

  void tell_dropped() {
    if (dropped.all() == 0) return;
    const DroppedTexts gone = std::exchange(dropped, {});
    if (options.of_dropped) push(options.of_dropped(gone));
  }

  bool has_room(std::size_t size, Matter matter) const {
    if (matter == Matter::frame) return !skipping && bytes + size <= frame_room();
    return bytes + size <= (matter == Matter::state ? options.bytes / 2 : options.bytes);
  }

  void drop(Matter matter) {
    if (matter == Matter::frame) skipping = true;
    ++(matter == Matter::frame ? dropped.frames : matter == Matter::state ? dropped.states : dropped.words);
  }

  /// Of a text that may wait: until there is room, or nobody will make any.
  void wait_for_room(std::unique_lock<std::mutex>& lock) {
    while (bytes >= options.bytes && error == 0 && !hurried()) changed.wait_for(lock, look_period);
  }

  /// True if all was written, or cannot be; false if the reader was given up.
  bool wait_for_reader(std::unique_lock<std::mutex>& lock) {
    auto deadline = options.now() + options.patience;
    for (std::uint64_t seen = taken; !texts.empty();) {
      changed.wait_for(lock, look_period);
      const auto now = options.now();
      if (taken != seen || (options.waits && !hurried())) deadline = now + options.patience;
      if (now >= deadline) return false;
      seen = taken;
    }
    return true;
  }
};

OutputWriter::OutputWriter(const OutputOptions& options) : parts_(std::make_shared<Parts>(options)) {
  flush_output();  // what was printed before stands before
  parts_->thread = std::thread([parts = parts_] { parts->run(); });
}

OutputWriter::~OutputWriter() {
  finish();
}

bool OutputWriter::write(std::string text, Matter matter) {
  Parts& parts = *parts_;
  std::unique_lock lock(parts.mutex);
  if (parts.options.waits) {
    parts.wait_for_room(lock);
    if (parts.error == 0) parts.push(std::move(text));
    return true;
  }
  if (parts.error != 0) return true;
  if (parts.bytes <= parts.frame_room() / 2) {
    parts.skipping = false;
    parts.tell_dropped();
  }
  if (!parts.has_room(text.size(), matter)) {
    parts.drop(matter);
    return false;
  }
  parts.push(std::move(text));
  return true;
}

void OutputWriter::write_last(std::string text) {
  const std::lock_guard lock(parts_->mutex);
  if (parts_->error != 0) return;
  parts_->tell_dropped();
  parts_->push(std::move(text));
}

bool OutputWriter::failed() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->error != 0;
}

void OutputWriter::finish() {
  Parts& parts = *parts_;
  if (!parts.thread.joinable()) return;
  std::unique_lock lock(parts.mutex);
  if (parts.error == 0) parts.tell_dropped();
  parts.ending = true;
  parts.changed.notify_all();
  const bool complete = parts.wait_for_reader(lock);
  if (!complete) {
    parts.given_up = true;
    while (parts.texts.size() > 1) parts.texts.pop_back();  // the first one is being written
    silence(parts.options.descriptor);
  }
  lock.unlock();
  complete ? parts.thread.join() : parts.thread.detach();
}

std::optional<Error> OutputWriter::failure(ExitCode code) const {
  const std::lock_guard lock(parts_->mutex);
  if (parts_->given_up && code != ExitCode::interrupted)
    return Error(ExitCode::storage, "the reader of the output took nothing any more: its last lines are lost",
                 "standard output", "let the program go on that reads it");
  if (parts_->error == 0) return std::nullopt;
  return unwritten_output(parts_->error);
}

void OutputWriter::require_written(ExitCode code) const {
  if (const auto error = failure(code)) throw Error(*error);
}

}  // namespace thermorig::app
