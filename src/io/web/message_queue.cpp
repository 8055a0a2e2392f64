// SPDX-License-Identifier: MIT
#include "message_queue.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace thermorig::web {

namespace {

constexpr std::size_t message_overhead_bytes = 64;

bool only_newest(const Message& message) {
  return message.topic != Topic::frame && message.topic != Topic::event;
}

}  // namespace

std::size_t bytes_of(const Message& message) {
  return message_overhead_bytes + (message.text ? message.text->size() : 0);
}

std::shared_ptr<const std::string> text_of(const Message& message) {
  if (message.text) return message.text;
  const auto& [frames, events] = message.dropped;
  const std::string too = events > 0 ? fmt::format(",\"events\":{}", events) : "";
  return std::make_shared<const std::string>(
      fmt::format(R"({{"event":"dropped","frames":{}{}}})", frames, too));
}

void MessageQueue::push(Message message) {
  if (!message.text) {
    dropped_.frames += message.dropped.frames;
    dropped_.events += message.dropped.events;
  } else if (only_newest(message)) {
    replace_or_append(std::move(message));
  } else if (fits(bytes_of(message))) {
    end_gap();
    append(std::move(message));
  } else {
    drop(message);
  }
}

bool MessageQueue::fits(std::size_t bytes) {
  const std::size_t room = dropped_.any() ? bytes_max_ / 2 : bytes_max_;
  // A message of more than half of the room would otherwise never get in again, even into an empty queue.
  return bytes_ + bytes <= room || (messages_.empty() && bytes <= bytes_max_);
}

void MessageQueue::drop(const Message& message) {
  (message.topic == Topic::event ? dropped_.events : dropped_.frames) += 1;
}

void MessageQueue::end_gap() {
  if (dropped_.any()) append({Topic::frame, nullptr, std::exchange(dropped_, {})});
}

void MessageQueue::append(Message message) {
  bytes_ += bytes_of(message);
  messages_.push_back(std::move(message));
}

void MessageQueue::replace_or_append(Message message) {
  // In its place: a message that moved back each time would never reach the front.
  const auto same_topic = [&](const Message& other) { return other.text && other.topic == message.topic; };
  const auto older = std::find_if(messages_.begin(), messages_.end(), same_topic);
  if (older == messages_.end()) {
    if (message.topic == Topic::ended) end_gap();
    return append(std::move(message));
  }
  bytes_ = bytes_ - bytes_of(*older) + bytes_of(message);
  *older = std::move(message);
}

std::optional<Message> MessageQueue::pop() {
  if (messages_.empty()) end_gap();
  if (messages_.empty()) return std::nullopt;
  Message message = std::move(messages_.front());
  messages_.pop_front();
  bytes_ -= bytes_of(message);
  return message;
}

std::deque<Message> MessageQueue::take_all() {
  end_gap();
  bytes_ = 0;
  return std::exchange(messages_, {});
}

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
