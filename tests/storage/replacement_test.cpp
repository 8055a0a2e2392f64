// SPDX-License-Identifier: MIT
// A file that is written anew on a disk that fails at every call in turn, or loses its power there.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <string>

#include "fault_disk.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/replaced_file.h"

namespace thermorig::storage_test {
namespace {

const std::string replaced_path = "/rec/x.h5", before = "what was there before",
                  after = "what takes its place";

DiskImage with_old_file() {
  const auto bytes = std::as_bytes(std::span(before));
  return {.files = {{replaced_path, std::make_shared<const Bytes>(bytes.begin(), bytes.end())}},
          .folders = {"/", "/rec"}};
}

void replace(files::Disk& disk) {
  files::ReplacedFile old(replaced_path, "the file", files::usual_advice, disk);
  old.lock();
  files::PartFile part(std::move(old));
  part.write(std::as_bytes(std::span(after)));
  part.sync();
  part.publish();
}

std::string text_in(const DiskImage& image) {
  const auto found = image.files.find(replaced_path);
  if (found == image.files.end()) return "";
  return {reinterpret_cast<const char*>(found->second->data()), found->second->size()};
}

TEST(Replacement, IsWholeOrHasNotHappenedWhateverCallFails) {
  constexpr std::array ways{FaultKind::io_error, FaultKind::no_space, FaultKind::short_write,
                            FaultKind::done_but_error, FaultKind::not_supported};
  constexpr std::array ends{PowerLoss{}, PowerLoss{PowerLoss::Data::torn, PowerLoss::Names::kept},
                            PowerLoss{PowerLoss::Data::garbage, PowerLoss::Names::some}};
  std::size_t hits = 0;
  for (const FaultKind kind : ways)
    for (std::size_t call = 0;; ++call) {
      MemoryDisk memory(with_old_file());
      FaultDisk disk(memory, Fault{kind, call});
      bool is_refused = false;
      try {
        replace(disk);
      } catch (const Error&) {
        is_refused = true;
      }
      if (call >= disk.count()) break;
      if (!disk.was_hit()) continue;  // a call that cannot fail in this way
      ++hits;
      const std::string where = std::string(call_names[static_cast<std::size_t>(disk.kind_hit())]);
      const std::string text = text_in(memory.after_end());
      EXPECT_THAT(text, testing::AnyOf(before, after)) << where;
      EXPECT_TRUE(is_refused || text == after) << where;
      std::mt19937_64 random(1);
      for (const PowerLoss& loss : ends) {
        const std::string left = text_in(memory.after_power_loss(loss, random));
        EXPECT_THAT(left, testing::AnyOf(before, after)) << where;
        EXPECT_TRUE(is_refused || left == after) << where;
      }
      const bool is_left = memory.after_end().files.size() > 1 && disk.kind_hit() != CallKind::remove;
      EXPECT_FALSE(is_left && disk.kind_hit() != CallKind::create) << "a part is left: " << where;
    }
  EXPECT_GT(hits, 30U);
}

/// What the old one has is what the new one is given before anything is made for it.
TEST(Replacement, IsRefusedAtTheStartWhereTheDiskIsFull) {
  MemoryDisk disk(with_old_file(), before.size() + 3);
  try {
    files::PartFile part(files::ReplacedFile(replaced_path, "the file", files::usual_advice, disk));
    ADD_FAILURE() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_THAT(error.what_happened(), testing::HasSubstr("there is no room for the file (21 bytes)"));
    EXPECT_THAT(error.advice(), testing::HasSubstr("free some space"));
  }
  EXPECT_EQ(disk.after_end().files.size(), 1U);
}

TEST(Replacement, GivesBackWhatItReservedAndDidNotWrite) {
  MemoryDisk disk(with_old_file(), 1000);
  {
    files::PartFile part(files::ReplacedFile(replaced_path, "the file", files::usual_advice, disk));
    part.reserve(900);
    EXPECT_LT(disk.free_bytes("/rec").value, 100U);
    part.write(std::as_bytes(std::span(after)));
    part.sync();
    part.publish();
  }
  EXPECT_EQ(disk.free_bytes("/rec").value, 1000U - after.size());
}

TEST(Replacement, MayBeReadByTheSameAndByNobodyElseMeanwhile) {
  MemoryDisk disk({.files = {}, .folders = {"/", "/rec"}});
  disk.close(disk.create(replaced_path, 0600).value);
  files::PartFile part(files::ReplacedFile(replaced_path, "the file", files::usual_advice, disk));
  EXPECT_EQ(disk.mode(files::part_path_of(replaced_path)), 0600U);
  part.publish();
  EXPECT_EQ(disk.mode(replaced_path), 0600U);
}

}  // namespace
}  // namespace thermorig::storage_test
