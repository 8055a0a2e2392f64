// SPDX-License-Identifier: MIT
#include "thermorig/learning/training/run_folder.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <limits>

#include "thermorig/core/error.h"
#include "trained.h"

namespace thermorig::training {
namespace {

namespace fs = std::filesystem;

class RunFolderTest : public testing::Test {
 protected:
  RunFolderTest() {
    std::string name = (fs::temp_directory_path() / "thermorig_run_XXXXXX").string();
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
    description_.config = small_config(4);
    description_.data = {{"garden_acq-01", "aa"}, {"garden_acq-02", "bb"}};
    description_.instruction_set = "baseline";
    description_.producer = "thermorig test";
  }
  ~RunFolderTest() override { fs::remove_all(folder_); }

  fs::path run() const { return folder_ / "model.run"; }

  /// After two epochs of a training.
  Checkpoint checkpoint() const {
    Checkpoint last;
    Observer observer;
    observer.epoch = [&](const EpochReport&, const Checkpoint& next) { last = next; };
    TrainingConfig config = description_.config;
    config.epochs = 2;
    trained(config, small_data(), observer);
    return last;
  }

  std::string text(const char* name) const {
    std::ifstream file(run() / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  void overwrite(const char* name, const std::string& bytes) const {
    std::ofstream(run() / name, std::ios::binary | std::ios::trunc) << bytes;
  }

  Error refusal_to_reopen() const {
    try {
      RunFolder::reopen(run(), description_);
    } catch (const Error& error) {
      return error;
    }
    return {ExitCode::ok, "nothing was refused", "", ""};
  }

  fs::path folder_;
  RunDescription description_;
};

TEST_F(RunFolderTest, GivesBackTheCheckpointBitForBit) {
  const Checkpoint kept = checkpoint();
  RunFolder::create(run(), description_).save(kept, 12.5);
  const RunFolder reopened = RunFolder::reopen(run(), description_);
  ASSERT_TRUE(reopened.checkpoint());
  EXPECT_EQ(reopened.checkpoint()->weights, kept.weights);
  EXPECT_EQ(reopened.checkpoint()->kept, kept.kept);
  EXPECT_EQ(reopened.checkpoint()->optimiser, kept.optimiser);
  EXPECT_EQ(reopened.checkpoint()->epoch, 2);
  EXPECT_EQ(reopened.checkpoint()->epoch_kept, kept.epoch_kept);
  ASSERT_EQ(reopened.checkpoint()->epochs.size(), 2U);
  EXPECT_EQ(reopened.checkpoint()->epochs[1].loss, kept.epochs[1].loss);
  EXPECT_EQ(reopened.seconds(), 12.5);
}

TEST_F(RunFolderTest, HasNoCheckpointBeforeTheFirstEpoch) {
  RunFolder::create(run(), description_);
  EXPECT_FALSE(RunFolder::reopen(run(), description_).checkpoint());
}

TEST_F(RunFolderTest, HasALineOfMetricsAnEpoch) {
  RunFolder folder = RunFolder::create(run(), description_);
  folder.save(checkpoint(), 3.0);
  const std::string metrics = text("metrics.ndjson");
  EXPECT_EQ(std::count(metrics.begin(), metrics.end(), '\n'), 2);
  EXPECT_NE(metrics.find("\"training_rmse_dps\""), std::string::npos);
}

TEST_F(RunFolderTest, IsNeverMadeOverAnother) {
  RunFolder::create(run(), description_);
  try {
    RunFolder::create(run(), description_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
    EXPECT_NE(error.advice().find("--resume"), std::string::npos);
  }
}

TEST_F(RunFolderTest, IsOfOneProgramAtATime) {
  std::optional<RunFolder> first(RunFolder::create(run(), description_));
  const Error error = refusal_to_reopen();
  EXPECT_EQ(error.code(), ExitCode::no_permission);
  EXPECT_EQ(error.what_happened(), "this process trains in this folder");
  EXPECT_EQ(error.where(), run().string());
  first.reset();
  EXPECT_EQ(refusal_to_reopen().code(), ExitCode::ok);
}

TEST_F(RunFolderTest, SaysWhichSettingsDiffer) {
  RunFolder::create(run(), description_);
  description_.config.epochs = 40;
  description_.config.shape.frames = 3;
  const Error error = refusal_to_reopen();
  EXPECT_EQ(error.code(), ExitCode::bad_usage);
  EXPECT_NE(error.what_happened().find("epochs (4, now 40)"), std::string::npos) << error.what_happened();
  EXPECT_NE(error.what_happened().find("frames (2, now 3)"), std::string::npos) << error.what_happened();
}

TEST_F(RunFolderTest, SaysThatTheDataDiffer) {
  RunFolder::create(run(), description_);
  description_.data[1].hash = "cc";
  EXPECT_NE(refusal_to_reopen().what_happened().find("the data (other recordings"), std::string::npos);
  description_.data.pop_back();
  EXPECT_NE(refusal_to_reopen().what_happened().find("2 acquisitions, now 1"), std::string::npos);
}

TEST_F(RunFolderTest, SaysThatAnotherLabelIsLearntAndNotThatTheDataDiffer) {
  RunFolder::create(run(), description_);
  description_.label = Label::shaft;
  description_.data[0].hash = "cc";
  const std::string refusal = refusal_to_reopen().what_happened();
  EXPECT_NE(refusal.find("label (\"commanded\", now \"shaft\")"), std::string::npos) << refusal;
  EXPECT_EQ(refusal.find("the data"), std::string::npos) << refusal;
}

TEST_F(RunFolderTest, SaysThatTheInstructionSetDiffers) {
  RunFolder::create(run(), description_);
  description_.instruction_set = "AVX2";
  EXPECT_NE(refusal_to_reopen().what_happened().find("instruction_set"), std::string::npos);
}

TEST_F(RunFolderTest, ThatIsNotThereIsRefused) {
  EXPECT_EQ(refusal_to_reopen().code(), ExitCode::bad_usage);
}

TEST_F(RunFolderTest, WithADescriptionThatIsNoneIsRefused) {
  RunFolder::create(run(), description_);
  const std::string deep = std::string(200'000, '[') + std::string(200'000, ']');
  for (const std::string& bytes : {std::string(), std::string("[1,2"), std::string(100'000, '['),
                                   "{\"settings\": {\"epochs\": " + deep + "}, \"data\": " + deep + "}",
                                   std::string("[]"), std::string("{\"settings\": 3, \"data\": {}}"),
                                   std::string("\xFF\xFE\x00", 3), std::string(5 << 20, ' ')}) {
    overwrite("run.json", bytes);
    EXPECT_NE(refusal_to_reopen().code(), ExitCode::ok) << bytes.substr(0, 20);
  }
}

TEST_F(RunFolderTest, WithADamagedCheckpointIsRefused) {
  RunFolder::create(run(), description_).save(checkpoint(), 1.0);
  const std::string whole = text("checkpoint.bin");
  ASSERT_GT(whole.size(), 10'000U);
  for (std::size_t place = 0; place < whole.size(); place += place < 64 ? 1 : whole.size() / 40) {
    std::string damaged = whole;
    damaged[place] = static_cast<char>(damaged[place] ^ 0x40);
    overwrite("checkpoint.bin", damaged);
    EXPECT_EQ(refusal_to_reopen().code(), ExitCode::not_a_session) << place;
  }
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{7}, std::size_t{30}, whole.size() / 2, whole.size() - 1}) {
    overwrite("checkpoint.bin", whole.substr(0, size));
    EXPECT_EQ(refusal_to_reopen().code(), ExitCode::not_a_session) << size;
  }
  overwrite("checkpoint.bin", whole + "more");
  EXPECT_EQ(refusal_to_reopen().code(), ExitCode::not_a_session);
  overwrite("checkpoint.bin", std::string(whole.size() * 3, 'x'));
  EXPECT_EQ(refusal_to_reopen().code(), ExitCode::not_a_session);
}

TEST_F(RunFolderTest, WithWeightsThatAreNoNumbersIsRefused) {
  Checkpoint broken = checkpoint();
  broken.weights.values[5] = std::numeric_limits<float>::quiet_NaN();
  RunFolder::create(run(), description_).save(broken, 1.0);
  EXPECT_EQ(refusal_to_reopen().code(), ExitCode::not_a_session);
}

TEST_F(RunFolderTest, OnAFullDiskKeepsTheCheckpointBefore) {
  RunFolder folder = RunFolder::create(run(), description_);
  Checkpoint kept = checkpoint();
  folder.save(kept, 1.0);
  const std::string before = text("checkpoint.bin");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  rlimit small = limit;
  small.rlim_cur = 1000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  ExitCode code = ExitCode::ok;
  try {
    folder.save(kept, 2.0);
  } catch (const Error& error) {
    code = error.code();
  }
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  EXPECT_EQ(code, ExitCode::storage);
  EXPECT_EQ(text("checkpoint.bin"), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(run()), fs::directory_iterator()), 3);
}

TEST_F(RunFolderTest, WhereNothingCanBeWrittenIsAMatterOfStorage) {
  std::ofstream(folder_ / "file") << "in the way";
  for (const fs::path& path : {folder_ / "file" / "model.run", fs::path("/proc/model.run")}) {
    try {
      RunFolder::create(path, description_);
      FAIL() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::storage);
    }
  }
}

}  // namespace
}  // namespace thermorig::training
