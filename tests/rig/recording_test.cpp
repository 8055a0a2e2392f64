// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "rig/recording/recording_start.h"
#include "simulated_bus.h"
#include "thermorig/io/files/part_file.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::rig::test {
namespace {

using ::testing::HasSubstr;

VirtualOptions virtual_options(const TemporaryFolder& folder, const SweepPlan& plan) {
  VirtualOptions options;
  options.recording = recording_options(folder, simulation::default_profile(), plan);
  return options;
}

std::optional<Error> error_of(DeviceBus& bus, const VirtualOptions& options) {
  try {
    record_virtual(bus, options);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  return files;
}

TEST(Recording, LeavesOneSessionAndNoJournal) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  const RecordingResult result = record_virtual(bus, virtual_options(folder, short_plan()));
  EXPECT_EQ(result.exit, ExitCode::ok) << result.message;
  EXPECT_EQ(result.state, session::State::complete);
  EXPECT_EQ(files_below(folder.path()), std::vector{result.session});
  EXPECT_NEAR(static_cast<double>(result.quality.swept), 48.0, 4.0);
  const session::Session session = session::read_session(result.session);
  EXPECT_EQ(session.raw.header.environment, "kitchen");
  EXPECT_EQ(session.raw.header.acquisition, 1);
  EXPECT_EQ(session.raw.header.plan_name, "quick");
  EXPECT_FALSE(session.raw.header.firmware.empty());
  EXPECT_EQ(session.raw.legs.size(), 4U);
}

/// No battery for the clock: the recording begins in 1970, and the time comes over the network on the way.
TEST(Recording, IsNamedAndDatedByTheClockThatWasSetOnTheWay) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  VirtualOptions options = virtual_options(folder, short_plan());
  constexpr std::int64_t set_ns = 20'000LL * 86'400 * 1'000'000'000;  // 20000 days
  const std::int64_t here_ns = -to_ns(io::now());                     // the wall's clock begins at 0
  int asked = 0;
  options.recording.realtime_offset_ns = [&] { return here_ns + (asked++ < 2 ? 0 : set_ns); };
  const RecordingResult result = record_virtual(bus, options);
  EXPECT_EQ(result.exit, ExitCode::ok) << result.message;
  EXPECT_THAT(result.session.filename().string(), ::testing::StartsWith("kitchen_acq-01_20241004T"));
  EXPECT_EQ(files_below(folder.path()), std::vector{result.session});
  const session::Session session = session::read_session(result.session);
  EXPECT_THAT(session.raw.header.start_time_utc, ::testing::StartsWith("2024-10-04T"));
  const bool told = std::any_of(session.raw.events.begin(), session.raw.events.end(), [](const auto& event) {
    return event.kind == EventKind::warning && event.message.starts_with("the computer's clock was set by +");
  });
  EXPECT_TRUE(told);
}

TEST(AClock, IsSetWhereItStepsAndNotWhereItIsSlewed) {
  constexpr std::int64_t second_ns = 1'000'000'000;
  const struct {
    std::int64_t step_ns;
    double run_s;
    bool is_set;
  } runs[] = {{0, 60, false},
              {second_ns / 2, 60, false},
              {3 * second_ns / 2, 3600, false},
              {2 * second_ns, 60, true},
              {-5 * second_ns, 600, true},
              {1'700'000'000 * second_ns, 30, true}};
  for (const auto& run : runs)
    EXPECT_EQ(clock_set_ns(42, 42 + run.step_ns, run.run_s), run.is_set ? run.step_ns : 0) << run.step_ns;
}

TEST(Recording, SecondOneTakesTheNextNumber) {
  const TemporaryFolder folder;
  for (int expected = 1; expected <= 2; ++expected) {
    SimulatedBus bus(simulation::default_rig(1, "kitchen"));
    EXPECT_EQ(record_virtual(bus, virtual_options(folder, short_plan())).acquisition, expected);
  }
}

TEST(Recording, ShowsProgressAndHealth) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  VirtualOptions options = virtual_options(folder, short_plan());
  std::vector<RecordingProgress> shown;
  options.progress = [&](const RecordingProgress& progress) { shown.push_back(progress); };
  record_virtual(bus, options);
  ASSERT_GT(shown.size(), 6U);
  const RecordingProgress& middle = shown[6];
  EXPECT_GT(middle.sweep.leg, 0);
  EXPECT_EQ(middle.sweep.leg_count, 4);
  EXPECT_GT(middle.sweep.eta_s, 0.0);
  EXPECT_NEAR(middle.health[Device::camera].rate_max_hz, 8.0, 1.0);
  EXPECT_NEAR(middle.health[Device::gyro].rate_min_hz, 200.0, 20.0);
  EXPECT_NEAR(middle.health[Device::servo].rate_max_hz, 100.0, 10.0);
  EXPECT_LT(middle.health[Device::gyro].age_s.value_or(99.0), 0.1);
  EXPECT_EQ(middle.health[Device::camera].lost, 0U);
  for (std::size_t i = 1; i < shown.size(); ++i) {
    EXPECT_GE(shown[i].sweep.done_share, shown[i - 1].sweep.done_share - 0.05);
  }
  EXPECT_EQ(shown.back().sweep.done_share, 1.0);
  EXPECT_EQ(shown.back().sweep.eta_s, 0.0);
}

TEST(Recording, ASilentDeviceIsNamedAndNothingIsLeftBehind) {
  for (const Device silent : all_devices) {
    const TemporaryFolder folder;
    SimulatedBus bus(simulation::default_rig(1, "kitchen"));
    bus.is_cut = [&](Device device, HostTime) { return device == silent; };
    const auto error = error_of(bus, virtual_options(folder, short_plan()));
    ASSERT_TRUE(error) << name_of(silent);
    EXPECT_EQ(error->code(), ExitCode::device_missing);
    EXPECT_THAT(error->where(), HasSubstr(std::string(name_of(silent))));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  }
}

/// Camera and gyro plugged in the wrong way round.
struct SwappedBus : SimulatedBus {
  using SimulatedBus::SimulatedBus;
  std::vector<Chunk> advance(HostTime until) override {
    std::vector<Chunk> chunks = SimulatedBus::advance(until);
    for (Chunk& chunk : chunks)
      if (chunk.device != Device::servo)
        chunk.device = chunk.device == Device::camera ? Device::gyro : Device::camera;
    return chunks;
  }
};

TEST(Recording, SaysWhatCameInsteadOfTheCamera) {
  const TemporaryFolder folder;
  SwappedBus bus(simulation::default_rig(1, "kitchen"));
  const auto error = error_of(bus, virtual_options(folder, short_plan()));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ExitCode::device_missing);
  EXPECT_THAT(error->what(), HasSubstr("this is the gyro, not the camera"));
}

TEST(Recording, AFolderThatWasThereBeforeStays) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "kitchen");
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  bus.is_cut = [](Device device, HostTime) { return device == Device::camera; };
  EXPECT_TRUE(error_of(bus, virtual_options(folder, short_plan())));
  EXPECT_TRUE(std::filesystem::is_directory(folder.path() / "kitchen"));
}

TEST(Recording, SaysWhichProtocolTheGyroSpeaks) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  VirtualOptions options = virtual_options(folder, short_plan());
  options.recording.profile.gyro.protocol = "text";  // the simulated one sends packets
  const auto error = error_of(bus, options);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ExitCode::device_missing);
  EXPECT_THAT(error->advice(), HasSubstr("protocol = \"witmotion\""));
}

TEST(Recording, SaysHowTheRawCountsOfAFlightControllerAreRead) {
  const TemporaryFolder folder;
  simulation::VirtualRigConfig config = simulation::default_rig(1, "kitchen");
  config.profile.gyro.protocol = "mavlink";
  config.profile.gyro.settings = {{"raw_scale_dps", 0.0573}};  // it sends RAW_IMU
  SimulatedBus bus(config);
  VirtualOptions options = virtual_options(folder, short_plan());
  options.recording.profile.gyro.protocol = "mavlink";  // without a scale
  const auto error = error_of(bus, options);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ExitCode::device_missing);
  EXPECT_THAT(error->what_happened(), HasSubstr("MAVLink packets"));
  EXPECT_THAT(error->advice(), HasSubstr("raw_scale_dps = 0.0573"));
}

TEST(Recording, SaysThatAVectornavDoesNotHearWhatItIsAskedFor) {
  const TemporaryFolder folder;
  simulation::VirtualRigConfig config = simulation::default_rig(1, "kitchen");
  config.profile.gyro.protocol = "vectornav";
  config.profile.gyro.link.baud = 921600;
  RigProfile profile = config.profile;
  config.profile.gyro.settings = {{"filtered", 1.0}};  // it sends VNYMR, whatever it is asked
  SimulatedBus bus(config);
  VirtualOptions options = virtual_options(folder, short_plan());
  options.recording.profile = profile;
  const auto error = error_of(bus, options);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ExitCode::device_missing);
  EXPECT_THAT(error->what_happened(), HasSubstr("asked for VectorNav messages (VNIMU)"));
  EXPECT_THAT(error->advice(), HasSubstr("filtered = 1 in [gyro.vectornav]"));
}

TEST(Recording, SaysThatTheGyroPrintsText) {
  struct TextGyro : SimulatedBus {
    using SimulatedBus::SimulatedBus;
    std::vector<Chunk> advance(HostTime until) override {
      std::vector<Chunk> chunks = SimulatedBus::advance(until);
      const std::string line = "0.25,-1.50,30.00\r\n";
      for (Chunk& chunk : chunks)
        if (chunk.device == Device::gyro) chunk.bytes.assign(line.begin(), line.end());
      return chunks;
    }
  } bus(simulation::default_rig(1, "kitchen"));
  const TemporaryFolder folder;
  const auto error = error_of(bus, virtual_options(folder, short_plan()));
  ASSERT_TRUE(error);
  EXPECT_THAT(error->advice(), HasSubstr("protocol = \"text\""));
  EXPECT_THAT(error->advice(), ::testing::Not(HasSubstr("baud")));
}

TEST(Recording, SaysThatAPortCarriesNoFrames) {
  const TemporaryFolder folder;
  struct WrongBaud : SimulatedBus {
    using SimulatedBus::SimulatedBus;
    std::vector<Chunk> advance(HostTime until) override {
      std::vector<Chunk> chunks = SimulatedBus::advance(until);
      for (Chunk& chunk : chunks)
        if (chunk.device == Device::camera)
          for (std::uint8_t& byte : chunk.bytes) byte = static_cast<std::uint8_t>(byte & 0xB6U);
      return chunks;
    }
  } bus(simulation::default_rig(1, "kitchen"));
  const auto error = error_of(bus, virtual_options(folder, short_plan()));
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what(), HasSubstr("no camera frames"));
  EXPECT_THAT(error->what(), HasSubstr("baud"));
}

TEST(Recording, ALostDeviceEndsItProperly) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  bus.is_cut = [](Device device, HostTime at) {
    return device == Device::servo && to_s(at - HostTime{}) > 3.0;
  };
  const RecordingResult result = record_virtual(bus, virtual_options(folder, short_plan()));
  EXPECT_EQ(result.exit, ExitCode::device_lost);
  EXPECT_EQ(result.state, session::State::partial);
  EXPECT_THAT(result.message, HasSubstr("servo"));
  EXPECT_TRUE(std::filesystem::exists(result.session));
}

TEST(Recording, CtrlCGivesAPartialSession) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  VirtualOptions options = virtual_options(folder, short_plan());
  int asked = 0;
  options.stop_requested = [&] { return ++asked > 800; };
  std::vector<SweepProgress> shown;
  options.progress = [&](const RecordingProgress& progress) { shown.push_back(progress.sweep); };
  const RecordingResult result = record_virtual(bus, options);
  EXPECT_EQ(result.exit, ExitCode::interrupted);
  EXPECT_EQ(result.state, session::State::partial);
  const auto last_leg = std::find_if(shown.rbegin(), shown.rend(), [](const SweepProgress& sweep) {
    return sweep.phase == SweepPhase::leg;
  });
  ASSERT_NE(last_leg, shown.rend());
  EXPECT_EQ(shown.back().phase, SweepPhase::done);
  EXPECT_LE(shown.back().done_share, last_leg->done_share + 0.01) << "what is left undriven is not done";
  EXPECT_GT(shown.back().done_share, 0.0);
}

TEST(Recording, AnUnwritableFolderIsAStorageError) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "kitchen") << "a file where the folder should be";
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  const auto error = error_of(bus, virtual_options(folder, short_plan()));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ExitCode::storage);
}

// ---- recovery -----------------------------------------------------------------------------------------

std::vector<char> content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A recording that was killed after three seconds.
std::filesystem::path killed_journal(const TemporaryFolder& folder, std::uint64_t seed = 1) {
  SimulatedBus bus(simulation::default_rig(seed, "kitchen"));
  const auto options = recording_options(folder, simulation::default_profile(), short_plan());
  return run_to_journal(bus, options, {.give_up_at_s = 3.0}).file.journal;
}

TEST(Recovery, MakesASessionOfEveryChunkBeforeTheKill) {
  const TemporaryFolder folder;
  const auto journal = killed_journal(folder);
  const RawRecording before = journal::read_journal(journal).recording;
  const auto results = recover(folder.path());
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].kind, RecoveryKind::made);
  EXPECT_EQ(results[0].state, session::State::recovered);
  EXPECT_GT(results[0].frames, 15U);
  const session::Session session = session::read_session(results[0].session);
  for (const Device device : all_devices)
    EXPECT_EQ(session.raw.received[device].bytes, before.received[device].bytes);
}

TEST(Recovery, RunTwiceGivesTheSame) {
  const TemporaryFolder folder;
  const auto journal = killed_journal(folder);
  const auto first = recover(journal);
  const auto bytes = content(first.at(0).session);
  const auto second = recover(journal);
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(second[0].kind, RecoveryKind::already_there);
  EXPECT_EQ(second[0].frames, first[0].frames);
  EXPECT_EQ(second[0].state, first[0].state);
  EXPECT_EQ(content(second[0].session), bytes);
  EXPECT_NO_THROW(recover(folder.path()));
  EXPECT_EQ(content(second[0].session), bytes);
}

TEST(Recovery, ATornTailCostsOnlyItself) {
  const TemporaryFolder folder;
  const auto journal = killed_journal(folder);
  const auto whole = journal::read_journal(journal);
  std::filesystem::resize_file(journal, whole.bytes_read - 7);
  const auto results = recover(journal);
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].kind, RecoveryKind::made);
  EXPECT_GT(results[0].bytes_ignored, 0U);
  EXPECT_TRUE(std::filesystem::exists(journal));
  const auto chunks_of = [](const RawRecording& raw) {
    std::uint64_t chunks = 0;
    for (const Device device : all_devices) chunks += raw.received[device].chunk_count();
    return chunks;
  };
  EXPECT_GE(results[0].chunks + 1, chunks_of(whole.recording));
}

TEST(Recovery, StatesTheSameLossAgainAsLongAsTheJournalIsThere) {
  const TemporaryFolder folder;
  const auto journal = killed_journal(folder);
  std::filesystem::resize_file(journal, journal::read_journal(journal).bytes_read - 7);
  const auto first = recover(journal);
  for (const auto& path : {journal, folder.path()}) {
    const auto again = recover(path);
    ASSERT_EQ(again.size(), 1U);
    EXPECT_EQ(again[0].kind, RecoveryKind::already_there);
    EXPECT_EQ(again[0].bytes_ignored, first.at(0).bytes_ignored);
  }
}

TEST(Recovery, RemovesAndNamesWhatKilledProgramsLeftOfAnyFile) {
  const TemporaryFolder folder;
  const auto journal = killed_journal(folder);
  const std::string session = session_of(journal).string(), host = "." + files::host_name();
  constexpr int never_a_process = 1 << 30;  // beyond the most that the kernel gives (2^22)
  const std::string number = "." + std::to_string(never_a_process) + ".part";
  const std::filesystem::path abandoned = session + host + number;
  const std::filesystem::path of_a_map = (folder.path() / "kitchen.map").string() + host + number;
  const std::filesystem::path elsewhere = session + ".another-host" + number;
  const std::filesystem::path ours = session + host + "." + std::to_string(::getpid()) + ".1.part";
  const std::filesystem::path alive = session + host + ".1.part";
  const std::filesystem::path other = folder.path() / "kitchen" / "notes.part";
  for (const auto& path : {abandoned, of_a_map, elsewhere, ours, alive, other}) std::ofstream(path) << "part";
  EXPECT_THAT(left_parts(folder.path()), testing::UnorderedElementsAre(abandoned, of_a_map));
  const auto results = recover(folder.path());
  ASSERT_EQ(results.size(), 3U);
  EXPECT_EQ(results[0].kind, RecoveryKind::made);
  for (int i = 1; i < 3; ++i) EXPECT_EQ(results[static_cast<std::size_t>(i)].kind, RecoveryKind::left_part);
  for (const auto& path : {abandoned, of_a_map}) EXPECT_FALSE(std::filesystem::exists(path)) << path;
  for (const auto& path : {elsewhere, ours, alive, other}) EXPECT_TRUE(std::filesystem::exists(path)) << path;
}

TEST(Recovery, LeavesAJournalAloneThatIsBeingWritten) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  HostTime now{};
  Recording recording(recording_options(folder, simulation::default_profile(), short_plan()), now,
                      [](auto...) {});
  const auto results = recover(folder.path());
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].kind, RecoveryKind::in_use);
  EXPECT_TRUE(std::filesystem::exists(recording.file().journal));
}

TEST(Recovery, GoesOnAfterAJournalThatIsNone) {
  const TemporaryFolder folder;
  const auto good = killed_journal(folder);
  std::ofstream(good.parent_path() / "kitchen_acq-00_broken.journal") << "not a journal";
  const auto results = recover(folder.path());
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].kind, RecoveryKind::failed);
  EXPECT_EQ(results[1].kind, RecoveryKind::made);
}

TEST(Recovery, SaysWhatIsNeitherJournalNorSession) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "notes.txt") << "hello";
  try {
    recover(folder.path() / "notes.txt");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::not_a_session);
  }
  EXPECT_THROW(recover(folder.path() / "nothing"), Error);
}

TEST(Reprocess, GivesTheSameSamplesAgain) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  const auto result = record_virtual(bus, virtual_options(folder, short_plan()));
  const session::Session before = session::read_session(result.session);
  const session::Session again = build_session(session::read_raw(result.session));
  ASSERT_EQ(again.samples.size(), before.samples.size());
  EXPECT_EQ(again.state, session::State::complete);
  for (std::size_t i = 0; i < again.samples.size(); ++i) {
    EXPECT_EQ(again.samples[i].reason_bits, before.samples[i].reason_bits);
    EXPECT_EQ(again.samples[i].leg, before.samples[i].leg);
  }
}

}  // namespace
}  // namespace thermorig::rig::test
