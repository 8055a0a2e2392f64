// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include "program.h"
#include "thermorig/network/model/model.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::tests {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class EvaluateLiveTest : public ProgramTest {
 protected:
  /// An untrained network: what it says is the same to the last digit or it is not.
  void make_model() const {
    model::Model model;
    model.weights = network::initial_weights({.frames = 3, .reduction = 3}, 4);
    model.scaling = {150.0F, 22.0F, 3.0F};
    model::write_model(folder() / "model.onnx", model);
  }

  /// What a live run in virtual time printed.
  Outcome live(const std::string& words) const {
    return run(
        "live --world honest --simulated=3 --fast --speeds 40,80 --frames-per-leg 12 --environment garden "
        "--json " +
        words);
  }

  static Checked<nlohmann::json> frames_of(const Outcome& outcome) {
    Checked<nlohmann::json> frames;
    for (const nlohmann::json& line : outcome.lines())
      if (line.at("event") == "frame") frames.push_back(line);
    return frames;
  }

  fs::path session() const { return files(".h5").front(); }
};

TEST_F(EvaluateLiveTest, GivesTheScreensFiguresToTheLastDigit) {
  make_model();
  const Outcome shown = live("--record --model model.onnx");
  ASSERT_EQ(shown.code, 0) << shown.err;
  const Outcome outcome = run("evaluate --live --json " + session().string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json evaluated = outcome.lines().front();
  const auto frames = frames_of(shown);
  EXPECT_EQ(evaluated.at("scores").dump(), frames.back().at("scores").dump());
  EXPECT_EQ(evaluated.at("frames"), frames.size());
  EXPECT_GT(evaluated.at("scores").at("counted"), 10);
  EXPECT_EQ(evaluated.at("model").at("name"), "model.onnx");
  EXPECT_EQ(outcome.lines().back().at("sessions"), 1);
}

TEST_F(EvaluateLiveTest, SetsTheFinalisedLabelsBesideThem) {
  make_model();
  ASSERT_EQ(live("--record --model model.onnx").code, 0);
  const Outcome outcome = run("evaluate --live --json recordings");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json finalised = outcome.lines().front().at("finalised");
  EXPECT_GT(finalised.at("compared"), 10);
  EXPECT_LT(finalised.at("label_difference_max_dps"), 5.0);  // the same rates, known better
  EXPECT_EQ(finalised.at("scores").at("counted"), finalised.at("compared"));
  // The same windows as plain `evaluate` has, and the same estimates where their gyro is the same.
  const nlohmann::json plain = run("evaluate model.onnx recordings --json").lines().back();
  EXPECT_EQ(finalised.at("windows"), plain.at("errors").at("gyro").at("windows"));
  const Outcome text = run("evaluate --live recordings");
  for (const char* const word : {"SIMULATED", "model.onnx (fusion, Nf 3, Nr 3)", "on the screen",
                                 "finalised labels", "finalised minus live", "gate Kg"})
    EXPECT_THAT(text.out, HasSubstr(word));
}

TEST_F(EvaluateLiveTest, StaysTheSameWhenTheSessionIsMadeAgain) {
  make_model();
  ASSERT_EQ(live("--record --model model.onnx").code, 0);
  const std::string before = run("evaluate --live --json recordings").lines().front().dump();
  ASSERT_EQ(run("reprocess " + session().string()).code, 0);
  EXPECT_EQ(run("evaluate --live --json recordings").lines().front().dump(), before);
}

TEST_F(EvaluateLiveTest, AReplayShowsEveryFrameAsTheRunDid) {
  make_model();
  auto shown = frames_of(live("--record --model model.onnx"));
  const Outcome replay =
      run("live --replay " + session().string() + " --model model.onnx --speed max --no-page --json");
  ASSERT_EQ(replay.code, 0) << replay.err;
  auto replayed = frames_of(replay);
  ASSERT_EQ(replayed.size(), shown.size());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    shown[i].erase("inference_us");  // the only one that a clock gave
    replayed[i].erase("inference_us");
    EXPECT_EQ(replayed[i].dump(), shown[i].dump());
  }
}

TEST_F(EvaluateLiveTest, KnowsARunWithoutANetwork) {
  ASSERT_EQ(live("--record --model none").code, 0);
  const Outcome outcome = run("evaluate --live --json recordings");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json evaluated = outcome.lines().front();
  EXPECT_TRUE(evaluated.at("model").is_null());
  EXPECT_FALSE(evaluated.at("scores").at("estimators").contains("cnn-thermal"));
  EXPECT_GT(evaluated.at("scores").at("estimators").at("gyro").at("frames"), 10);
  EXPECT_THAT(run("evaluate --live recordings").out, HasSubstr("live with no network"));
}

TEST_F(EvaluateLiveTest, LeavesOutABadSessionOfAFolder) {
  for (int i = 0; i < 2; ++i) ASSERT_EQ(live("--record").code, 0);
  const std::string bad = session().lexically_relative(folder()).string();
  ASSERT_EQ(run("annotate " + bad + " --exclude all").code, 0);
  const Outcome outcome = run("evaluate --live recordings");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("left out, verdict bad: " + bad));
  const nlohmann::json summary = run("evaluate --live --json recordings").lines().back();
  EXPECT_EQ(summary.at("sessions"), 1);
  EXPECT_EQ(summary.at("left_out"), nlohmann::json::array({bad}));
  EXPECT_EQ(run("evaluate --live " + bad).code, 9);
  fs::remove(files(".h5").back());
  EXPECT_EQ(run("evaluate --live recordings").code, 9);  // no other is left
}

TEST_F(EvaluateLiveTest, RefusesASessionThatNoLiveRunMade) {
  const fs::path plain = record_briefly();
  for (const std::string& words : {plain.string(), std::string("recordings")}) {
    const Outcome outcome = run("evaluate --live " + words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("/estimates"));
    EXPECT_THAT(outcome.err, HasSubstr("live --record"));
  }
  EXPECT_EQ(run("evaluate --live").code, 2);
  EXPECT_EQ(run("evaluate --live missing").code, 2);
  EXPECT_EQ(run("evaluate --live --study recordings -o study").code, 2);
  const Outcome with_folder = run("evaluate --live recordings -o report");
  EXPECT_EQ(with_folder.code, 2);
  EXPECT_THAT(with_folder.err, HasSubstr("--live only prints"));
  ASSERT_EQ(live("--record").code, 0);
  EXPECT_EQ(run("evaluate --live --json recordings").lines().back().at("sessions"), 1);
}

}  // namespace
}  // namespace thermorig::tests
