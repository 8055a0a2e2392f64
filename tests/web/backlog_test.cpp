// SPDX-License-Identifier: MIT
#include "io/web/backlog.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "text_message.h"

namespace thermorig::web {

using ::testing::ElementsAre;
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
