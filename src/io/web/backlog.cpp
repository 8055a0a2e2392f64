// SPDX-License-Identifier: MIT
#include "backlog.h"

namespace thermorig::web {

namespace {

void keep_last(std::deque<Message>& kept, const Message& message, std::size_t count) {
  kept.push_back(message);
  if (kept.size() > count) kept.pop_front();
}

/// The index from which on the messages fit, and takes their bytes off.
std::size_t first_that_fits(const std::deque<Message>& kept, std::size_t& bytes_left) {
  std::size_t first = kept.size();
  while (first > 0 && bytes_of(kept[first - 1]) <= bytes_left) bytes_left -= bytes_of(kept[--first]);
  return first;
}

}  // namespace

void Backlog::keep(const Message& message) {
  if (!message.text) return;
  switch (message.topic) {
    case Topic::hello:
      hello_ = message;
      return;
    case Topic::state:
      state_ = message;
      return;
    case Topic::frame:
      return keep_last(frames_, message, kept_frames);
    case Topic::image:
      image_ = message;
      return;
    case Topic::surroundings:
      surroundings_ = message;
      return;
    case Topic::event:
      return keep_last(events_, message, kept_events);
    case Topic::ended:
      ended_ = message;
      return;
  }
}

std::vector<Message> Backlog::for_new_client(std::size_t bytes_max) const {
  std::size_t bytes_left = bytes_max;
  const std::size_t event = first_that_fits(events_, bytes_left);
  const std::size_t frame = first_that_fits(frames_, bytes_left);
  std::vector<Message> messages;
  const auto add = [&](const Message& message) {
    if (message.text) messages.push_back(message);
  };
  add(hello_);
  messages.insert(messages.end(), events_.begin() + static_cast<std::ptrdiff_t>(event), events_.end());
  messages.insert(messages.end(), frames_.begin() + static_cast<std::ptrdiff_t>(frame), frames_.end());
  for (const Message* newest : {&state_, &image_, &surroundings_, &ended_}) add(*newest);
  return messages;
}

}  // namespace thermorig::web
