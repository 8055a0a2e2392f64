// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "../session/synthetic_session.h"
#include "../session/temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/dataset/dataset.h"

namespace thermorig::dataset {
namespace {

namespace fs = std::filesystem;

class Sessions : public session::InTemporaryFolder {
 protected:
  static session::Session made(const std::string& environment, int number, std::uint32_t seed) {
    session::Session session = session::SyntheticSession(20, seed).take();
    session.raw.header.environment = environment;
    session.raw.header.acquisition = number;
    return session;
  }

  fs::path write(const std::string& name, const session::Session& session) {
    fs::create_directories(path(name).parent_path());
    session::write_session(path(name), session);
    return path(name);
  }

  /// A session file; recordings of other seeds differ.
  fs::path write(const std::string& name, const std::string& environment, int number, std::uint32_t seed) {
    return write(name, made(environment, number, seed));
  }

  template <typename Action>
  static Error refusal(Action action) {
    try {
      action();
    } catch (const Error& error) {
      return error;
    }
    return {ExitCode::ok, "nothing was refused", "", ""};
  }
};

TEST_F(Sessions, AreFoundInFoldersToAnyDepthEachOnce) {
  const fs::path kitchen = write("kitchen/a.h5", "kitchen", 1, 1);
  const fs::path garden = write("garden/deep/b.h5", "garden", 1, 2);
  write_file(path("notes.txt"), {'a'});
  fs::create_symlink(kitchen, path("zagain.h5"));
  EXPECT_EQ(find_sessions({path("garden"), kitchen, path("kitchen")}),
            (std::vector<fs::path>{garden, kitchen}));
  EXPECT_EQ(find_sessions({folder_}), (std::vector<fs::path>{garden, kitchen}));
}

TEST_F(Sessions, ThatAreNotThereAreRefused) {
  EXPECT_EQ(refusal([&] { find_sessions({path("nowhere")}); }).code(), ExitCode::bad_usage);
  EXPECT_EQ(refusal([&] { find_sessions({folder_}); }).code(), ExitCode::bad_usage);
}

TEST_F(Sessions, ThatAreStillAJournalAreToBeRecovered) {
  write_file(path("garden_acq-01.journal"), {'a'});
  const Error error = refusal([&] { find_sessions({folder_}); });
  EXPECT_EQ(error.advice(), "thermorig recover " + path("garden_acq-01.journal").string());
  const fs::path session = write("a.h5", "garden", 2, 1);
  EXPECT_EQ(find_sessions({folder_}), (std::vector<fs::path>{session}));
}

TEST_F(Sessions, AreSortedByEnvironmentAndNumberNotByFile) {
  write("a.h5", "kitchen", 1, 1);
  write("b.h5", "garden", 10, 2);
  write("c.h5", "garden", 9, 3);
  std::size_t calls = 0, last = 0;
  const auto acquisitions =
      read_acquisitions(find_sessions({folder_}), [&](std::size_t done, std::size_t all) {
        ++calls;
        last = done;
        EXPECT_EQ(all, 3U);
      }).acquisitions;
  ASSERT_EQ(acquisitions.size(), 3U);
  EXPECT_EQ(acquisitions[0].name, "garden_acq-09");
  EXPECT_EQ(acquisitions[1].name, "garden_acq-10");
  EXPECT_EQ(acquisitions[2].name, "kitchen_acq-01");
  EXPECT_EQ(calls, 3U);
  EXPECT_EQ(last, 3U);
  EXPECT_EQ(read_acquisition(path("b.h5")).hash, acquisitions[1].hash);
}

TEST_F(Sessions, HaveEstimatesOnceTheyAreWanted) {
  write("a.h5", "kitchen", 2, 1);
  write("b.h5", "kitchen", 1, 2);
  Acquisitions read = read_acquisitions(find_sessions({folder_}));
  EXPECT_TRUE(read.acquisitions[0].rates.empty());
  std::size_t calls = 0;
  run_estimators_over(
      read, [](const network::Acquisition& acquisition) { return acquisition.number == 2; }, 0,
      [&](std::size_t done, std::size_t all) { calls += done == 1 && all == 1 ? 1 : 100; });
  EXPECT_EQ(calls, 1U);
  EXPECT_TRUE(read.acquisitions[0].rates.empty());
  network::Acquisition itself = read_acquisition(path("a.h5"));
  add_estimates(itself, session::read_session(path("a.h5")));
  ASSERT_EQ(read.acquisitions[1].rates.size(), itself.rates.size());
  EXPECT_EQ(read.acquisitions[1].rates[0].name, itself.rates[0].name);
}

TEST_F(Sessions, WhoseFileIsAnotherOneByNowGetNoEstimates) {
  write("a.h5", "kitchen", 1, 1);
  Acquisitions read = read_acquisitions(find_sessions({folder_}));
  fs::remove(path("a.h5"));
  write("a.h5", "kitchen", 1, 2);
  const Error error =
      refusal([&] { run_estimators_over(read, [](const network::Acquisition&) { return true; }); });
  EXPECT_EQ(error.code(), ExitCode::not_a_session);
  EXPECT_EQ(error.where(), path("a.h5").string());
}

TEST_F(Sessions, AreReadWithTheLabelThatIsLearnt) {
  write("a.h5", "kitchen", 1, 1);
  const auto read = read_acquisitions({path("a.h5")}, {}, Label::corrected).acquisitions;
  EXPECT_EQ(read.at(0).label, Label::corrected);
  EXPECT_EQ(read.at(0).hash, read_acquisition(path("a.h5")).hash);
}

TEST_F(Sessions, ThatHoldTheSameRecordingAreRefused) {
  write("a.h5", "kitchen", 1, 1);
  write("copy.h5", "kitchen", 2, 1);
  const Error error = refusal([&] { read_acquisitions(find_sessions({folder_})); });
  EXPECT_EQ(error.code(), ExitCode::not_a_session);
  EXPECT_NE(error.what_happened().find("a.h5"), std::string::npos);
}

TEST_F(Sessions, TheFirstDamagedOneIsNamed) {
  write("a.h5", "kitchen", 1, 1);
  write("b.h5", "kitchen", 2, 2);
  for (const char* name : {"b.h5", "c.h5"}) {
    std::vector<char> bytes(5000, 'x');
    fs::remove(path(name));
    write_file(path(name), bytes);
  }
  for (int trial = 0; trial < 5; ++trial) {
    const Error error = refusal([&] { read_acquisitions(find_sessions({folder_})); });
    EXPECT_EQ(error.code(), ExitCode::not_a_session);
    EXPECT_EQ(error.where(), path("b.h5").string());
  }
}

TEST_F(Sessions, OfCalibrationsAreLeftOut) {
  session::Session calibration = made("calibration", 1, 1);
  calibration.raw.header.plan_toml = "name = \"calibrate-bias\"\nfor_calibration = true\nseed = 1\n";
  const fs::path left_out = write("a.h5", calibration);
  write("b.h5", made("calibration", 2, 2));  // the name of a place says nothing
  write("copy.h5", calibration);
  const Acquisitions read = read_acquisitions(find_sessions({folder_}));
  EXPECT_EQ(read.for_calibration, (std::vector<fs::path>{left_out, path("copy.h5")}));
  ASSERT_EQ(read.acquisitions.size(), 1U);
  EXPECT_EQ(read.acquisitions[0].name, "calibration_acq-02");
}

TEST_F(Sessions, OfABadVerdictAreNamedWithItsReasons) {
  session::Session good = made("garden", 1, 1), bad = made("garden", 2, 2);
  for (session::Session* session : {&good, &bad}) {
    for (const Device device : all_devices) session->counters[device] = {.messages = 1000};
    for (ClockReport* clock : {&session->sync.clock[Device::camera], &session->sync.clock[Device::gyro],
                               &session->sync.clock[Device::servo]})
      clock->uncertainty_us = 100.0;
    for (TimedFrame& frame : session->frames) frame.missing_before = 0;
    session->sync.servo.fitted = false;
  }
  bad.counters[Device::gyro].messages = 0;
  ASSERT_NE(session::quality_of(good).verdict, "bad") << session::quality_of(good).verdict_reasons.front();
  write("a.h5", good);
  const fs::path file = write("b.h5", bad);
  const Acquisitions read = read_acquisitions(find_sessions({folder_}));
  EXPECT_EQ(read.acquisitions.size(), 2U);
  ASSERT_EQ(read.bad.size(), 1U);
  EXPECT_EQ(read.bad[0].file, file);
  EXPECT_EQ(read.bad[0].reasons, session::quality_of(bad).verdict_reasons);
}

TEST_F(Sessions, CutShortAreRefused) {
  const fs::path file = write("a.h5", "kitchen", 1, 1);
  std::vector<char> bytes = read_file(file);
  bytes.resize(bytes.size() / 2);
  write_file(file, bytes);
  EXPECT_EQ(refusal([&] { read_acquisition(file); }).code(), ExitCode::not_a_session);
}

}  // namespace
}  // namespace thermorig::dataset
