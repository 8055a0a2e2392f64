// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "thermorig/io/files/disk.h"

namespace thermorig::files {

/// What to try after a failure of this errno; the end of a refusal's sentence.
using Advice = std::string (*)(int error_number);

/// "free some space or choose another disk", ...: for files that can be written again.
std::string usual_advice(int error_number);

/// `<path>.<process>.part`: a file that is only seen under its name once it is whole, and that goes with this
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
  std::vector<std::byte> read_back() const;
  void sync();
  /// Gives it its name and syncs the folder. Without `overwrite` an existing name is refused.
  void publish(bool overwrite);

 private:
  [[noreturn]] void refuse(const std::string& action, int error_number,
                           const std::filesystem::path& where) const;
  bool remove_abandoned();
  int rename_to_new();
  int rename_unless_taken();
  std::uint64_t size() const;

  Disk& disk_;
  std::filesystem::path path_, part_path_;
  std::string noun_;
  Advice advice_;
  OpenFile file_ = OpenFile::none;
  bool is_whole_ = true;  // no write and no sync has failed
  bool published_ = false;
};

}  // namespace thermorig::files
