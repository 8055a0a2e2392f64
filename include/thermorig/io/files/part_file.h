// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "thermorig/io/files/disk.h"

namespace thermorig::files {

class ReplacedFile;

/// What to try after a failure of this errno; the end of a refusal's sentence.
using Advice = std::string (*)(int error_number);

/// "free some space or choose another disk", ...: for files that can be written again.
std::string usual_advice(int error_number);

/// This machine's, as it stands in a part's name: letters, digits, '-', '_' and '.', at most 64.
std::string host_name();

/// What a file is called until it is whole: `<path>.<host>.<process>.part`, so that no two programs on
/// machines that share a disk write the same one. This is the name of the calling one.
std::filesystem::path part_path_of(const std::filesystem::path& path);

/// What a program of this machine that has ended left of a file it was writing: the path that the file was
/// to get. None for any other file. A process of the calling one's number counts as ended.
std::optional<std::filesystem::path> left_part_of(const std::filesystem::path& path);

/// Removes a part that no program of this machine writes any more. Was it removed?
bool remove_unless_held(const std::filesystem::path& part, Disk& disk = real_disk());

/// A part as above: a file that is only seen under its name once it is whole, and that goes with this
/// object otherwise. What a killed program left under that very name is removed. All members throw
/// Error(storage) with `noun` in the sentence ("the model").
class PartFile {
 public:
  /// Of a file that is new.
  PartFile(std::filesystem::path path, std::string noun, Advice advice = usual_advice,
           Disk& disk = real_disk());
  /// Of one that takes the place of `replaced`, if there is one: room for as many bytes is taken, and it may
  /// be read by the same. Throws Error(no_permission) as well, where that cannot be.
  explicit PartFile(ReplacedFile replaced);
  /// Of one that is new, with as much room, and may be read by those who may read `like`.
  PartFile(std::filesystem::path path, const ReplacedFile& like);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// Room for so many bytes, which writing them then finds.
  void reserve(std::uint64_t bytes);
  void write(std::span<const std::byte> bytes);
  /// What the disk gives back of it.
  std::uint64_t size() const;
  void read_back(std::uint64_t offset, std::span<std::byte> out) const;
  /// Nothing more will be written: the disk may begin with what sync() waits for.
  void begin_sync() { disk_.begin_sync(file_); }
  void sync();
  /// Gives it its name and syncs the folder. A name that is taken is refused, unless by the file that is to
  /// be replaced, as it was; of another one in its place Error(no_permission) is thrown.
  void publish();
  /// The same, but false where publish() refuses the name.
  bool publish_unless_taken();

  const std::filesystem::path& path() const { return path_; }  // that it gets

 private:
  PartFile(std::filesystem::path path, std::string noun, Advice advice, Disk& disk, unsigned mode);
  [[noreturn]] void refuse(const std::string& action, int error_number,
                           const std::filesystem::path& where) const;
  void create(unsigned mode);
  void take_access_of(const ReplacedFile& file);
  int replace();
  int rename_to_new();
  int rename_unless_taken();

  Disk& disk_;
  std::unique_ptr<ReplacedFile> replaced_;
  std::filesystem::path path_, part_path_;
  std::string noun_;
  Advice advice_;
  OpenFile file_ = OpenFile::none;
  std::uint64_t reserved_ = 0;
  bool is_whole_ = true;  // no write and no sync has failed
  bool published_ = false;
};

}  // namespace thermorig::files
