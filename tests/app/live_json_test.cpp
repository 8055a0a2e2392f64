// SPDX-License-Identifier: MIT
// What programs get of a live run: its messages, and how many of them they missed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "live/live_facts.h"
#include "live/live_lines.h"
#include "pipe.h"

namespace thermorig::app {
namespace {

using nlohmann::json;

TEST(LiveMessages, ALoopHasNoTimeToGo) {
  rig::RecordingOptions recording;
  recording.plan = rig::load_plan("quick", "laboratory", 3, {});
  recording.plan.repeat = true;
  rig::RecordingProgress progress;
  progress.sweep.eta_s = 5.0;
  const LiveFacts endless = live_facts(LiveMode::live, {}, recording);
  EXPECT_EQ(hello_message(endless)["plan"]["repeats"], true);
  EXPECT_TRUE(state_message(progress, endless, std::nullopt)["eta_s"].is_null());
  recording.plan.repeat = false;
  const LiveFacts once = live_facts(LiveMode::live, {}, recording);
  EXPECT_EQ(hello_message(once)["plan"]["repeats"], false);
  EXPECT_EQ(state_message(progress, once, std::nullopt)["eta_s"], 5.0);
}

TEST(LiveJson, TellsHowManyFramesItDroppedForAReaderThatStopped) {
  constexpr int frames = 1000, states = 500;
  const tests::Pipe pipe;
  tests::HandClock clock;  // it stands, and so patience has no end
  OutputOptions options;
  options.descriptor = pipe.writer();
  options.bytes = 64'000;
  options.now = [&] { return clock.now(); };
  options.of_dropped = dropped_object;
  OutputWriter output(options);
  const auto sink = make_live_json(output);
  EXPECT_FALSE(sink->wants(web::Topic::image));
  EXPECT_FALSE(sink->wants(web::Topic::surroundings));
  const std::string filling(200, 'x');
  const auto send = [&](web::Topic topic, const std::string& event) {
    sink->take(topic, json{{"event", event}, {"filling", filling}}.dump());
  };
  send(web::Topic::hello, "hello");
  for (int i = 0; i < frames; ++i) {
    send(web::Topic::frame, "frame");
    if (i % 2 == 0) send(web::Topic::state, "state");
  }
  for (int i = 0; i < 50; ++i) send(web::Topic::event, "event");
  sink->take(web::Topic::ended, R"({"event":"ended"})");
  auto reader = std::async(std::launch::async, [&] { return pipe.read_until("\"ended\"}\n"); });
  output.finish();
  std::map<std::string, int> came;
  std::istringstream lines(reader.get());
  for (std::string line; std::getline(lines, line);) {
    const json object = json::parse(line);
    ++came[object["event"]];
    if (object["event"] != "dropped") continue;
    came["frame"] += object["frames"].get<int>();
    came["state"] += object["states"].get<int>();
  }
  EXPECT_GE(came["dropped"], 1);
  EXPECT_EQ(came["frame"], frames);
  EXPECT_EQ(came["state"], states);
  EXPECT_EQ(came["event"], 50) << "words have room where frames and states have none";
  EXPECT_EQ(came["hello"], 1);
  EXPECT_EQ(came["ended"], 1);
}

}  // namespace
}  // namespace thermorig::app
