// SPDX-License-Identifier: MIT
#include "thermorig/estimators/map_file/map_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <limits>

#include "thermorig/core/error.h"

namespace thermorig::map_file {
namespace {

using testing::HasSubstr;

StoredMap small_map() {
  StoredMap stored{.simulated = true,
                   .environment = "kitchen",
                   .rig = "bench",
                   .made_utc = "2026-07-25T14:35:59.900001Z",
                   .creator = "thermorig 0.1.0"};
  stored.map.reference_c = 21.5F;
  for (std::size_t i = 0; i < odometer::Map::values / 2; ++i) {
    stored.map.temp_k[i] = 0.01F * static_cast<float>(i % 700);
    stored.map.seen[i] = 1;
  }
  stored.map.offset_deg[5] = -0.25;
  stored.map.offset_root_deg[7] = 0.5;
  stored.map.offset_known[5] = 2;
  stored.map.pixel_variance_k2.fill(0.3F);
  return stored;
}

std::string refusal_of(const std::string& bytes) {
  try {
    map_from(bytes, "a.map");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::not_a_session);
    EXPECT_EQ(error.where(), "a.map");
    return error.what_happened();
  }
  return "";
}

TEST(MapFile, ComesBackAsItWasWritten) {
  const StoredMap read = map_from(bytes_of(small_map()), "");
  EXPECT_TRUE(read.simulated);
  EXPECT_EQ(read.environment, "kitchen");
  EXPECT_EQ(read.made_utc, small_map().made_utc);
  EXPECT_EQ(read.map.temp_k, small_map().map.temp_k);
  EXPECT_EQ(read.map.offset_root_deg, small_map().map.offset_root_deg);
  EXPECT_EQ(bytes_of(read), bytes_of(small_map()));
  EXPECT_DOUBLE_EQ(seen_share(read.map), 0.5);
}

TEST(MapFile, EachDamagedByteIsSeen) {
  const std::string sound = bytes_of(small_map());
  for (std::size_t at = 0; at < sound.size(); at += 997) {
    std::string damaged = sound;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    EXPECT_NE(refusal_of(damaged), "") << at;
  }
  for (const std::size_t length : {std::size_t{0}, std::size_t{8}, std::size_t{11}, sound.size() - 1})
    EXPECT_NE(refusal_of(sound.substr(0, length)), "") << length;
  EXPECT_THAT(refusal_of(sound + "x"), HasSubstr("check sum"));
}

TEST(MapFile, NumbersThatNoMapHasAreRefusedEvenWithARightCheckSum) {
  StoredMap stored = small_map();
  stored.map.temp_k[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(refusal_of(bytes_of(stored)), HasSubstr("temperatures"));
  stored = small_map();
  stored.map.offset_known[3] = 3;
  EXPECT_THAT(refusal_of(bytes_of(stored)), HasSubstr("offsets"));
  stored = small_map();
  stored.map.lens.field_of_view_deg = 0.0;
  EXPECT_THAT(refusal_of(bytes_of(stored)), HasSubstr("field of view"));
}

TEST(MapFile, SaysThatAnotherVersionMadeIt) {
  std::string newer = bytes_of(small_map());
  newer[7] = '3';
  EXPECT_THAT(refusal_of(newer), HasSubstr("another version"));
  EXPECT_THAT(refusal_of("name = \"rig\""), HasSubstr("not a map"));
}

TEST(MapFile, AMapOfAnotherLensOrOrderIsRefusedInWords) {
  const auto refusal = [](double field_of_view_deg, bool mirrored, double distortion = 0.0,
                          double roll_deg = 0.0) -> std::string {
    CameraProfile camera;
    camera.pitch_scale = field_of_view_deg / camera.field_of_view_deg;
    camera.mirrored = mirrored;
    camera.distortion = distortion;
    camera.roll_deg = roll_deg;
    try {
      require_lens(small_map().map, camera, "a.map");
    } catch (const Error& error) {
      return error.what_happened();
    }
    return "";
  };
  EXPECT_EQ(refusal(55.0, true), "");
  EXPECT_EQ(refusal(55.3, true), "") << "a lens that was calibrated";
  EXPECT_EQ(refusal(110.0, true), "the map was made with a lens of 55 degrees, and this rig's has 110");
  EXPECT_THAT(refusal(44.2821, true), HasSubstr("this rig's has 44.28"));
  EXPECT_EQ(refusal(55.0, false), "the map was made with columns that are mirrored, and this rig's are not");
  EXPECT_EQ(refusal(55.0, true, 0.01, 1.0), "");
  EXPECT_EQ(refusal(55.0, true, -0.04),
            "the map was made with a lens whose distortion is 0, and this rig's is -0.04");
  EXPECT_THAT(refusal(55.0, true, 0.0, 3.0), HasSubstr("roll in degrees is 0, and this rig's is 3"));
}

TEST(MapFile, KeepsALensThatWasCalibratedAndRefusesOneThatNoRigHas) {
  StoredMap stored = small_map();
  stored.map.lens.distortion = -0.03;
  stored.map.lens.tilt_deg = 2.5;
  stored.map.lens.roll_deg = -1.5;
  const std::string bytes = bytes_of(stored);
  EXPECT_EQ(bytes.substr(0, 8), "THRMAP02");
  const odometer::Map::Lens lens = map_from(bytes, "a.map").map.lens;
  EXPECT_EQ(lens.distortion, -0.03);
  EXPECT_EQ(lens.tilt_deg, 2.5);
  EXPECT_EQ(lens.roll_deg, -1.5);
  EXPECT_EQ(bytes_of(small_map()).substr(0, 8), "THRMAP01") << "a plain lens's stay as they were";
  stored.map.lens.roll_deg = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal_of(bytes_of(stored)), HasSubstr("roll"));
}

/// By a program that works on it as long as this call takes.
std::filesystem::path write_now(const std::filesystem::path& path, const StoredMap& stored) {
  files::PartFile part(replaced_map(path));
  return write_map(part, stored);
}

TEST(MapFile, IsWrittenWholeOverAnOlderOne) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "map_file_test";
  std::filesystem::create_directories(folder);
  const auto path = folder / "kitchen.map";
  std::filesystem::remove(path);
  EXPECT_EQ(write_now(path, small_map()), path);
  EXPECT_TRUE(is_map(path));
  StoredMap other = small_map();
  other.environment = "garden";
  EXPECT_EQ(write_now(path, other), path);
  EXPECT_EQ(read_map(path).environment, "garden");
  StoredMap broken = small_map();
  broken.map.reference_c = std::numeric_limits<float>::infinity();
  EXPECT_THROW(write_now(path, broken), Error);
  EXPECT_EQ(read_map(path).environment, "garden") << "what cannot be read takes no other map's place";
  std::ofstream(folder / "note.txt") << "THR";
  EXPECT_FALSE(is_map(folder / "note.txt"));
  EXPECT_FALSE(is_map(folder));
}

TEST(MapFile, IsWrittenBesideOneThatAnotherProgramWroteMeanwhile) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "map_file_beside_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const auto path = folder / "kitchen.map";
  StoredMap other = small_map();
  other.environment = "garden";
  write_now(folder / "other.map", other);
  for (const char* beside : {"kitchen-2.map", "kitchen-3.map"}) {  // it appears, and then is replaced
    files::PartFile part(replaced_map(path));
    std::filesystem::copy_file(folder / "other.map", path, std::filesystem::copy_options::overwrite_existing);
    EXPECT_EQ(write_map(part, small_map()), folder / beside);
    EXPECT_EQ(read_map(path).environment, "garden");
    EXPECT_EQ(read_map(folder / beside).environment, "kitchen");
  }
}

}  // namespace
}  // namespace thermorig::map_file
