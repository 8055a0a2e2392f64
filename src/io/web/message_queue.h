// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/io/web/server.h"

namespace thermorig::web {

/// How many numbers of frames and events did not fit.
struct Dropped {
  std::size_t frames = 0, events = 0;
  bool any() const { return frames + events > 0; }
};

/// One JSON text, shared by all who send it; without a text it is a gap, where others were dropped.
struct Message {
  Topic topic = Topic::frame;
  std::shared_ptr<const std::string> text;
  Dropped dropped;
};

/// What it takes of a queue's room: more than its text, so that a queue of empty messages is bounded as well.
std::size_t bytes_of(const Message& message);

/// What is sent: a gap becomes docs/live_messages.md's `dropped`.
std::shared_ptr<const std::string> text_of(const Message& message);

/// Messages on their way to somebody who may be slow. Of hello, state, image and ended it holds one each, the
/// newest, in the place of the one before; frames and events are dropped when they do not fit, and a gap
/// tells so. Once something is dropped, everything is until half of the room is free: one gap rather than a
/// hundred.
class MessageQueue {
 public:
  /// `bytes_max`: of frames, events and all others together; the four newest are taken in any case.
  explicit MessageQueue(std::size_t bytes_max) : bytes_max_(bytes_max) {}

  void push(Message message);
  std::optional<Message> pop();
  /// Everything, in order; the queue is empty afterwards.
  std::deque<Message> take_all();

  bool empty() const { return messages_.empty() && !dropped_.any(); }
  std::size_t bytes() const { return bytes_; }

 private:
  void replace_or_append(Message message);
  bool fits(std::size_t bytes);
  void drop(const Message& message);
  void end_gap();
  void append(Message message);

  std::size_t bytes_max_;
  std::deque<Message> messages_;
  std::size_t bytes_ = 0;  // of the texts in it
  Dropped dropped_;        // since the last message in it
};

constexpr std::size_t kept_frames = 512;  // a minute at 8 frames/s; many more would not fit into a queue
constexpr std::size_t kept_events = 50;

/// What a page gets that is opened, or comes back, in the middle of a run.
class Backlog {
 public:
  void keep(const Message& message);

  /// hello, events, frames, the newest state, image and surroundings, ended: of the frames the newest that
  /// fit, so that all together has at most `bytes_max` (or nothing but the single ones).
  std::vector<Message> for_new_client(std::size_t bytes_max) const;

 private:
  std::deque<Message> frames_, events_;
  Message hello_, state_, image_, surroundings_, ended_;
};

}  // namespace thermorig::web
