// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include "program.h"
#include "session/replace_session.h"
#include "support/file_text.h"
#include "thermorig/network/model/model.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::tests {
namespace {

using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

class EvaluateTest : public ProgramTest {
 protected:
  /// Three sessions of the simulated rig: two gardens and a laboratory.
  void record_sessions() const {
    record_once({"--environment garden --world honest --simulated=3 " + brief_plan,
                 "--environment garden --world honest --simulated=4 " + brief_plan,
                 "--environment laboratory --world honest --simulated=5 " + brief_plan});
  }

  void train(const std::string& words = "") const {
    const Outcome outcome =
        run("train recordings -o model.onnx --nr 3 --epochs 1 --preset paper --json " + words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }

  std::set<std::string> results() const {
    std::set<std::string> names;
    if (fs::exists(folder() / "study/results"))
      for (const auto& entry : fs::directory_iterator(folder() / "study/results"))
        if (entry.path().extension() == ".json") names.insert(entry.path().filename());
    return names;
  }

  /// Starts a study and waits until it has that many results.
  pid_t start_study(std::size_t results_wanted, const std::string& epochs) const {
    const pid_t process = start({"evaluate", "--study", "recordings", "-o", "study", "--nf", "3", "--nr", "3",
                                 "--reference-seeds", "1,2,3,4,5", "--epochs", epochs, "--json"});
    for (int i = 0; i < 20'000 && results().size() < results_wanted; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return process;
  }
};

const std::string small_study =
    "evaluate --study recordings -o study --nf 3 --nr 3 --reference-seeds 1 --epochs 1";

TEST_F(EvaluateTest, HoldsAModelAgainstAllFourEstimators) {
  record_sessions();
  train();
  const Outcome outcome = run("evaluate model.onnx recordings");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* const word : {"fusion, Nf 3, Nr 3", "89,794 weights", "SIMULATED", "cnn-thermal",
                                 "gyro-rest", "RMSE", "garden", "laboratory", "Kg: mean", "drift, deg/min",
                                 "warning: a lower MSE than cnn-fusion, without a network: gyro"})
    EXPECT_THAT(outcome.out, HasSubstr(word));
  EXPECT_TRUE(files(".html").empty());
  const nlohmann::json errors = run("evaluate model.onnx recordings --json").lines().back();
  const nlohmann::json &commanded = errors.at("errors").at("gyro"),
                       &shaft = errors.at("shaft_errors").at("gyro");
  EXPECT_EQ(commanded.at("windows"), shaft.at("windows"));
  EXPECT_NE(commanded.at("rmse_dps"), shaft.at("rmse_dps"));
}

TEST_F(EvaluateTest, SaysTheSameOfPackedFrames) {
  record_sessions();
  train();
  const std::string command = "evaluate model.onnx recordings --json --memory ";
  nlohmann::json in_memory = run(command + "1000").lines().back();
  nlohmann::json packed = run(command + "0").lines().back();
  EXPECT_EQ(in_memory.at("packed_bytes"), 0);
  EXPECT_GT(packed.at("packed_bytes"), 0);
  for (const char* name : {"memory_bytes", "packed_bytes", "bytes_on_disk"})
    for (nlohmann::json* object : {&in_memory, &packed}) object->erase(name);
  EXPECT_EQ(in_memory, packed);
}

TEST_F(EvaluateTest, WarnsOfDataThatTheModelWasTrainedOn) {
  record_sessions();
  train();
  const Outcome seen = run("evaluate model.onnx recordings");
  EXPECT_THAT(seen.out, HasSubstr("warning: the model was trained on, or chosen by, 3 of the tested"));
  ASSERT_EQ(
      run("record --fast --world honest --simulated=9 --environment kitchen -o others " + brief_plan).code,
      0);
  EXPECT_THAT(run("evaluate model.onnx others").out, Not(HasSubstr("trained on, or chosen by")));
}

TEST_F(EvaluateTest, MakesAStudyOfOneLabelOnly) {
  record_sessions();
  const Outcome shaft = run(small_study + " --label shaft --json");
  ASSERT_EQ(shaft.code, 0) << shaft.err;
  EXPECT_EQ(shaft.lines().front().at("label"), "shaft");
  EXPECT_THAT(file_text(folder() / "study/report.md"), HasSubstr("learnt and tested against | rate\\_shaft"));
  const nlohmann::json study = nlohmann::json::parse(file_text(folder() / "study/report.json"))["studies"][0];
  EXPECT_EQ(study["label"], "shaft");
  const nlohmann::json& fold = study["settings"][0]["folds"][0];
  EXPECT_EQ(fold["errors"], fold["shaft_errors"]);  // the label is the shaft
  const Outcome other = run(small_study);
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr("the study there learns from rate_shaft, this one from rate_commanded"));
  const Outcome renewed = run("evaluate --study recordings -o study --baselines");
  EXPECT_EQ(renewed.code, 2);
  EXPECT_THAT(renewed.err, HasSubstr("try: go on with --label shaft"));
  for (const char* words : {"", " --baselines"})  // refused before sessions are looked for, let alone read
    EXPECT_THAT(run("evaluate --study nowhere -o study" + std::string(words)).err,
                HasSubstr("the study there learns from rate_shaft"));
  EXPECT_EQ(run("evaluate --study recordings -o study --baselines --label shaft").code, 0);
}

TEST_F(EvaluateTest, AsksForALabelOfAStudyAlone) {
  EXPECT_THAT(run("evaluate model.onnx recordings --label shaft").err, HasSubstr("--label is for a study"));
  EXPECT_THAT(run(small_study + " --label shft").err, HasSubstr("did you mean \"shaft\"?"));
}

TEST_F(EvaluateTest, RemovesTheBiasOfTheRestAndNotTheJerkOfArming) {
  model::Model untrained;
  untrained.weights = network::initial_weights({.frames = 3, .reduction = 3}, 4);
  model::write_model(folder() / "model.onnx", untrained);
  ASSERT_EQ(run("record --fast --environment office --world honest --simulated=6 --simulated-gyro raw " +
                brief_plan)
                .code,
            0);
  const Outcome outcome = run("evaluate model.onnx recordings --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json errors = outcome.lines().back().at("errors");
  EXPECT_GT(std::abs(errors.at("gyro").at("mean_error_dps").get<double>()), 2.0);
  for (const char* const name : {"gyro-rest", "gyro-kalman"})
    EXPECT_LT(std::abs(errors.at(name).at("mean_error_dps").get<double>()), 0.3) << name;
}

TEST_F(EvaluateTest, SaysWhereThereIsNoBoundAndRefusesTheWordWhereItMeansNothing) {
  record_sessions();
  train();
  const Outcome outcome = run("evaluate model.onnx recordings --bound");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("warning: no bound for garden_acq-01"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("in units of the bound")));
  EXPECT_THAT(run("evaluate model.onnx recordings").out, Not(HasSubstr("no bound")));
  const Outcome refused = run("evaluate --live recordings --bound");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--bound is for a model on sessions"));
}

TEST_F(EvaluateTest, LeavesOutSessionsOfCalibrationsAndBadOnesUnlessTheyAreNamed) {
  record_sessions();
  train();
  const fs::path file = files(".h5").front();
  session::Session session = session::read_session(file);
  session.raw.header.plan_toml += "for_calibration = true\n";
  session::replace_session(file, session);
  const Outcome outcome = run("evaluate model.onnx recordings");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("left out, recorded for calibrations:\n  recordings/garden/garden_acq-01"));
  EXPECT_THAT(outcome.out, HasSubstr("tested on 2 acquisitions"));
  EXPECT_EQ(run("evaluate model.onnx " + file.string()).code, 2);  // nothing is left

  const fs::path other = files(".h5").at(1);
  session = session::read_session(other);
  session.counters[Device::camera].bad_checksum = 100'000;
  session::replace_session(other, session);
  for (const std::string command :
       {"evaluate model.onnx recordings", "train recordings -o other.onnx --epochs 1 --no-choose-epoch"}) {
    const Outcome without = run(command);
    EXPECT_EQ(without.code, 0) << without.err;
    EXPECT_THAT(without.out, HasSubstr("left out, verdict bad: recordings/garden/garden_acq-02"));
    EXPECT_THAT(without.out, HasSubstr("% of the camera's messages were lost or damaged"));
  }
  EXPECT_THAT(run("evaluate model.onnx recordings").out, HasSubstr("tested on 1 acquisition"));
  for (const std::string& paths :
       {other.string(), "recordings " + other.string(), std::string("recordings/garden")}) {
    const Outcome refused = run("evaluate model.onnx " + paths);
    EXPECT_EQ(refused.code, 9) << paths;
    EXPECT_THAT(refused.err, HasSubstr("garden_acq-02"));
    EXPECT_THAT(refused.err, HasSubstr("the session's verdict is bad: 9"));
    EXPECT_THAT(refused.err, HasSubstr("--accept-bad"));
  }
  EXPECT_THAT(run("evaluate model.onnx recordings --accept-bad").out,
              HasSubstr("bad, but accepted:\n  recordings/garden/garden_acq-02"));
  const nlohmann::json left = run("evaluate model.onnx recordings --json").lines().back();
  EXPECT_EQ(left.at("left_out").size(), 2U);
  EXPECT_EQ(left.at("bad").size(), 0U);
  const nlohmann::json told = run("evaluate model.onnx recordings --accept-bad --json").lines().back();
  EXPECT_EQ(told.at("left_out").size(), 1U);
  EXPECT_EQ(told.at("bad").size(), 1U);
}

TEST_F(EvaluateTest, WritesAReportInThreeForms) {
  record_sessions();
  train();
  const Outcome outcome = run("evaluate model.onnx recordings -o report --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json end = outcome.lines().back();
  EXPECT_TRUE(end.at("simulated").get<bool>());
  EXPECT_EQ(end.at("environments").size(), 2U);
  EXPECT_GE(end.at("warnings").size(), 2U);  // trained on these sessions; one epoch beats no gyro
  EXPECT_THAT(file_text(folder() / "report/report.md"), HasSubstr("SIMULATED"));
  EXPECT_TRUE(nlohmann::json::accept(file_text(folder() / "report/report.json")));
  EXPECT_THAT(file_text(folder() / "report/report.html"), HasSubstr("</html>"));
}

TEST_F(EvaluateTest, SaysNothingOfAGateThatAThermalOnlyModelHasNot) {
  record_sessions();
  train("--thermal-only");
  const Outcome outcome = run("evaluate model.onnx recordings");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("thermal-only, Nf 3, Nr 3"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("gate Kg")));
  EXPECT_THAT(outcome.out, HasSubstr("unknown"));
}

TEST_F(EvaluateTest, RunsTheStudyAndDrawsItAgain) {
  record_sessions();
  const Outcome outcome = run(small_study);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(
      outcome.out,
      HasSubstr(
          "4 trainings of 1 epoch, preset paper, label rate_commanded, 3 acquisitions of the SIMULATED"));
  EXPECT_THAT(outcome.out, HasSubstr("4 of 4 jobs"));
  EXPECT_EQ(results().size(), 4U);
  const std::string drawn = file_text(folder() / "study/report.md");
  EXPECT_THAT(drawn, HasSubstr("SIMULATED"));
  fs::remove(folder() / "study/report.md");
  ASSERT_EQ(run("evaluate --draw study").code, 0);
  EXPECT_EQ(file_text(folder() / "study/report.md"), drawn);
  ASSERT_EQ(run("evaluate --draw study/results -o elsewhere").code, 0);
  EXPECT_EQ(file_text(folder() / "elsewhere/report.md"), drawn);
  fs::remove(folder() / "study/report.md");
  const Outcome renewed = run("evaluate --study recordings -o study --baselines");
  ASSERT_EQ(renewed.code, 0) << renewed.err;
  EXPECT_THAT(renewed.out, HasSubstr("baselines of 4 results computed again, 0 differ from before"));
  EXPECT_EQ(file_text(folder() / "study/report.md"), drawn);
}

TEST_F(EvaluateTest, RepeatsNoJobOfAStudy) {
  record_sessions();
  ASSERT_EQ(run(small_study + " --jobs 2").code, 0);
  const Outcome again = run(small_study + " --jobs 1 --json");
  ASSERT_EQ(again.code, 0) << again.err;
  std::vector<std::string> events;
  for (const nlohmann::json& line : again.lines()) events.push_back(line.at("event"));
  EXPECT_THAT(events, testing::ElementsAre("start", "reused", "summary"));
}

TEST_F(EvaluateTest, KeepsFinishedJobsOnCtrlC) {
  record_sessions();
  const pid_t process = start_study(1, "200");
  ::kill(process, SIGINT);
  const Outcome outcome = wait(process);
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  const nlohmann::json last = outcome.lines().back();
  EXPECT_EQ(last.at("event"), "summary");
  EXPECT_EQ(last.at("exit_code"), 130);
  EXPECT_EQ(last.at("results").get<std::size_t>(), results().size());
  EXPECT_LT(results().size(), 20U);
  EXPECT_EQ(run("evaluate --draw study").code, 0);
}

TEST_F(EvaluateTest, GoesOnAfterAKill) {
  record_sessions();
  const pid_t process = start_study(2, "3");
  ::kill(process, SIGKILL);
  EXPECT_EQ(wait(process).code, 128 + SIGKILL);
  const std::set<std::string> before = results();
  const Outcome outcome =
      run("evaluate --study recordings -o study --nf 3 --nr 3 --reference-seeds 1,2,3,4,5 --epochs 3 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(results().size(), 20U);
  const std::vector<nlohmann::json> lines = outcome.lines();
  EXPECT_EQ(lines.at(1).at("event"), "reused");
  EXPECT_EQ(lines.at(1).at("jobs").get<std::size_t>(), before.size());
  EXPECT_TRUE(files(".part").empty());
}

TEST_F(EvaluateTest, NamesADamagedResult) {
  record_sessions();
  ASSERT_EQ(run(small_study).code, 0);
  const std::string name = *results().begin();
  fs::resize_file(folder() / "study/results" / name, 100);
  for (const std::string& words : {small_study, std::string("evaluate --draw study")}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 8);
    EXPECT_THAT(outcome.err, HasSubstr(name));
  }
}

TEST_F(EvaluateTest, ListsTheJobsOfAStudyAndWhereTheyStand) {
  record_sessions();
  const Outcome before = run(small_study + " --list-jobs");
  ASSERT_EQ(before.code, 0) << before.err;
  EXPECT_THAT(before.out, testing::MatchesRegex("(garden_acq-0[12]_nf3_nr3_(fusion|thermal)_paper_seed1_"
                                                "[0-9a-f]{12}  open\n){4}"));
  EXPECT_FALSE(fs::exists(folder() / "study"));
  const std::string id = before.out.substr(0, before.out.find(' '));
  ASSERT_EQ(run(small_study + " --shard 1/4").code, 0);
  EXPECT_THAT(results(), testing::ElementsAre(id + ".json"));
  std::vector<nlohmann::json> lines = run(small_study + " --list-jobs --json").lines();
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0].at("id"), id);
  EXPECT_EQ(lines[0].at("state"), "done");
  EXPECT_EQ(lines[1].at("state"), "open");
  EXPECT_EQ(lines[4].at("done"), 1);
  EXPECT_EQ(lines[4].at("open"), 3);
}

TEST_F(EvaluateTest, DrawsPartsOnlyOnceTheyAreAllThere) {
  record_sessions();
  const std::string draw =
      "evaluate --study recordings --draw study --require-complete --nf 3 --nr 3 "
      "--reference-seeds 1 --epochs 1";
  for (const std::string& part : {std::string("1/3"), std::string("3/3")}) {
    const Outcome outcome = run(small_study + " --shard " + part);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("thermorig evaluate --draw study"));
    const Outcome refused = run(draw);
    EXPECT_EQ(refused.code, 9);
    EXPECT_THAT(refused.out, testing::ContainsRegex("garden_acq-0._nf3_nr3_.*_seed1_.*  open\n"));
    EXPECT_THAT(refused.err, HasSubstr("of the study's 4 results are missing"));
  }
  EXPECT_EQ(results().size(), 3U);
  EXPECT_FALSE(fs::exists(folder() / "study/report.md"));
  EXPECT_EQ(run(draw + " --json").lines().front().at("state"), "open");
  ASSERT_EQ(run(small_study + " --shard 2/3 --json").code, 0);
  ASSERT_EQ(run(draw).code, 0);
  const std::string drawn = file_text(folder() / "study/report.md");
  ASSERT_EQ(run(small_study).code, 0);
  EXPECT_EQ(file_text(folder() / "study/report.md"), drawn);
}

TEST_F(EvaluateTest, NamesTheInstructionSetsOfAStudyThatMixesThem) {
  record_sessions();
  const Outcome outcome = run(small_study);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, Not(HasSubstr("computed with")));
  const fs::path file = folder() / "study/results" / *results().begin();
  nlohmann::json result = nlohmann::json::parse(file_text(file));
  result["instruction_set"] = "another";
  result["version"] = 4;  // which had no sum
  std::ofstream(file) << result;
  EXPECT_THAT(run("evaluate --draw study").out,
              testing::ContainsRegex("computed with .+ \\(3 results\\), another \\(1 result\\)"));
}

TEST_F(EvaluateTest, RefusesPartsThatAStudyHasNot) {
  record_sessions();
  for (const char* const shard : {"0/4", "5/4", "4", "x/4"}) {
    const Outcome outcome = run(small_study + " --shard " + shard);
    EXPECT_EQ(outcome.code, 2) << shard;
    EXPECT_THAT(outcome.err, HasSubstr("--array=1-8")) << shard;
  }
  EXPECT_EQ(run(small_study + " --shard 1/2 --list-jobs").code, 2);
  EXPECT_EQ(run(small_study + " --shard 1/2 --draw study").code, 2);
  EXPECT_EQ(run("evaluate --study recordings --list-jobs").code, 2);
  EXPECT_EQ(run("evaluate recordings --list-jobs -o study").code, 2);
  EXPECT_EQ(run("evaluate --draw study --require-complete").code, 2);
  EXPECT_EQ(run(small_study + " --require-complete").code, 2);
  EXPECT_FALSE(fs::exists(folder() / "study"));
}

TEST_F(EvaluateTest, RefusesWhatItCannotDo) {
  record_sessions();
  std::ofstream(folder() / "bad.onnx") << "no model";
  EXPECT_EQ(run("evaluate").code, 2);
  EXPECT_EQ(run("evaluate missing.onnx recordings").code, 2);
  EXPECT_EQ(run("evaluate bad.onnx recordings").code, 8);
  EXPECT_EQ(run("evaluate bad.onnx").code, 2);
  EXPECT_EQ(run("evaluate --study -o study").code, 2);
  EXPECT_EQ(run("evaluate --study recordings").code, 2);
  EXPECT_EQ(run("evaluate --study recordings -o study --nf 7").code, 2);
  EXPECT_EQ(run("evaluate --study recordings -o study --environment kitchen").code, 2);
  EXPECT_EQ(run("evaluate --study recordings -o study --environment laboratory").code, 2);
  EXPECT_EQ(run("evaluate --draw missing").code, 2);
  EXPECT_EQ(run("evaluate --baselines recordings -o study").code, 2);
  EXPECT_EQ(run("evaluate --study recordings -o study --baselines").code, 2);  // there are no results
  EXPECT_FALSE(fs::exists(folder() / "study"));
}

TEST_F(EvaluateTest, ShowsAProgressLineOnATerminal) {
  record_sessions();
  const Outcome outcome = run_on_terminal("", small_study);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("\x1b[K4 of 4 jobs, 100 %"));
  const Outcome plain = run_on_terminal("NO_COLOR=1", small_study + " --epochs 2");
  EXPECT_THAT(plain.out, Not(HasSubstr("\x1b")));
}

}  // namespace
}  // namespace thermorig::tests
