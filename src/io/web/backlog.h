// SPDX-License-Identifier: MIT
#pragma once

#include <deque>
#include <vector>

#include "message_queue.h"

namespace thermorig::web {

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
