// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "thermorig/io/files/disk.h"

namespace thermorig::files {

/// What to try after a failure of this errno; the end of a refusal's sentence.
using Advice = std::string (*)(int error_number);

/// "free some space or choose another disk", ...: for files that can be written again.
std::string usual_advice(int error_number);

/// What a file is called until it is whole: `<path>.<host>.<process>.part`, so that no two programs on
/// machines that share a disk write the same one. This is the name of the calling one.
std::filesystem::path part_path_of(const std::filesystem::path& path);

/// Whose part of `path` a file of this name is, if it is one of this host: the number of its process. Before
/// hosts stood in names they were `<path>.<process>.part`; those are taken for this host's.
std::optional<std::uint64_t> process_of_part(const std::filesystem::path& part,
                                             const std::filesystem::path& path);

/// Removes a part that no program of this machine writes any more. Was it removed?
bool remove_unless_held(const std::filesystem::path& part, Disk& disk = real_disk());

/// A part as above: a file that is only seen under its name once it is whole, and that goes with this
/// object otherwise. What a killed program left under that very name is removed. All members throw
/// Error(storage) with `noun` in the sentence ("the model").
class PartFile {
 public:
  PartFile(std::filesystem::path path, std::string noun, Advice advice = usual_advice,
           Disk& disk = real_disk());
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  void write(std::span<const std::byte> bytes);
  /// What the disk gives back of it.
  std::uint64_t size() const;
  void read_back(std::uint64_t offset, std::span<std::byte> out) const;
  /// Nothing more will be written: the disk may begin with what sync() waits for.
  void begin_sync() { disk_.begin_sync(file_); }
  void sync();
  /// Gives it its name and syncs the folder. Without `overwrite` an existing name is refused.
  void publish(bool overwrite);
  /// The same without `overwrite`, but false where the name is taken.
  bool publish_if_free();

 private:
  [[noreturn]] void refuse(const std::string& action, int error_number,
                           const std::filesystem::path& where) const;
  int name_it(bool overwrite);
  int rename_to_new();
  int rename_unless_taken();

  Disk& disk_;
  std::filesystem::path path_, part_path_;
  std::string noun_;
  Advice advice_;
  OpenFile file_ = OpenFile::none;
  bool is_whole_ = true;  // no write and no sync has failed
  bool published_ = false;
};

}  // namespace thermorig::files
