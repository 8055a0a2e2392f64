// SPDX-License-Identifier: MIT
#include "output_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <future>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "thermorig/core/error.h"

namespace thermorig::app {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

/// A pipe that holds one page, and its reader.
class Pipe {
 public:
  Pipe() {
    EXPECT_EQ(pipe2(ends_.data(), O_CLOEXEC), 0);
    EXPECT_GE(fcntl(ends_[1], F_SETPIPE_SZ, 4096), 4096);
  }
  ~Pipe() {
    close_reader();
    close(ends_[1]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int writer() const { return ends_[1]; }
  int reader() const { return ends_[0]; }
  void close_reader() {
    if (ends_[0] >= 0) close(std::exchange(ends_[0], -1));
  }

  /// All that comes until `marker` has come.
  std::string read_until(const std::string& marker) const {
    std::string text;
    std::array<char, 512> part{};
    while (text.find(marker) == std::string::npos) {
      const ssize_t count = read(ends_[0], part.data(), part.size());
      if (count <= 0) break;
      text.append(part.data(), static_cast<std::size_t>(count));
    }
    return text;
  }

  /// What is in it now.
  std::string rest() const {
    fcntl(ends_[0], F_SETFL, O_NONBLOCK);
    return read_until("no such text");
  }

 private:
  std::array<int, 2> ends_{};
};

std::string frame_text(int number) {
  return json{{"event", "frame"}, {"index", number}, {"filling", std::string(300, 'x')}}.dump() + "\n";
}

OutputOptions options_of(const Pipe& pipe) {
  OutputOptions options;
  options.descriptor = pipe.writer();
  options.bytes = 32'000;
  options.patience = 200ms;
  options.of_dropped = [](const DroppedTexts& dropped) {
    return json{{"event", "dropped"}, {"frames", dropped.frames}, {"states", dropped.states}}.dump() + "\n";
  };
  return options;
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
};

TEST_F(Output, DropsFramesForAReaderThatStopsAndTellsHowManyWhereTheyAreMissing) {
  const Pipe pipe;
  OutputWriter output(options_of(pipe));
  constexpr int sent = 400;
  for (int i = 0; i < 200; ++i) output.write(frame_text(i), Matter::frame);
  EXPECT_TRUE(output.write("{\"event\":\"event\"}\n", Matter::word))
      << "words have room where frames have none";
  auto reader = std::async(std::launch::async, [&] { return pipe.read_until("ended"); });
  for (int i = 200; i < sent; ++i) {
    output.write(frame_text(i), Matter::frame);
    std::this_thread::sleep_for(1ms);
  }
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

TEST_F(NonBlockingOutput, OfAReaderThatStallsAndGoesOnKeepsOrderAndCountsWhatIsDropped) {
  OutputWriter output(options_of(pipe_));
  int sent = 0, refused = 0;
  const auto send = [&] {
    const bool taken = output.write(frame_text(sent++), Matter::frame);
    if (!taken) ++refused;
    return taken;
  };
  while (sent < 200) send();  // nobody reads: if one of these waited, it would be for ever
  EXPECT_GT(refused, 0);
  EXPECT_FALSE(output.failed());
  auto reader = std::async(std::launch::async, [&] { return pipe_.read_until("ended"); });
  while (!send()) std::this_thread::sleep_for(1ms);
  for (int more = 0; more < 100; ++more) send();
  output.write_last("{\"event\":\"ended\"}\n");
  output.finish();
  EXPECT_FALSE(output.failure());
  int next = 0, told = 0;
  const std::vector<json> came = objects(reader.get());
  for (const json& object : came) {
    if (object["event"] == "dropped") {
      told += object["frames"].get<int>();
      next += object["frames"].get<int>();
    }
    if (object["event"] == "frame") {
      EXPECT_EQ(object["index"], next++);
    }
  }
  EXPECT_EQ(next, sent);
  EXPECT_EQ(told, refused);
  EXPECT_EQ(came.back()["event"], "ended");
}

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
  EXPECT_THAT(output.failure()->what_happened(), ::testing::HasSubstr("went away"));
}

TEST_F(NonBlockingOutput, SaysThatAReaderWasGivenUp) {
  OutputWriter output(options_of(pipe_));
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
  const auto begin = std::chrono::steady_clock::now();
  {
    OutputWriter output(options_of(pipe));
    for (int i = 0; i < 1000; ++i) output.write(frame_text(i), Matter::frame);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 5s) << "writing waits for nobody";
    for (int i = 0; i < 1000; ++i) output.write("{\"event\":\"event\"}\n", Matter::word);
    output.write_last("{\"event\":\"ended\"}\n");
    output.finish();
    EXPECT_FALSE(output.failed());
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 10s);
  EXPECT_GE(objects(pipe.rest()).size(), 5U);
}

TEST_F(Output, WaitsAtTheEndForAReaderThatReadsSlowly) {
  const Pipe pipe;
  auto reader = std::async(std::launch::async, [&] {
    std::string text;
    std::array<char, 512> part{};
    while (text.find("ended") == std::string::npos) {
      const auto count = read(pipe.reader(), part.data(), part.size());
      if (count <= 0) break;
      text.append(part.data(), static_cast<std::size_t>(count));
      std::this_thread::sleep_for(20ms);
    }
    return text;
  });
  OutputOptions options = options_of(pipe);
  options.patience = 1s;  // the reader makes room every 160 ms, and is done after more than that
  options.bytes = 512 * 1024;
  OutputWriter output(options);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(output.write(frame_text(i), Matter::frame));
  output.write_last("{\"event\":\"ended\"}\n");
  output.finish();
  EXPECT_EQ(objects(reader.get()).size(), 101U);
}

TEST_F(Output, DropsNothingWhereTheReaderMayHoldTheProgramUp) {
  const Pipe pipe;
  OutputOptions options = options_of(pipe);
  options.waits = true;
  auto reader = std::async(std::launch::async, [&] {
    std::this_thread::sleep_for(400ms);  // longer than the patience
    return pipe.read_until("ended");
  });
  OutputWriter output(options);
  for (int i = 0; i < 500; ++i) output.write(frame_text(i), Matter::frame);
  output.write_last("{\"event\":\"ended\"}\n");
  output.finish();
  EXPECT_EQ(objects(reader.get()).size(), 501U);
}

TEST_F(Output, WaitsForNoReaderAfterCtrlC) {
  const Pipe pipe;
  OutputOptions options = options_of(pipe);
  options.waits = true;
  options.hurried = [] { return true; };
  OutputWriter output(options);
  for (int i = 0; i < 500; ++i) output.write(frame_text(i), Matter::frame);
  output.finish();
  EXPECT_GE(objects(pipe.rest()).size(), 5U);
}

TEST_F(Output, SaysThatItsReaderWentAway) {
  Pipe pipe;
  pipe.close_reader();
  OutputWriter output(options_of(pipe));
  output.write("gone\n", Matter::word);
  for (int look = 0; look < 1000 && !output.failed(); ++look) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(output.failed());
  output.write("gone\n", Matter::word);
  output.finish();
  try {
    output.require_written();
    FAIL() << "it was not written";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_NE(error.what_happened().find("reader"), std::string::npos);
  }
}

}  // namespace
}  // namespace thermorig::app
