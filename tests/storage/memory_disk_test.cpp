// SPDX-License-Identifier: MIT
#include "memory_disk.h"

#include <gtest/gtest.h>

#include <cerrno>

namespace thermorig::storage_test {
namespace {

void append(MemoryDisk& disk, files::OpenFile file, std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  ASSERT_TRUE(disk.append(file, {&bytes, 1}).good());
}

std::string text_of(const DiskImage& image, const std::string& path) {
  const auto found = image.files.find(path);
  if (found == image.files.end()) return "(none)";
  return {reinterpret_cast<const char*>(found->second->data()), found->second->size()};
}

DiskImage without_power(const MemoryDisk& disk, PowerLoss loss = {}) {
  std::mt19937_64 random(1);
  return disk.after_power_loss(loss, random);
}

MemoryDisk empty_disk(std::uint64_t capacity = 1000) {
  return MemoryDisk({.files = {}, .folders = {"/"}}, capacity);
}

TEST(MemoryDisk, ForgetsWhatWasNotSynced) {
  MemoryDisk disk = empty_disk();
  const auto file = disk.create("/a", 0600).value;
  append(disk, file, "one");
  disk.sync(file);
  append(disk, file, "two");
  EXPECT_EQ(text_of(disk.after_end(), "/a"), "onetwo");
  EXPECT_EQ(text_of(without_power(disk), "/a"), "(none)");  // its name was not synced either
  disk.sync_folder("/");
  EXPECT_EQ(text_of(without_power(disk), "/a"), "one");
  EXPECT_EQ(text_of(without_power(disk, {PowerLoss::Data::zeros, PowerLoss::Names::lost}), "/a"),
            std::string("one\0\0\0", 6));
}

TEST(MemoryDisk, ForgetsARenameUntilTheFolderIsSynced) {
  MemoryDisk disk = empty_disk();
  const auto file = disk.create("/a.part", 0600).value;
  append(disk, file, "whole");
  disk.sync(file);
  disk.sync_folder("/");
  EXPECT_EQ(disk.rename_to_new("/a.part", "/a"), 0);
  EXPECT_EQ(text_of(without_power(disk), "/a"), "(none)");
  EXPECT_EQ(text_of(without_power(disk), "/a.part"), "whole");
  EXPECT_EQ(text_of(without_power(disk, {PowerLoss::Data::lost, PowerLoss::Names::kept}), "/a"), "whole");
  disk.sync_folder("/");
  EXPECT_EQ(text_of(without_power(disk), "/a"), "whole");
  EXPECT_EQ(text_of(without_power(disk), "/a.part"), "(none)");
}

TEST(MemoryDisk, DoesNotGetBackWhatAFailedSyncHasDropped) {
  MemoryDisk disk = empty_disk();
  const auto file = disk.create("/a", 0600).value;
  disk.sync_folder("/");
  append(disk, file, "lost");
  disk.drop_unsynced(file);
  append(disk, file, "kept");
  EXPECT_EQ(disk.sync(file), 0);
  EXPECT_EQ(text_of(without_power(disk), "/a"), std::string("\0\0\0\0kept", 8));
}

TEST(MemoryDisk, IsFullBeyondItsCapacityButNotWithinAReserve) {
  MemoryDisk disk = empty_disk(10);
  const auto reserved = disk.create("/a", 0600).value;
  EXPECT_EQ(disk.reserve(reserved, 6), 0);
  EXPECT_EQ(disk.reserve(reserved, 11), ENOSPC);
  const auto other = disk.create("/b", 0600).value;
  const std::string_view text = "123456";
  const auto bytes = std::as_bytes(std::span(text));
  EXPECT_EQ(disk.append(other, {&bytes, 1}).value, 4U);
  EXPECT_EQ(disk.append(other, {&bytes, 1}).error_number, ENOSPC);
  EXPECT_EQ(disk.append(reserved, {&bytes, 1}).value, 6U);
}

}  // namespace
}  // namespace thermorig::storage_test
