// SPDX-License-Identifier: MIT
#include "io/web/message_queue.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "text_message.h"

namespace thermorig::web {

using ::testing::ElementsAre;

namespace {

std::vector<std::string> texts(MessageQueue& queue) {
  std::vector<std::string> found;
  while (const auto next = queue.pop()) found.push_back(*text_of(*next));
  return found;
}

/// Room for this many messages of ten characters.
std::size_t room_for(std::size_t count) {
  return count * bytes_of(message(Topic::frame, "0123456789"));
}

Message frame(int number) {
  return message(Topic::frame, fmt::format("frame {:4}", number));
}

}  // namespace

TEST(MessageQueue, GivesMessagesInOrder) {
  MessageQueue queue(room_for(10));
  queue.push(message(Topic::hello, "hello"));
  queue.push(message(Topic::event, "event"));
  queue.push(message(Topic::frame, "frame"));
  EXPECT_THAT(texts(queue), ElementsAre("hello", "event", "frame"));
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.bytes(), 0U);
}

TEST(MessageQueue, ReplacesOnlyWhatIsSupersededAndInItsPlace) {
  MessageQueue queue(room_for(10));
  queue.push(message(Topic::state, "state 1"));
  queue.push(message(Topic::image, "image 1"));
  queue.push(message(Topic::frame, "frame 1"));
  queue.push(message(Topic::frame, "frame 2"));
  queue.push(message(Topic::image, "image 2, longer"));
  queue.push(message(Topic::state, "state 2"));
  EXPECT_THAT(texts(queue), ElementsAre("state 2", "image 2, longer", "frame 1", "frame 2"));
  EXPECT_EQ(queue.bytes(), 0U);
}

TEST(MessageQueue, DropsWhatDoesNotFitAndTellsSoWhereItWas) {
  MessageQueue queue(room_for(4));
  for (int number = 0; number < 7; ++number) queue.push(frame(number));
  queue.push(message(Topic::event, "an event.."));
  for (int number = 0; number < 3; ++number) EXPECT_EQ(*text_of(*queue.pop()), *frame(number).text);
  queue.push(frame(8));
  EXPECT_THAT(texts(queue),
              ElementsAre("frame    3", R"({"event":"dropped","frames":3,"events":1})", "frame    8"));
}

TEST(MessageQueue, MakesOneGapUntilHalfOfItsRoomIsFree) {
  MessageQueue queue(room_for(4));
  for (int number = 0; number < 5; ++number) queue.push(frame(number));
  for (int number = 5; number < 7; ++number) {
    queue.pop();
    queue.push(frame(number));
  }
  EXPECT_THAT(texts(queue), ElementsAre("frame    2", "frame    3", R"({"event":"dropped","frames":3})"));
}

TEST(MessageQueue, TellsAGapAtItsEndEvenIfNothingFollows) {
  MessageQueue queue(room_for(1));
  queue.push(frame(0));
  queue.push(frame(1));
  EXPECT_FALSE(queue.empty());
  EXPECT_THAT(texts(queue), ElementsAre("frame    0", R"({"event":"dropped","frames":1})"));
}

TEST(MessageQueue, TakesTheEndInAnyCase) {
  MessageQueue queue(room_for(1));
  for (int number = 0; number < 3; ++number) queue.push(frame(number));
  queue.push(message(Topic::ended, "ended"));
  EXPECT_THAT(texts(queue), ElementsAre("frame    0", R"({"event":"dropped","frames":2})", "ended"));
}

TEST(MessageQueue, TakesAMessageOfMostOfItsRoomOnceItIsEmpty) {
  MessageQueue queue(room_for(1));
  queue.push(frame(0));
  queue.push(frame(1));
  queue.pop();
  queue.push(frame(2));
  EXPECT_THAT(texts(queue), ElementsAre(R"({"event":"dropped","frames":1})", "frame    2"));
}

TEST(MessageQueue, NeverTakesAMessageThatIsLargerThanItsRoom) {
  MessageQueue queue(room_for(1));
  queue.push(message(Topic::frame, std::string(1'000, 'a')));
  EXPECT_THAT(texts(queue), ElementsAre(R"({"event":"dropped","frames":1})"));
}

TEST(MessageQueue, AddsUpAGapThatIsHandedOver) {
  MessageQueue first(room_for(1)), second(room_for(8));
  for (int number = 0; number < 4; ++number) first.push(frame(number));
  for (auto& handed : first.take_all()) second.push(std::move(handed));
  second.push(frame(9));
  EXPECT_TRUE(first.empty());
  EXPECT_THAT(texts(second), ElementsAre("frame    0", R"({"event":"dropped","frames":3})", "frame    9"));
}

TEST(MessageQueue, StaysBoundedWhateverComes) {
  MessageQueue queue(room_for(100));
  std::size_t most = 0;
  for (int number = 0; number < 10'000; ++number) {
    queue.push(frame(number));
    queue.push(message(Topic::event, ""));
    queue.push(message(Topic::state, "state"));
    queue.push(message(Topic::image, std::string(100, 'a')));
    most = std::max(most, queue.bytes());
  }
  EXPECT_LE(most, room_for(100) + bytes_of(message(Topic::image, std::string(100, 'a'))));
}

}  // namespace thermorig::web
