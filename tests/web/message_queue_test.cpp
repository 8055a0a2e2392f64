// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "io/web/message_queue.h"
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

using ::testing::IsEmpty;

namespace {

constexpr std::size_t plenty = 1'000'000;

std::vector<std::string> texts(const Backlog& backlog, std::size_t bytes_max = plenty) {
  std::vector<std::string> found;
  for (const Message& kept : backlog.for_new_client(bytes_max)) found.push_back(*kept.text);
  return found;
}

}  // namespace

TEST(Backlog, HasNothingBeforeTheFirstMessage) {
  EXPECT_THAT(texts(Backlog()), IsEmpty());
}

TEST(Backlog, TellsAPageThatOpensTheRunSoFarInOrder) {
  Backlog backlog;
  backlog.keep(message(Topic::ended, "ended"));
  for (int number : {1, 2}) {
    backlog.keep(message(Topic::image, fmt::format("image {}", number)));
    backlog.keep(message(Topic::surroundings, fmt::format("surroundings {}", number)));
    backlog.keep(message(Topic::state, fmt::format("state {}", number)));
    backlog.keep(message(Topic::frame, fmt::format("frame {}", number)));
    backlog.keep(message(Topic::event, fmt::format("event {}", number)));
    backlog.keep(message(Topic::hello, fmt::format("hello {}", number)));
  }
  EXPECT_THAT(texts(backlog), ElementsAre("hello 2", "event 1", "event 2", "frame 1", "frame 2", "state 2",
                                          "image 2", "surroundings 2", "ended"));
}

TEST(Backlog, KeepsTheLastFramesAndEvents) {
  Backlog backlog;
  for (int number = 0; number < 1'000; ++number) {
    backlog.keep(message(Topic::frame, fmt::format("f{}", number)));
    backlog.keep(message(Topic::event, fmt::format("e{}", number)));
  }
  const auto found = texts(backlog);
  ASSERT_EQ(found.size(), kept_frames + kept_events);
  EXPECT_EQ(found.front(), "e950");
  EXPECT_EQ(found[kept_events], "f488");
  EXPECT_EQ(found.back(), "f999");
}

TEST(Backlog, GivesTheNewestFramesThatFit) {
  Backlog backlog;
  for (int number = 0; number < 10; ++number) backlog.keep(message(Topic::frame, fmt::format("f{}", number)));
  const std::size_t two = 2 * bytes_of(message(Topic::frame, "f0"));
  EXPECT_THAT(texts(backlog, two), ElementsAre("f8", "f9"));
  EXPECT_THAT(texts(backlog, 0), IsEmpty());
}

TEST(Backlog, TakesNoNoteOfAGap) {
  Backlog backlog;
  backlog.keep({Topic::frame, nullptr, {3, 0}});
  EXPECT_THAT(texts(backlog), IsEmpty());
}

}  // namespace thermorig::web
