// SPDX-License-Identifier: MIT
#include "thermorig/learning/dataset/frame_store.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstring>
#include <limits>

#include "../session/temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/core/frame.h"

namespace thermorig::dataset {
namespace {

constexpr std::uint64_t frame_bytes = frame_pixels * sizeof(float);
constexpr std::uint64_t packed_bytes = frame_pixels * 2;  // of a frame of hundredths()

network::Acquisition of_frames(std::size_t frames) {
  network::Acquisition acquisition;
  acquisition.run.resize(frames, 1);
  return acquisition;
}

/// So many frames of whole hundredths of a degree, as cameras send them, from the coldest to the warmest
/// there are.
network::Acquisition hundredths(std::size_t frames) {
  network::Acquisition acquisition = of_frames(frames);
  for (std::size_t i = 0; i < frames * frame_pixels; ++i) {
    const int between = static_cast<int>(i * 7919 % 65535) - 32767;
    const std::size_t column = i % frame_columns;
    acquisition.temp_c.push_back(static_cast<float>(column == 3    ? -32767
                                                    : column == 30 ? 32767
                                                                   : between) /
                                 100.0F);
  }
  return acquisition;
}

/// The same with one pixel that is none.
network::Acquisition not_hundredths(std::size_t frames, float odd = 20.001F) {
  network::Acquisition acquisition = hundredths(frames);
  acquisition.temp_c[5] = odd;
  return acquisition;
}

class FrameStoreOnDisk : public session::InTemporaryFolder {
 protected:
  FrameFolder here() const { return {.folder = folder_, .is_only_choice = true}; }
};

/// A disk on which files may not be large, for as long as this lives.
class SmallFiles {
 public:
  explicit SmallFiles(std::uint64_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  ~SmallFiles() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  SmallFiles(const SmallFiles&) = delete;
  SmallFiles& operator=(const SmallFiles&) = delete;

 private:
  rlimit before_{};
};

TEST_F(FrameStoreOnDisk, KeepsInMemoryWhatFits) {
  const std::uint64_t three = 3 * packed_bytes, two = 2 * packed_bytes;
  FrameStore store(here(), three + two);
  network::Acquisition first = hundredths(3), second = hundredths(3), third = hundredths(2);
  for (network::Acquisition* acquisition : {&first, &second, &third}) {
    store.take(*acquisition);
    EXPECT_NE(acquisition->stored, nullptr);
    EXPECT_TRUE(acquisition->temp_c.empty());
  }
  EXPECT_EQ(store.bytes_in_memory(), three + two);
  EXPECT_EQ(store.bytes_on_disk(), 3 * packed_bytes);
  EXPECT_TRUE(std::filesystem::equivalent(store.place(), folder_));
}

TEST_F(FrameStoreOnDisk, KeepsFloatsWhereABitWouldBeLost) {
  FrameStore store(here(), 0);
  std::uint64_t bytes = 0;
  for (const float odd : {20.001F, -0.0F, 400.0F, std::numeric_limits<float>::quiet_NaN()}) {
    network::Acquisition acquisition = not_hundredths(2, odd);
    store.take(acquisition);
    EXPECT_EQ(store.bytes_on_disk(), bytes += 2 * frame_bytes) << odd;
  }
}

TEST_F(FrameStoreOnDisk, GivesBackTheSameBits) {
  for (const std::uint64_t memory_bytes : {std::uint64_t{0}, 1000 * frame_bytes})
    for (const network::Acquisition& before : {hundredths(700), not_hundredths(700)}) {
      auto store = std::make_unique<FrameStore>(here(), memory_bytes);
      network::Acquisition after = before, other = not_hundredths(2);
      store->take(other);
      store->take(after);
      store.reset();  // who has the frames needs nothing else
      std::size_t frames = 0;
      network::for_each_frame(after, [&](std::size_t frame, std::span<const float> temp_c) {
        EXPECT_EQ(frame, frames++);
        ASSERT_EQ(temp_c.size(), frame_pixels);
        EXPECT_EQ(std::memcmp(temp_c.data(), &before.temp_c[frame * frame_pixels], frame_bytes), 0) << frame;
      });
      EXPECT_EQ(frames, 700U);
    }
}

TEST_F(FrameStoreOnDisk, UnpacksAllIfAllFit) {
  const network::Acquisition before = hundredths(3);
  std::vector<network::Acquisition> acquisitions{before, before};
  FrameStore store(here(), 6 * (frame_bytes + 100));
  for (network::Acquisition& acquisition : acquisitions) store.take(acquisition);
  store.give_back(acquisitions, 101);
  EXPECT_NE(acquisitions[0].stored, nullptr);
  store.give_back(acquisitions, 100);
  for (const network::Acquisition& acquisition : acquisitions) {
    EXPECT_EQ(acquisition.stored, nullptr);
    EXPECT_EQ(acquisition.temp_c, before.temp_c);
  }
  EXPECT_EQ(store.bytes_in_memory(), 0U);
}

TEST_F(FrameStoreOnDisk, HasNoNameInTheFolder) {
  FrameStore store(here(), 0);
  network::Acquisition acquisition = hundredths(2);
  store.take(acquisition);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(FrameStoreOnDisk, SaysWhatToTryWhereTheDiskIsFull) {
  FrameStore store(here(), 0);
  network::Acquisition first = hundredths(2), second = hundredths(2);
  const SmallFiles small(3 * packed_bytes);
  store.take(first);
  try {
    store.take(second);
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_NE(error.what_happened().find("no room"), std::string::npos) << error.what_happened();
    EXPECT_NE(error.advice().find("--cache"), std::string::npos) << error.advice();
    EXPECT_NE(error.advice().find("--memory"), std::string::npos) << error.advice();
    EXPECT_TRUE(std::filesystem::equivalent(error.where(), folder_)) << error.where();
  }
}

TEST_F(FrameStoreOnDisk, IsRefusedWhereFilesLieInMemory) {
  FrameStore store({.folder = "/dev/shm", .is_only_choice = true}, 0);
  network::Acquisition acquisition = hundredths(2);
  try {
    store.take(acquisition);
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_EQ(error.where(), "/dev/shm");
  }
}

}  // namespace
}  // namespace thermorig::dataset
