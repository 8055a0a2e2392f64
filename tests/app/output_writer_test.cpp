// SPDX-License-Identifier: MIT
#include "print/output_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <future>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "pipe.h"
#include "support/hand_clock.h"
#include "thermorig/core/error.h"

namespace thermorig::app {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using tests::comes_true;
using tests::Pipe;

std::string frame_text(int number) {
  return json{{"event", "frame"}, {"index", number}, {"filling", std::string(300, 'x')}}.dump() + "\n";
}

std::vector<json> objects(const std::string& text) {
  std::vector<json> list;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    list.push_back(json::parse(line, nullptr, false));
    EXPECT_FALSE(list.back().is_discarded()) << line;
  }
  return list;
}

class Output : public ::testing::Test {
 protected:
  Output() { std::signal(SIGPIPE, SIG_IGN); }

  /// Its patience lasts for ever, as its clock stands.
  OutputOptions options_of(const Pipe& pipe) const {
    OutputOptions options;
    options.descriptor = pipe.writer();
    options.bytes = 32'000;
    options.patience = 200ms;
    options.now = [this] { return clock_.now(); };
    options.of_dropped = [](const DroppedTexts& dropped) {
      return json{{"event", "dropped"}, {"frames", dropped.frames}, {"states", dropped.states}}.dump() + "\n";
    };
    return options;
  }

  /// The clock goes on by so much whenever it is looked at.
  void let_time_pass(OutputOptions& options, std::chrono::milliseconds between_looks) {
    options.now = [this, between_looks] {
      clock_.advance(between_looks);
      return clock_.now();
    };
  }

  tests::HandClock clock_;
};

TEST_F(Output, DropsFramesForAReaderThatStopsAndTellsHowManyWhereTheyAreMissing) {
  const Pipe pipe;
  OutputWriter output(options_of(pipe));
  int sent = 0;
  const auto send = [&] { return output.write(frame_text(sent++), Matter::frame); };
  while (sent < 200) send();
  EXPECT_TRUE(output.write("{\"event\":\"event\"}\n", Matter::word))
      << "words have room where frames have none";
  auto reader = std::async(std::launch::async, [&] { return pipe.read_until("ended"); });
  EXPECT_TRUE(comes_true(send)) << "it takes frames again";
  for (int more = 0; more < 100; ++more) send();
  output.write_last("{\"event\":\"ended\"}\n");
  output.finish();
  int next = 0, gaps = 0, events = 0;
  const std::vector<json> came = objects(reader.get());
  for (const json& object : came) {
    if (object["event"] == "dropped") {
      next += object["frames"].get<int>();
      ++gaps;
    }
    if (object["event"] == "frame") {
      EXPECT_EQ(object["index"], next++) << "the gap is told where it is";
    }
    if (object["event"] == "event") ++events;
  }
  EXPECT_EQ(next, sent);
  EXPECT_GE(gaps, 1);
  EXPECT_EQ(events, 1);
  EXPECT_EQ(came.back()["event"], "ended");
}

/// A pipe that somebody else made non-blocking, as a terminal's or a pipe's other users may.
class NonBlockingOutput : public Output {
 protected:
  NonBlockingOutput() { fcntl(pipe_.writer(), F_SETFL, O_NONBLOCK); }
  Pipe pipe_;
};

TEST_F(NonBlockingOutput, TakesATextWholeThatIsLongerThanThePipe) {
  OutputWriter output(options_of(pipe_));
  const std::string text = json{{"event", "long"}, {"filling", std::string(20'000, 'x')}}.dump() + "\n";
  EXPECT_TRUE(output.write(text, Matter::word));
  auto reader = std::async(std::launch::async, [&] { return pipe_.read_until("\n"); });
  output.finish();
  EXPECT_EQ(reader.get(), text);
}

TEST_F(NonBlockingOutput, NoticesAReaderThatGoesAwayWhileItIsFull) {
  OutputWriter output(options_of(pipe_));
  for (int i = 0; i < 50; ++i) output.write(frame_text(i), Matter::frame);
  EXPECT_FALSE(output.failed());
  pipe_.close_reader();
  output.finish();
  ASSERT_TRUE(output.failure());
  EXPECT_EQ(output.failure()->code(), ExitCode::storage);
}

TEST_F(NonBlockingOutput, SaysThatAReaderWasGivenUp) {
  OutputOptions options = options_of(pipe_);
  let_time_pass(options, 50ms);
  OutputWriter output(options);
  for (int i = 0; i < 50; ++i) output.write(frame_text(i), Matter::frame);
  output.finish();
  ASSERT_TRUE(output.failure());
  EXPECT_EQ(output.failure()->code(), ExitCode::storage);
  EXPECT_THAT(output.failure()->what_happened(), ::testing::HasSubstr("took nothing any more"));
  EXPECT_THROW(output.require_written(), Error);
  EXPECT_FALSE(output.failure(ExitCode::interrupted)) << "Ctrl-C asked for an end at once";
}

TEST_F(Output, GivesUpAReaderThatTakesNothingAndLeavesWholeLines) {
  const Pipe pipe;
  OutputOptions options = options_of(pipe);
  let_time_pass(options, 50ms);
  OutputWriter output(options);
  // If one of these waited, it would be for ever.
  for (int i = 0; i < 1000; ++i) output.write(frame_text(i), Matter::frame);
  for (int i = 0; i < 1000; ++i) output.write("{\"event\":\"event\"}\n", Matter::word);
  output.write_last("{\"event\":\"ended\"}\n");
  ASSERT_TRUE(pipe.fills());
  const auto begin = clock_.now();
  output.finish();
  EXPECT_FALSE(output.failed());
  EXPECT_GE(clock_.now() - begin, options.patience);
  EXPECT_GE(objects(pipe.rest()).size(), 5U);
}

TEST_F(Output, WaitsAtTheEndForAReaderThatReadsSlowly) {
  constexpr int frames = 100;
  constexpr int more_than_the_pipe_holds = 14;  // once they are read, others were written
  const Pipe pipe;
  OutputOptions options = options_of(pipe);
  options.bytes = 512 * 1024;
  std::atomic<int> texts_read = 0, texts_seen = 0;
  options.now = [&, almost = options.patience - 1ms] {
    if (texts_read - texts_seen >= more_than_the_pipe_holds) {
      texts_seen = texts_read.load();
      clock_.advance(almost);
    }
    return clock_.now();
  };
  std::atomic<bool> finished = false;
  auto reader = std::async(std::launch::async, [&] {
    std::string text;
    while (text.find("ended") == std::string::npos) {
      text += pipe.read_until("\n");
      texts_read = static_cast<int>(std::count(text.begin(), text.end(), '\n'));
      const auto is_awaited = [&] { return finished || texts_read - texts_seen < more_than_the_pipe_holds; };
      if (!comes_true(is_awaited)) break;
    }
    return text;
  });
  OutputWriter output(options);
  const auto begin = clock_.now();
  for (int i = 0; i < frames; ++i) EXPECT_TRUE(output.write(frame_text(i), Matter::frame));
  output.write_last("{\"event\":\"ended\"}\n");
  output.finish();
  finished = true;
  EXPECT_EQ(objects(reader.get()).size(), frames + 1U);
  EXPECT_GT(clock_.now() - begin, 3 * options.patience);
}

TEST_F(Output, DropsNothingWhereTheReaderMayHoldTheProgramUp) {
  for (const int frames : {20, 500}) {  // fewer than there is room for: it waits at the end only
    const Pipe pipe;
    OutputOptions options = options_of(pipe);
    options.waits = true;
    let_time_pass(options, 2 * options.patience);
    std::atomic<int> waits = 0;
    options.hurried = [&] {
      ++waits;
      return false;
    };
    auto reader = std::async(std::launch::async, [&] {
      EXPECT_TRUE(comes_true([&] { return waits >= 5; }));
      return pipe.read_until("ended");
    });
    OutputWriter output(options);
    for (int i = 0; i < frames; ++i) output.write(frame_text(i), Matter::frame);
    output.write_last("{\"event\":\"ended\"}\n");
    output.finish();
    EXPECT_EQ(objects(reader.get()).size(), frames + 1U);
  }
}

TEST_F(Output, WaitsForNoReaderAfterCtrlC) {
  const Pipe pipe;
  OutputOptions options = options_of(pipe);
  options.waits = true;
  options.hurried = [] { return true; };
  let_time_pass(options, 50ms);
  OutputWriter output(options);
  for (int i = 0; i < 500; ++i) output.write(frame_text(i), Matter::frame);
  ASSERT_TRUE(pipe.fills());
  output.finish();
  EXPECT_GE(objects(pipe.rest()).size(), 5U);
}

TEST_F(Output, SaysThatItsReaderWentAway) {
  Pipe pipe;
  pipe.close_reader();
  OutputWriter output(options_of(pipe));
  output.write("gone\n", Matter::word);
  EXPECT_TRUE(comes_true([&] { return output.failed(); }));
  output.write("gone\n", Matter::word);
  output.finish();
  try {
    output.require_written();
    FAIL() << "it was not written";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_EQ(error.what_happened(), "") << "the reader of a pipe has enough: no line is due";
  }
}

}  // namespace
}  // namespace thermorig::app
