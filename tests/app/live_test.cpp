// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <thread>

#include "model/sample_models.h"
#include "program.h"
#include "support/file_text.h"
#include "support/hand_clock.h"
#include "thermorig/storage/session/session.h"
#include "web_server/page_client.h"

namespace thermorig::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

/// A live run of a small network with seeded weights: what it says means nothing, but it is always the same.
class Live : public ProgramTest {
 protected:
  Live() {
    network::Shape shape;
    shape.frames = 3;
    shape.reduction = 3;
    model::write_model(folder() / "model.onnx", model::sample_model(shape));
  }

  static Checked<json> of_kind(const std::vector<json>& lines, const std::string& kind) {
    Checked<json> chosen;
    for (const json& line : lines)
      if (line.value("event", "") == kind) chosen.push_back(line);
    return chosen;
  }

  /// Frames without what the wall's clock told of them.
  static Checked<json> frames_of(const Outcome& outcome) {
    Checked<json> frames = of_kind(outcome.lines(), "frame");
    for (json& frame : frames) frame.erase("inference_us");
    return frames;
  }

  const std::string plan = "--plan quick --speeds 60,120 --frames-per-leg 12 ";
  const std::string fast = "live --world honest --simulated=3 --fast --json --model model.onnx " + plan;
};

std::set<std::string> keys_of(const json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.insert(key);
  return keys;
}

TEST_F(Live, HasAGeneralModelForEachOfTheTwoLensesAndForNoOther) {
  const auto with_lens = [&](const std::string& degrees) {
    const std::string profile = "[camera]\nfield_of_view_deg = " + degrees + "\n";
    write("rig.toml", {reinterpret_cast<const std::uint8_t*>(profile.data()), profile.size()});
    return run("live --simulated=3 --fast --json --model general --rig rig.toml " + plan);
  };
  EXPECT_EQ(with_lens("55").lines().front()["model"]["name"], "general-55.onnx");
  EXPECT_EQ(with_lens("110").lines().front()["model"]["name"], "general-110.onnx");
  const Outcome other = with_lens("75");
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr("the model has learnt a lens of 55 degrees"));
}

TEST_F(Live, PrintsTheDocumentedMessages) {
  const Outcome outcome = run(fast);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<json> lines = outcome.lines();
  ASSERT_GT(lines.size(), 60U);
  EXPECT_EQ(keys_of(lines.front()),
            (std::set<std::string>{"event", "version", "run", "mode", "recording", "simulated", "simulation",
                                   "environment", "acquisition", "start_utc", "control", "frame_rate_hz",
                                   "model", "estimators", "plan"}));
  EXPECT_EQ(lines.front()["event"], "hello");
  EXPECT_THAT(lines.front()["run"].get<std::string>(), MatchesRegex("[0-9a-f]{16}"));
  EXPECT_EQ(lines.front()["mode"], "live");
  EXPECT_EQ(lines.front()["recording"], false);
  EXPECT_TRUE(lines.front()["acquisition"].is_null());
  EXPECT_EQ(lines.front()["model"]["frames"], 3);
  EXPECT_EQ(lines.back()["event"], "ended");
  EXPECT_EQ(lines.back()["exit"], 0);
  const json state = of_kind(lines, "state").at(5);
  EXPECT_EQ(keys_of(state), (std::set<std::string>{
                                "event", "time_s", "phase", "eta_s", "done_share", "leg", "leg_count",
                                "rate_dps", "next_rate_dps", "frames", "frames_per_leg", "repeated", "speeds",
                                "devices", "kept_frames", "kept_bytes", "disk_free_bytes", "stopping"}));
  EXPECT_EQ(keys_of(state["devices"]), (std::set<std::string>{"camera", "gyro", "servo"}));
  const json frame = of_kind(lines, "frame").at(30);
  EXPECT_EQ(keys_of(frame),
            (std::set<std::string>{"event", "index", "time_s", "begin_s", "end_s", "counted", "valid",
                                   "reasons", "excluded", "leg", "run", "commanded_dps", "estimates",
                                   "inference_us", "fresh", "scores"}));
  EXPECT_EQ(keys_of(frame["scores"]),
            (std::set<std::string>{"counted", "excluded", "integrated_s", "gain_mean", "gain_histogram",
                                   "gate_collapsed", "estimators"}));
  EXPECT_EQ(frame["scores"]["gain_histogram"].size(), 20U);
  EXPECT_TRUE(of_kind(lines, "image").empty());
  EXPECT_THAT(outcome.out, Not(HasSubstr("NaN")));
}

TEST_F(Live, NamesItsEstimatorsOnceAndThenWhatEachSays) {
  const auto lines = run(fast).lines();
  const json estimators = of_kind(lines, "hello").at(0)["estimators"];
  ASSERT_GE(estimators.size(), 4U);
  EXPECT_EQ(estimators[0]["name"], "gyro");
  EXPECT_EQ(
      estimators.back(),
      (json{{"name", "cnn-fusion"}, {"title", "network's fusion of camera and gyro"}, {"values", {"gain"}}}));
  const json frame = of_kind(lines, "frame").at(30);
  EXPECT_EQ(frame["estimates"].size(), estimators.size());
  for (const json& estimator : estimators) {
    const std::string name = estimator["name"];
    EXPECT_EQ(keys_of(frame["estimates"][name]),
              (std::set<std::string>{"rate_dps", "rate_sigma_dps", "angle_deg", "angle_sigma_deg", "state",
                                     "reason", "values"}));
    EXPECT_EQ(frame["estimates"][name]["values"].size(), estimator["values"].size());
    EXPECT_TRUE(frame["scores"]["estimators"].contains(name));
  }
}

TEST_F(Live, RunsTheEstimatorsThatAreNamed) {
  const auto lines = run(fast + " --estimators gyro-rest,gyro").lines();
  const json estimators = of_kind(lines, "hello").at(0)["estimators"];
  ASSERT_EQ(estimators.size(), 2U);
  EXPECT_EQ(estimators[0]["name"], "gyro-rest");
  EXPECT_EQ(of_kind(lines, "frame").at(30)["estimates"].size(), 2U);
}

TEST_F(Live, RefusesEstimatorsThatThereAreNotOrThatCannotRun) {
  const Outcome typo = run(fast + " --estimators gyro-rset");
  EXPECT_EQ(typo.code, 2);
  EXPECT_THAT(typo.err, HasSubstr("did you mean \"gyro-rest\"?"));
  const Outcome twice = run(fast + " --estimators gyro,gyro");
  EXPECT_EQ(twice.code, 2);
  EXPECT_THAT(twice.err, HasSubstr("named twice"));
  const Outcome without =
      run("live --world honest --simulated=3 --fast --model none --estimators cnn-fusion");
  EXPECT_EQ(without.code, 2);
  EXPECT_THAT(without.err, AllOf(HasSubstr("needs a network"), HasSubstr("--model FILE")));
}

TEST_F(Live, CountsFramesInLegsAndExcludesTheOthers) {
  const auto frames = frames_of(run(fast));
  ASSERT_GT(frames.size(), 50U);
  const json& scores = frames.back()["scores"];
  EXPECT_GT(scores["counted"], 10);
  EXPECT_GT(scores["excluded"], 10);
  EXPECT_EQ(scores["counted"].get<std::size_t>() + scores["excluded"].get<std::size_t>(), frames.size());
  for (const json& frame : frames)
    if (frame["counted"]) {
      EXPECT_TRUE(frame["estimates"]["cnn-fusion"]["rate_dps"].is_number()) << frame;
    }
}

TEST_F(Live, AReplayWarnsOfAGateThatCollapsesUnlessItsSessionDoesAlready) {
  network::Shape shape;
  shape.frames = 3;
  shape.reduction = 3;
  model::Model open_gate = model::sample_model(shape, 2);
  for (float& weight : open_gate.weights.tensor("gain2.bias")) weight = 30.0F;
  model::write_model(folder() / "open.onnx", open_gate);
  const Outcome live =
      run("live --world honest --simulated=3 --fast --json --record --model model.onnx --plan quick --speeds "
          "60,120 "
          "--frames-per-leg 40");
  ASSERT_TRUE(of_kind(live.lines(), "event").size() > 4) << live.err;
  const auto gate_events = [&](const std::string& model) {
    std::size_t count = 0;
    for (const json& event : of_kind(run("live --no-page --json --speed max --model " + model + " --replay " +
                                         files(".h5").front().string())
                                         .lines(),
                                     "event"))
      count += event["kind"] == "gate" ? 1 : 0;
    return count;
  };
  EXPECT_EQ(gate_events("model.onnx"), 0U);
  EXPECT_EQ(gate_events("open.onnx"), 1U) << "of a model that the session does not know";
  fs::remove(files(".h5").front());
  run("live --world honest --simulated=3 --fast --json --record --model open.onnx --plan quick --speeds "
      "60,120 "
      "--frames-per-leg 40");
  EXPECT_EQ(gate_events("open.onnx"), 1U) << "the session's own, not twice";
}

TEST_F(Live, LeavesNothingOnTheDiskUnlessAsked) {
  ASSERT_EQ(run(fast).code, 0);
  EXPECT_TRUE(files(".h5").empty());
  EXPECT_FALSE(fs::exists(folder() / "recordings"));
}

TEST_F(Live, RecordsASessionWithItsRowsAndReplaysItToTheLastDigit) {
  const Outcome live = run(fast + "--record");
  ASSERT_TRUE(live.code == 0 || live.code == 3) << live.err;
  ASSERT_EQ(files(".h5").size(), 1U);
  const std::vector<json> rows = frames_of(live);
  std::set<std::string> runs;
  for (const char* speed : {"max", "200"}) {
    const Outcome replay = run("live --no-page --json --model model.onnx --speed " + std::string(speed) +
                               " --replay " + files(".h5").front().string());
    ASSERT_EQ(replay.code, 0) << replay.err;
    EXPECT_TRUE(frames_of(replay) == rows) << speed;
    EXPECT_EQ(replay.lines().front()["mode"], "replay");
    EXPECT_TRUE(runs.insert(replay.lines().front()["run"].get<std::string>()).second)
        << "two runs of one name";
  }
}

TEST_F(Live, ASessionKeepsOneRowAFrame) {
  const Outcome live = run(fast + "--record");
  ASSERT_EQ(files(".h5").size(), 1U);
  const session::Session session = session::read_session(files(".h5").front());
  EXPECT_EQ(session.raw.estimates.size(), frames_of(live).size());
  EXPECT_EQ(session.raw.header.live_model.name, "model.onnx");
  EXPECT_EQ(session.raw.header.live_model.frames, 3);
}

TEST_F(Live, WorksWithoutANetworkAndSaysSo) {
  const Outcome outcome = run("live --world honest --simulated=3 --fast --model none " + plan);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("no network (--model FILE)"), HasSubstr("RMSE in deg/s")));
}

TEST_F(Live, SaysSoWhereTheCameraSendsOtherFramesThanTheNetworkHasLearnt) {
  const std::string rig = "live --world honest --simulated=3 --fast " + plan;
  EXPECT_THAT(run(rig + " --simulated-camera full").out, HasSubstr("the camera sends full frames"));
  EXPECT_THAT(run(rig).out, Not(HasSubstr("full frames")));
}

TEST_F(Live, TakesTheGeneralModelByItself) {
  const Outcome outcome = run("live --world honest --simulated=3 --fast --json " + plan);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.lines().front()["model"]["name"], "general-55.onnx");
  EXPECT_EQ(outcome.lines().front()["model"]["turned"], 8);
  const Outcome one = run("live --world honest --simulated=3 --fast --json --turned 1 " + plan);
  EXPECT_EQ(one.lines().front()["model"]["turned"], 1);
}

TEST_F(Live, ShowsTheEstimatorsThatFitInTheTerminal) {
  setenv("COLUMNS", "80", 1);
  const Outcome outcome = run("live --world honest --simulated=3 --fast " + plan);
  std::istringstream lines(outcome.out.substr(outcome.out.find("not shown here")));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80U) << line;
  EXPECT_THAT(outcome.out, HasSubstr("cnn-fusion    Kg  counted\n"));
}

TEST_F(Live, RefusesWhatIsNoModel) {
  std::ofstream(folder() / "no.onnx") << "this is no model";
  EXPECT_EQ(run("live --world honest --simulated=3 --fast --model no.onnx").code, 8);
  EXPECT_EQ(run("live --world honest --simulated=3 --fast --model nowhere.onnx").code, 2);
}

TEST_F(Live, RefusesWordsThatContradictEachOther) {
  for (const char* words :
       {"--world honest --simulated=3 --fast --page", "--fast", "--simulated=3 --speed 2",
        "--simulated=3 --replay x.h5", "--replay x.h5 --record", "--replay x.h5 --speed quick",
        "--replay x.h5 --speed 0", "--replay x.h5 --speed 1e-300", "--simulated=3 --fast --loop",
        "--simulated=3 --tui --json", "--replay x.h5 --control", "--simulated=3 --no-page --control"})
    EXPECT_EQ(run(std::string("live ") + words).code, 2) << words;
}

TEST_F(Live, RefusesWordsThatWouldDoNothing) {
  const std::string replay = "live --replay " + record_briefly().string() + " --no-page --speed max ";
  ASSERT_EQ(run(replay).code, 0);
  for (const char* word : {"--plan quick", "--environment garden", "--fast", "--loop", "--simulated-gyro raw",
                           "--servo /dev/null", "--camera-rate 8", "--speeds 60", "--output x", "--licence x",
                           "--no-preflight", "--replug-patience 5", "--world hard"}) {
    const Outcome outcome = run(replay + word);
    EXPECT_EQ(outcome.code, 2) << word;
    EXPECT_THAT(outcome.err, HasSubstr(std::string(word).substr(0, std::string(word).find(' '))));
  }
  for (const char* words : {"live --world honest --simulated=3 --fast --output x",
                            "live --world honest --simulated=3 --fast --licence x",
                            "live --world honest --simulated=3 --fast --page-port 0",
                            "live --world honest --simulated=3 --fast --new-token",
                            "live --world honest --simulated=3 --no-page --page-port 0",
                            "live --world honest --simulated=3 --no-page --new-token",
                            "live --world honest --simulated=3 --fast --model none --precision fp16",
                            "live --world honest --simulated=3 --fast --model none --turned 8",
                            "record --world honest --simulated=3 --fast --environment garden --page-port 0",
                            "record --world honest --simulated=3 --fast --environment garden --new-token"})
    EXPECT_EQ(run(words).code, 2) << words;
}

TEST_F(Live, SaysWhyAFrameIsExcluded) {
  int windows = 0;
  for (const json& frame : frames_of(run(fast))) {
    EXPECT_EQ(frame["excluded"].is_null(), frame["counted"].get<bool>()) << frame;
    if (frame["counted"]) continue;
    if (!frame["reasons"].empty()) {
      EXPECT_THAT(frame["excluded"].get<std::string>(), HasSubstr(frame["reasons"][0].get<std::string>()));
    } else if (frame["valid"]) {
      EXPECT_EQ(frame["excluded"], "window begins in another run");
      ++windows;
    }
  }
  EXPECT_GT(windows, 0);
}

TEST_F(Live, EndsWithEndedWhateverHappens) {
  const Outcome outcome =
      run("live --servo /dev/nope --gyro /dev/nope2 --camera /dev/nope3 --json --no-page");
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  ASSERT_FALSE(outcome.lines().empty());
  EXPECT_EQ(outcome.lines().back()["event"], "ended");
  EXPECT_EQ(outcome.lines().back()["exit"], 4);
  EXPECT_THAT(outcome.lines().back()["message"].get<std::string>(), HasSubstr("/dev/nope"));
  EXPECT_TRUE(of_kind(outcome.lines(), "error").empty());
  EXPECT_THAT(outcome.err, HasSubstr("/dev/nope"));
  EXPECT_THAT(run("live --servo /dev/nope --gyro /dev/nope2 --camera /dev/nope3 --no-page").out,
              Not(HasSubstr("RMSE")))
      << "no figures without a frame";
}

TEST_F(Live, RunsItsNetworkInHalfPrecisionAndSaysSo) {
  const Outcome half = run(fast + "--record --precision fp16");
  ASSERT_TRUE(half.code == 0 || half.code == 3) << half.err;
  EXPECT_EQ(half.lines().front()["model"]["precision"], "fp16");
  ASSERT_EQ(files(".h5").size(), 1U);
  const std::string path = files(".h5").front().string();
  EXPECT_EQ(session::read_session(path).raw.header.live_model.precision, "fp16");
  EXPECT_TRUE(
      frames_of(run("live --no-page --json --speed max --model model.onnx --precision fp16 --replay " +
                    path)) == frames_of(half));
  EXPECT_FALSE(frames_of(run("live --no-page --json --speed max --model model.onnx --replay " + path)) ==
               frames_of(half));
  EXPECT_THAT(run("live --no-page --speed max --model model.onnx --precision fp16 --replay " + path).out,
              HasSubstr("fp16 weights"));
}

/// A pipe of one page in the place of background_out.txt, which nobody reads until somebody does.
class UnreadOutput {
 public:
  explicit UnreadOutput(const fs::path& path) : path_(path) {
    EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
    pipe_ = open(path.c_str(), O_RDWR | O_NONBLOCK);
    EXPECT_GE(fcntl(pipe_, F_SETPIPE_SZ, 4096), 4096);
  }
  ~UnreadOutput() { close(pipe_); }
  UnreadOutput(const UnreadOutput&) = delete;
  UnreadOutput& operator=(const UnreadOutput&) = delete;

  /// What is there now.
  std::string read_some() const {
    std::string text;
    std::array<char, 4096> part{};
    for (ssize_t count = 0; (count = ::read(pipe_, part.data(), part.size())) > 0;)
      text.append(part.data(), static_cast<std::size_t>(count));
    return text;
  }
  void unlink() const { fs::remove(path_); }

 private:
  fs::path path_;
  int pipe_ = -1;
};

TEST_F(Live, DrivesOnWhenNobodyReadsItsOutput) {
  const UnreadOutput output(folder() / "background_out.txt");
  ASSERT_EQ(setenv("XDG_STATE_HOME", folder().c_str(), 1), 0);
  const pid_t process = start({"live", "--world", "honest", "--simulated=3", "--loop", "--model",
                               "model.onnx", "--page-port", "0", "--json", "--record", "-o", "kept"});
  unsetenv("XDG_STATE_HOME");
  std::this_thread::sleep_for(std::chrono::seconds(12));  // more than 128 kB
  const json address = json::parse(file_text(folder() / "thermorig" / "page.json"));
  web::PageClient page(address["port"].get<std::uint16_t>());
  EXPECT_EQ(page.post("/stop", address["token"], "{}").status, 204);
  std::string text;
  const auto is_ended = [&] {
    text += output.read_some();
    return text.find("\"ended\"") != std::string::npos;
  };
  EXPECT_TRUE(comes_true(is_ended));
  output.unlink();
  const Outcome outcome = wait(process);
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  ASSERT_EQ(files(".h5").size(), 1U);
  const RawRecording raw = session::read_session(files(".h5").front()).raw;
  EXPECT_GT(to_s(raw.end_time - raw.header.time_reference), 9.0) << "it went on";
  EXPECT_FALSE(raw.legs.empty());
  for (const RecordingEvent& event : raw.events)
    EXPECT_THAT(event.message, Not(HasSubstr("watchdog"))) << "the servo was served all the time";
  const auto stopped = std::find_if(raw.events.begin(), raw.events.end(),
                                    [](const auto& event) { return event.kind == EventKind::stopped; });
  ASSERT_NE(stopped, raw.events.end());
  EXPECT_THAT(stopped->message, HasSubstr("page"));
  EXPECT_LT(to_s(raw.end_time - stopped->time), 2.0) << "it came to rest and ended";
  const std::vector<json> lines = Outcome{0, text, ""}.lines();
  EXPECT_EQ(lines.front()["plan"]["repeats"], true);
  for (const json& state : of_kind(lines, "state")) EXPECT_TRUE(state["eta_s"].is_null());
  std::size_t frames = of_kind(lines, "frame").size();
  EXPECT_GE(of_kind(lines, "dropped").size(), 1U);
  for (const json& dropped : of_kind(lines, "dropped")) frames += dropped["frames"].get<std::size_t>();
  EXPECT_EQ(frames, raw.estimates.size());
}

TEST_F(Live, ASessionDoesNotSteerTheTerminal) {
  session::Session session = session::read_session(record_briefly());
  RecordingHeader& header = session.raw.header;
  header.plan_name = header.simulation =
      "tidy\x1b]0;title\x07\xc2\x9b"
      "2J";
  for (RecordingEvent& event : session.raw.events) event.message = "said\x1b[2J";
  session::write_session(folder() / "hostile.h5", session);
  const Outcome lines = run("live --no-page --speed max --replay hostile.h5");
  ASSERT_EQ(lines.code, 0) << lines.err;
  EXPECT_THAT(lines.out, HasSubstr("tidy\\u{1B}]0;title\\u{07}\\u{9B}2J"));
  EXPECT_THAT(lines.out, HasSubstr("said\\u{1B}[2J"));
  for (const char* part : {"\x1b", "\x07", "\xc2\x9b"}) EXPECT_THAT(lines.out, Not(HasSubstr(part)));
}

TEST_F(Live, TellsOfAStateFileThatWasNotUsed) {
  const fs::path file = folder() / "thermorig" / "page.json";
  fs::create_directory(file.parent_path());
  std::ofstream(file) << "{}";
  fs::permissions(file, fs::perms::owner_read | fs::perms::others_read);
  const fs::path session = record_briefly();
  const std::string words = "live --page-port 0 --speed max --replay " + session.string();
  ASSERT_EQ(setenv("XDG_STATE_HOME", folder().c_str(), 1), 0);
  const Outcome lines = run(words);
  fs::permissions(file, fs::perms::owner_read | fs::perms::others_read);
  const Outcome as_json = run(words + " --json");
  unsetenv("XDG_STATE_HOME");
  EXPECT_THAT(lines.out, HasSubstr("this user alone may read and write")) << lines.err;
  EXPECT_THAT(as_json.err, HasSubstr("this user alone may read and write"));
  EXPECT_EQ(as_json.lines().front()["event"], "hello");
}

TEST_F(Live, PutsNoTokenIntoAFileThatOthersMayRead) {
  const fs::path session = record_briefly();
  const std::string words = "live --page-port 0 --speed max --replay " + session.string();
  constexpr auto open_mode = fs::perms::owner_read | fs::perms::owner_write | fs::perms::others_read;
  constexpr auto own_mode = fs::perms::owner_read | fs::perms::owner_write;
  const fs::path out = folder() / "out.txt", err = folder() / "err.txt";
  run("--version");  // makes both
  for (const fs::path& file : {out, err}) fs::permissions(file, open_mode);
  ASSERT_EQ(setenv("XDG_STATE_HOME", folder().c_str(), 1), 0);
  const Outcome both_open = run(words);
  const Outcome as_json = run(words + " --json");
  fs::permissions(err, own_mode);
  const Outcome own_errors = run(words);
  fs::permissions(out, own_mode);
  const Outcome own_output = run(words);
  const Outcome pipe = run(words + " | cat");
  unsetenv("XDG_STATE_HOME");
  const fs::path state = folder() / "thermorig" / "page.json";
  const std::string url = json::parse(file_text(state)).value("url", "");
  const std::string token = url.substr(url.find("#t=") + 3);
  ASSERT_EQ(token.size(), 32U) << url;
  for (const std::string& text : {both_open.out, both_open.err, as_json.out, as_json.err, own_errors.out})
    EXPECT_THAT(text, Not(HasSubstr(token)));
  for (const std::string& text : {both_open.out, as_json.err}) {
    EXPECT_THAT(text, HasSubstr("page  http://127.0.0.1:"));
    EXPECT_THAT(text, HasSubstr(state.string())) << "where the address is";
  }
  EXPECT_THAT(own_errors.out,
              HasSubstr("the address with its token is on standard error, and under \"url\" in "));
  for (const std::string& text : {own_errors.err, own_output.out, pipe.out})
    EXPECT_THAT(text, HasSubstr("/#t=" + token));
}

TEST_F(Live, DrawsPlainLinesWithoutATerminalAndSaysSo) {
  const Outcome outcome = run("live --world honest --simulated=3 --fast --tui --model model.onnx " + plan);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("--tui needs a terminal"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("\x1b[")));
}

TEST_F(Live, DrawsTheImageOnATerminalAndLeavesItAsItWas) {
  const std::string words =
      "live --page-port 0 --tui --model model.onnx --speed max --replay " + record_briefly().string();
  const std::string home = "XDG_STATE_HOME=" + folder().string() + " ";
  const Outcome colour = run_on_terminal(home + "COLORTERM=truecolor TERM=xterm", words);
  EXPECT_THAT(colour.out, HasSubstr("\u2580"));
  EXPECT_THAT(colour.out, HasSubstr("\x1b[38;2;"));
  EXPECT_EQ(colour.out.find("\x1b[?"), std::string::npos);  // no mode was changed
  EXPECT_GT(colour.out.rfind("\x1b[0m"), colour.out.rfind("\x1b[38;2;"));
  EXPECT_THAT(colour.out, HasSubstr("/#t=")) << "the page's address, with its token";
  const Outcome plain = run_on_terminal(home + "NO_COLOR=1 TERM=xterm", words);
  EXPECT_THAT(plain.out, Not(HasSubstr("\x1b[")));
  EXPECT_THAT(plain.out, HasSubstr("frames counted"));
}

TEST_F(Live, KeepsItsSessionWhenTheReaderOfItsOutputGoesAway) {
  const std::string command =
      "cd '" + folder().string() +
      "' && '" THERMORIG_PROGRAM
      "' live --world honest --simulated=3 --fast --json --record -o kept 2>errors.txt | head -n 1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::vector<std::string> kinds;
  for (const auto& entry : std::filesystem::directory_iterator(folder() / "kept" / "laboratory"))
    kinds.push_back(entry.path().extension());
  EXPECT_THAT(kinds, testing::Contains(".h5"));
  EXPECT_THAT(kinds, Not(testing::Contains(".journal")));
  std::ifstream errors(folder() / "errors.txt");
  EXPECT_THAT(std::string(std::istreambuf_iterator<char>(errors), {}),
              HasSubstr("thermorig inspect kept/laboratory/"))
      << "nobody read where it is";
}

TEST_F(Live, StopsTheServoInALegOnInterruptAndSaysHowItEnded) {
  const pid_t process =
      start({"live", "--world", "honest", "--simulated=3", "--fast", "--plan", "paper", "--frames-per-leg",
             "1000", "--model", "model.onnx", "--json"});  // in virtual time: hours
  const auto is_in_leg = [&] {
    return file_text(folder() / "background_out.txt").find("leg_start") != std::string::npos;
  };
  EXPECT_TRUE(comes_true(is_in_leg));
  kill(process, SIGINT);
  const Outcome outcome = wait(process);
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  const std::vector<json> lines = outcome.lines();
  EXPECT_EQ(lines.back()["event"], "ended");
  EXPECT_EQ(lines.back()["exit"], 130);
  EXPECT_EQ(lines.back()["message"], "stopped on request");
  EXPECT_EQ(of_kind(lines, "state").back()["phase"], "done");
  EXPECT_FALSE(fs::exists(folder() / "recordings"));
}

class LiveMapFile : public Live {
 protected:
  /// What a run with kitchen.map said of it.
  std::vector<std::string> told_with(const std::string& words) {
    const Outcome outcome =
        run("live --world honest --fast --json --estimators odometer --environment kitchen "
            "--plan quick --map kitchen.map " +
            words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    std::vector<std::string> told;
    for (const json& event : of_kind(outcome.lines(), "event"))
      if (event["message"].get<std::string>().starts_with("map ")) told.push_back(event["message"]);
    return told;
  }
};

TEST_F(LiveMapFile, IsWrittenAtTheEndAndBegunWithByTheNextRun) {
  EXPECT_THAT(told_with("--simulated=4"),
              testing::ElementsAre(HasSubstr("new; written at the end"), HasSubstr("written")));
  const Outcome described = run("inspect kitchen.map");
  EXPECT_EQ(described.code, 0) << described.err;
  EXPECT_THAT(described.out, HasSubstr("SIMULATED"));
  EXPECT_THAT(described.out, HasSubstr("55 degrees, mirrored"));
  EXPECT_THAT(told_with("--simulated=4 --speeds 60,120"),
              testing::ElementsAre(HasSubstr("SIMULATED"), HasSubstr("recognised"), HasSubstr("written")));
}

TEST_F(LiveMapFile, IsLeftAsItIsInAnotherRoom) {
  told_with("--simulated=4");
  const std::string before = file_text(folder() / "kitchen.map");
  EXPECT_THAT(told_with("--simulated=5"), testing::Contains(HasSubstr("map unchanged")));
  EXPECT_EQ(file_text(folder() / "kitchen.map"), before);
}

TEST_F(LiveMapFile, IsRefusedWhereItCannotBeBegunWith) {
  std::ofstream(folder() / "kitchen.map") << "THRMAP01 and no more";
  EXPECT_EQ(run("live --simulated=4 --fast --map kitchen.map").code, 8);
  EXPECT_EQ(run("live --simulated=4 --fast --map nowhere/kitchen.map").code, 2);
  const Outcome without = run("live --simulated=4 --fast --estimators gyro --map new.map");
  EXPECT_EQ(without.code, 2);
  EXPECT_THAT(without.err, HasSubstr("the odometer"));
}

TEST_F(Live, MarksRatesThatTheirEstimatorDoesNotTrustYet) {
  const Outcome outcome =
      run("live --world honest --simulated=3 --fast --estimators gyro,odometer --plan quick --speeds 60 "
          "--frames-per-leg 12");
  EXPECT_THAT(outcome.out, HasSubstr("?: not reliable (yet)"));
  EXPECT_THAT(outcome.out, testing::ContainsRegex(" [+-][0-9.]+ +[+-][0-9.]+[?] ")) << "the odometer starts";
  EXPECT_THAT(outcome.out, Not(testing::ContainsRegex("[?] +[+-]"))) << "nobody doubts the gyro";
}

/// The odometer compares them in its start, which takes half a minute of motion.
TEST_F(Live, SaysInWhichOrderTheCameraReadsItsRowsAndByWhichMargin) {
  const Outcome live = run(
      "live --simulated=6 --world honest --fast --json --record --estimators odometer --environment kitchen "
      "--plan quick --speeds 40,90,150 --frames-per-leg 60");
  ASSERT_EQ(live.code, 0) << live.err;
  std::string told;
  for (const json& event : of_kind(live.lines(), "event"))
    if (event["message"].get<std::string>().starts_with("camera rows: ")) told = event["message"];
  EXPECT_THAT(told, testing::MatchesRegex("camera rows: read .*, margin [0-9]+ .difference of log.*"));
  const std::string session = live.lines().back()["session"];
  const std::string said = told.substr(std::string("camera rows: ").size());
  EXPECT_THAT(run("inspect " + session).out, HasSubstr("camera rows  " + said));
  EXPECT_EQ(run("inspect --json " + session).lines()[0][0]["camera_rows"], said);
}

}  // namespace
}  // namespace thermorig::tests
