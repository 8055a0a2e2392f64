// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <set>
#include <sstream>
#include <thread>

#include "program.h"
#include "session/replace_session.h"
#include "support/file_text.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::tests {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Two short recordings and a network that learns them in no time.
class Train : public ProgramTest {
 protected:
  Train() { record_once({honest_garden + "3", honest_garden + "4"}); }

  static constexpr const char* plan = "--plan quick --speeds 40,80 --frames-per-leg 24";
  const std::string honest_garden =
      std::string("--environment garden --world honest ") + plan + " --simulated=";
  const std::string network = "train recordings --nf 2 --nr 3 ";
  const std::string small = network + "--epochs 3 ";

  fs::path at(const std::string& name) const { return folder() / name; }

  /// Starts a training of very many epochs and waits until it has kept some.
  pid_t start_long(const std::string& model) const {
    const pid_t process = start({"train", "recordings", "--nf", "2", "--nr", "3", "--epochs", "5000",
                                 "--threads", "1", "-o", model + ".onnx"});
    for (int look = 0; look < 3000 && epochs_kept(model) < 3; ++look)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return process;
  }

  std::ptrdiff_t epochs_kept(const std::string& model) const {
    const std::string metrics = file_text(at(model + ".run") / "metrics.ndjson");
    return std::count(metrics.begin(), metrics.end(), '\n');
  }
};

TEST_F(Train, MakesAModelAndSaysWhatItIsWorth) {
  const Outcome outcome = run(small + "--preset paper --auxiliary-thermal 0.5 --choose-epoch -o model.onnx");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* part :
       {"garden", "SIMULATED data", "fusion, Nf 2, Nr 3: 89,644 weights", "seed 1", "epoch 3 of 3", "  RMSE ",
        "deg/s", "gyro alone", "gate Kg", "held-out", " + 0.5 x ", " of the images = ", "lowest so far",
        "next  thermorig evaluate model.onnx"})
    EXPECT_THAT(outcome.out, HasSubstr(part));
  EXPECT_THAT(outcome.out, Not(HasSubstr("\x1b")));
  std::istringstream lines(outcome.out);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("epoch ")) {
      EXPECT_LE(line.size(), 80U) << line;
    }
  EXPECT_GT(fs::file_size(at("model.onnx")), 89'644U * 4);
  for (const char* name : {"run.json", "metrics.ndjson", "checkpoint.bin", "model.onnx"})
    EXPECT_TRUE(fs::exists(at("model.run") / name)) << name;
  EXPECT_EQ(file_text(at("model.run/model.onnx")), file_text(at("model.onnx")));
}

TEST_F(Train, TellsProgramsTheSameAsJson) {
  const Outcome outcome = run(small + "--choose-epoch --json -o model.onnx");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0]["event"], "start");
  EXPECT_EQ(lines[0]["data"]["acquisitions"], 2);
  EXPECT_EQ(lines[0]["environments"]["garden"]["simulated"], 2);
  EXPECT_EQ(lines[3]["event"], "epoch");
  EXPECT_EQ(lines[3]["epoch"], 3);
  EXPECT_GT(lines[3]["training_rmse_dps"], 0.0);
  const auto& summary = lines[4];
  EXPECT_EQ(summary["event"], "summary");
  EXPECT_EQ(summary["exit_code"], 0);
  EXPECT_EQ(summary["model"], "model.onnx");
  EXPECT_TRUE(summary["simulated"]);
  EXPECT_GT(summary["training"]["gyro_mse"], 0.0);
  EXPECT_GT(summary["held_out"]["windows"], 10);
}

TEST_F(Train, GivesTheSameFileForTheSameSeedWhateverTheThreads) {
  ASSERT_EQ(run(small + "-o one.onnx --threads 1").code, 0);
  ASSERT_EQ(run(small + "-o two.onnx --threads 3").code, 0);
  ASSERT_EQ(run(small + "-o three.onnx --seed 2").code, 0);
  EXPECT_EQ(file_text(at("one.onnx")), file_text(at("two.onnx")));
  EXPECT_NE(file_text(at("one.onnx")), file_text(at("three.onnx")));
}

TEST_F(Train, TakesThePaperToTheLetterOrAsItIsTold) {
  const auto start_of = [&](const std::string& words) {
    return run(small + "--json " + words).lines().at(0);
  };
  const auto paper = start_of("--preset paper -o a.onnx");
  EXPECT_EQ(paper["auxiliary_thermal"], 0.0);
  EXPECT_EQ(paper["symmetries"], 1);
  EXPECT_FALSE(paper["window_scaling"]);
  EXPECT_FALSE(paper["choose_epoch"]);
  const auto best = start_of("-o b.onnx");
  EXPECT_TRUE(best["likelihood"]);
  EXPECT_EQ(best["symmetries"], 8);
  EXPECT_TRUE(best["window_scaling"]);
  EXPECT_FALSE(best["choose_epoch"]);
  const auto custom = start_of("--symmetries 1 --no-choose-epoch --thermal-only --label-scale 100 -o c.onnx");
  EXPECT_EQ(custom["preset"], "custom");
  EXPECT_EQ(custom["symmetries"], 1);
  EXPECT_FALSE(custom["choose_epoch"]);
  EXPECT_FALSE(custom["fusion"]);
  EXPECT_EQ(custom["label_scale_dps"], 100.0);
}

TEST_F(Train, LearnsFromMadeUpRoomsAloneOrBesideRecordings) {
  const Outcome alone = run("train --made-rooms --nf 2 --nr 3 --epochs 1 --thermal-only -o alone.onnx");
  ASSERT_EQ(alone.code, 0) << alone.err;
  EXPECT_THAT(alone.out,
              HasSubstr("MADE-UP rooms: 32 of 32 windows a step, seen through 55 degrees, half frames"));
  const Outcome beside = run(small + "--made-rooms --from none -o beside.onnx");
  ASSERT_EQ(beside.code, 0) << beside.err;
  EXPECT_THAT(beside.out, HasSubstr("MADE-UP rooms: 16 of 32 windows"));
  EXPECT_EQ(run(small + "--made-rooms --preset paper -o paper.onnx").code, 2);
  EXPECT_EQ(run("train -o nothing.onnx").code, 2);
}

TEST_F(Train, BeginsWithTheGeneralModelWhereItHasLearntThisCamera) {
  const Outcome general = run("train recordings --epochs 1 -o general.onnx");
  ASSERT_EQ(general.code, 0) << general.err;
  EXPECT_THAT(general.out,
              AllOf(HasSubstr("begins with the general model, weights "), HasSubstr("Nf 3, Nr 2")));
  const Outcome none = run("train recordings --epochs 1 --from none -o none.onnx");
  EXPECT_THAT(none.out, AllOf(Not(HasSubstr("begins with")), HasSubstr("Nf 3, Nr 1")));
  const Outcome paper = run("train recordings --epochs 1 --preset paper -o paper.onnx");
  EXPECT_THAT(paper.out, Not(HasSubstr("begins with")));
  const Outcome evaluated = run("evaluate general recordings --turned 8");
  ASSERT_EQ(evaluated.code, 0) << evaluated.err;
  EXPECT_THAT(evaluated.out, AllOf(HasSubstr("windows of MADE-UP rooms"), HasSubstr("sigma that Kg states")));
  EXPECT_EQ(run("evaluate paper.onnx recordings --turned 8").code, 2);
}

TEST_F(Train, GoesOnWithANetworkOfItsOwnKindAlone) {
  ASSERT_EQ(run(small + "-o model.onnx").code, 0);
  const Outcome on = run("train recordings --epochs 1 --from model.onnx -o on.onnx");
  ASSERT_EQ(on.code, 0) << on.err;
  EXPECT_THAT(on.out, AllOf(HasSubstr("begins with model.onnx, weights "), HasSubstr("Nf 2, Nr 3")));
  const Outcome other = run("train recordings --nf 3 --from model.onnx -o other.onnx");
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr("a training goes on only with a network of its own kind"));
  EXPECT_EQ(run("train recordings --preset paper --from model.onnx -o paper.onnx").code, 2);
}

TEST_F(Train, NeverOverwritesAModel) {
  write("model.onnx", std::vector<std::uint8_t>{'m', 'i', 'n', 'e'});
  const Outcome outcome = run(small + "-o model.onnx");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("model.onnx"), HasSubstr("never overwritten"), HasSubstr("try:")));
  EXPECT_EQ(file_text(at("model.onnx")), "mine");
  EXPECT_FALSE(fs::exists(at("model.run")));
}

TEST_F(Train, NeverMixesTwoRuns) {
  ASSERT_EQ(run(small + "-o model.onnx").code, 0);
  fs::remove(at("model.onnx"));
  const Outcome outcome = run(small + "-o model.onnx");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--resume"));
}

TEST_F(Train, ResumesAFinishedRunToTheSameModel) {
  ASSERT_EQ(run(small + "-o model.onnx").code, 0);
  const std::string before = file_text(at("model.onnx"));
  EXPECT_EQ(run(small + "-o model.onnx --resume").code, 0);
  EXPECT_EQ(file_text(at("model.onnx")), before);
}

TEST_F(Train, RefusesToResumeWithOtherSettingsOrOtherData) {
  ASSERT_EQ(run(small + "-o model.onnx").code, 0);
  Outcome outcome = run(network + "--epochs 4 -o model.onnx --resume");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("epochs (3, now 4)"));
  EXPECT_EQ(run(std::string("record --fast --environment kitchen --world honest --simulated=5 ") + plan).code,
            0);
  outcome = run(small + "-o model.onnx --resume");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("2 acquisitions, now 3"));
  EXPECT_EQ(run(small + "-o other.onnx --resume").code, 2);
}

TEST_F(Train, ASignalKeepsTheBestModelSoFar) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::string name = "model" + std::to_string(signal);
    const pid_t process = start_long(name);
    kill(process, signal);
    const Outcome outcome = wait(process);
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("stopped after"), HasSubstr("--resume"), HasSubstr("model " + name)));
    EXPECT_GT(fs::file_size(at(name + ".onnx")), 300'000U);
  }
}

TEST_F(Train, GoesOnAfterKillAsIfNothingHadHappened) {
  const pid_t process = start_long("model");
  kill(process, SIGKILL);
  EXPECT_EQ(wait(process).code, 128 + SIGKILL);
  EXPECT_FALSE(fs::exists(at("model.onnx")));
  const auto kept = epochs_kept("model");
  const std::string before = file_text(at("model.run/metrics.ndjson"));
  const pid_t resumed = start({"train", "recordings", "--nf", "2", "--nr", "3", "--epochs", "5000",
                               "--threads", "2", "-o", "model.onnx", "--resume"});
  for (int look = 0; look < 3000 && epochs_kept("model") < kept + 2; ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  kill(resumed, SIGINT);
  const Outcome outcome = wait(resumed);
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("going on after epoch"));
  EXPECT_TRUE(file_text(at("model.run/metrics.ndjson")).starts_with(before));
  EXPECT_TRUE(fs::exists(at("model.onnx")));
}

TEST_F(Train, SaysWhoTrainsInTheFolderAlready) {
  const pid_t process = start_long("model");
  const Outcome refused =
      run("train recordings --nf 2 --nr 3 --epochs 5000 --threads 2 -o model.onnx --resume");
  EXPECT_EQ(refused.code, 6);
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("process " + std::to_string(process) + " (thermorig) trains in this folder"),
                    HasSubstr("--run-folder")));
  kill(process, SIGINT);
  EXPECT_EQ(wait(process).code, 130);
}

TEST_F(Train, SaysWhenTheGateHasCollapsed) {
  // To the letter, on few windows whose gyro is good: nothing teaches the images.
  const Outcome outcome = run(network + "--preset paper --epochs 20 --rate 0.01 -o model.onnx");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("warning: the gate has collapsed"), HasSubstr("--preset best")));
  // What the training did already is no advice.
  const Outcome weak =
      run(network + "--epochs 20 --rate 0.01 --preset paper --auxiliary-thermal 0.001 -o weak.onnx");
  EXPECT_THAT(weak.out, HasSubstr("gate has collapsed"));
  EXPECT_THAT(weak.out,
              AllOf(HasSubstr("--auxiliary-thermal 0.002"), testing::Not(HasSubstr("--preset best"))));
}

TEST_F(Train, SaysWhenTheGyroAloneIsBetter) {
  const Outcome outcome = run(network + "--thermal-only --epochs 1 -o model.onnx");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("warning: the gyro alone is better than this network"));
}

TEST_F(Train, LearnsTheLabelThatIsAskedForAndSaysSoEverywhere) {
  std::set<std::string> weights;
  for (const char* label : {"commanded", "corrected", "shaft"}) {
    const std::string name(label);
    const Outcome outcome = run(small + "--json -o " + name + ".onnx --label " + name);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.lines()[0]["label"], name);
    EXPECT_EQ(nlohmann::json::parse(file_text(at(name + ".run/run.json")))["settings"]["label"], name);
    EXPECT_THAT(
        run("evaluate " + name + ".onnx recordings").out,
        AllOf(HasSubstr("trained on rate_" + name + " of 2 acquisitions"), HasSubstr("against the command"),
              HasSubstr("against the shaft"), HasSubstr("chosen by, 2 of the tested")));
    ASSERT_EQ(run("export --c-header " + name + ".onnx -o " + name).code, 0);
    EXPECT_THAT(file_text(at(name + "/thermorig_network.h")), HasSubstr(", label " + name + ", seed 1"));
    weights.insert(file_text(at(name + ".onnx")));
  }
  EXPECT_EQ(weights.size(), 3U);
}

TEST_F(Train, RefusesALabelThatThereIsNotAndToResumeWithAnother) {
  const Outcome unknown = run(small + "-o model.onnx --label comanded");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err,
              HasSubstr("did you mean \"commanded\"? one of: commanded, corrected, measured, shaft"));
  EXPECT_FALSE(fs::exists(at("model.run")));
  ASSERT_EQ(run(small + "-o model.onnx").code, 0);
  const Outcome other = run(small + "-o model.onnx --resume --label shaft");
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err,
              HasSubstr("the run was begun with something else: label (\"commanded\", now \"shaft\")"));
}

TEST_F(Train, RefusesWordsThatCannotBe) {
  for (const char* words : {"--nf 7", "--nr 0", "--preset worst", "--epochs 0", "--rate 0", "--rate nan",
                            "--batch 33", "--label-scale -1", "--auxiliary-thermal -1", "--threads 0"}) {
    const Outcome outcome = run(std::string("train recordings -o model.onnx ") + words);
    EXPECT_EQ(outcome.code, 2) << words;
    EXPECT_FALSE(fs::exists(at("model.run"))) << words;
  }
  EXPECT_EQ(run("train nowhere -o model.onnx").code, 2);
  EXPECT_EQ(run("train -o model.onnx").code, 2);
}

TEST_F(Train, RefusesWhatIsNoSession) {
  write("recordings/bad.h5", std::vector<std::uint8_t>(3000, 'x'));
  const Outcome outcome = run(small + "-o model.onnx");
  EXPECT_EQ(outcome.code, 8);
  EXPECT_THAT(outcome.err, HasSubstr("bad.h5"));
}

TEST_F(Train, LeavesOutSessionsOfCalibrationsAndBadOnesThatItFindsInAFolder) {
  const fs::path file = files(".h5").front();
  session::Session session = session::read_session(file);
  session.counters[Device::camera].bad_checksum = 100'000;
  session::replace_session(file, session);
  const Outcome without = run(small + "-o other.onnx --no-choose-epoch");
  EXPECT_EQ(without.code, 0) << without.err;
  EXPECT_THAT(without.out, HasSubstr("left out, verdict bad: recordings/garden/garden_acq-01"));
  const Outcome refused = run(small + "-o model.onnx " + file.string());
  EXPECT_EQ(refused.code, 9);
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("the session's verdict is bad"), HasSubstr(file.filename().string())));
  EXPECT_FALSE(fs::exists(at("model.run")));
  session.raw.header.plan_toml += "for_calibration = true\n";
  session::replace_session(file, session);
  const Outcome outcome = run(small + "-o model.onnx --no-choose-epoch");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr("left out, recorded for calibrations:\n  recordings/garden/garden_acq-01"));
  const auto start = run(small + "-o again.onnx --no-choose-epoch --json").lines().at(0);
  EXPECT_EQ(start["data"]["acquisitions"], 1);
  EXPECT_EQ(start["left_out"].size(), 1U);
  EXPECT_TRUE(start["bad"].empty());
}

TEST_F(Train, RefusesToChooseTheEpochByTheOnlyAcquisitionAndLeavesNothing) {
  fs::remove(files(".h5").front());
  const Outcome refused = run(small + "-o model.onnx --choose-epoch");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--no-choose-epoch"));
  EXPECT_FALSE(fs::exists(at("model.run")));
  EXPECT_EQ(run(small + "-o model.onnx --no-choose-epoch").code, 0);  // what the refusal tells to do
}

TEST_F(Train, SaysWhenTheDiskIsFull) {
  const std::string command = "cd " + folder().string() + " && ulimit -f 100 && " + THERMORIG_PROGRAM + " " +
                              small + "-o model.onnx >out.txt 2>err.txt";
  const int status = std::system(("sh -c '" + command + "'").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 7) << file_text(at("err.txt"));
  EXPECT_FALSE(fs::exists(at("model.onnx")));
  EXPECT_THAT(file_text(at("err.txt")), HasSubstr("checkpoint.bin"));
}

TEST_F(Train, GivesTheSameFileFromPackedFrames) {
  const Outcome floats = run(small + "-o floats.onnx --memory 1000");
  ASSERT_EQ(floats.code, 0) << floats.err;
  EXPECT_THAT(floats.out, HasSubstr("frames in memory (limit 1.0 GB)"));
  const auto start = run(small + "-o packed.onnx --memory 0 --json").lines().at(0);
  EXPECT_EQ(file_text(at("floats.onnx")), file_text(at("packed.onnx")));
  EXPECT_EQ(start["memory_bytes"], 0);
  EXPECT_GT(start["bytes_on_disk"], 0);
  const double bytes_a_pixel =
      start["packed_bytes"].get<double>() / 24 / 32 / start["data"]["frames"].get<int>();
  EXPECT_EQ(bytes_a_pixel, 2.0);  // hundredths of a degree
}

TEST_F(Train, DrawsOverOneLineOnATerminalAndNotWithNoColor) {
  const Outcome drawn = run_on_terminal("TERM=xterm", small + "-o a.onnx");
  const Outcome plain = run_on_terminal("TERM=xterm NO_COLOR=1", small + "-o b.onnx");
  ASSERT_EQ(drawn.code, 0) << drawn.out;
  EXPECT_THAT(drawn.out, AllOf(HasSubstr("\x1b["), HasSubstr("left"), HasSubstr("epoch 3 of 3")));
  EXPECT_THAT(plain.out, AllOf(Not(HasSubstr("\x1b")), HasSubstr("epoch 3 of 3")));
}

}  // namespace
}  // namespace thermorig::tests
