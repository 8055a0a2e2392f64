// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace thermorig::files {

/// What to try after a failure of this errno; the end of a refusal's sentence.
using Advice = std::string (*)(int error_number);

/// "free some space or choose another disk", ...: for files that can be written again.
std::string usual_advice(int error_number);

/// `<path>.<process>.part`: a file that is only seen under its name once it is whole, and that goes with this
/// object otherwise. All members throw Error(storage) with `noun` in the sentence ("the model").
class PartFile {
 public:
  PartFile(std::filesystem::path path, std::string noun, Advice advice = usual_advice);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  void write(std::span<const std::byte> bytes);
  void sync();
  /// Gives it its name and syncs the folder. Without `overwrite` an existing name is refused.
  void publish(bool overwrite);

  /// Where it lies until then.
  const std::filesystem::path& part_path() const { return part_path_; }

 private:
  [[noreturn]] void refuse(const std::string& action, int error_number,
                           const std::filesystem::path& where) const;
  int rename_to_new() const;
  void sync_folder() const;

  std::filesystem::path path_, part_path_;
  std::string noun_;
  Advice advice_;
  int descriptor_ = -1;
  bool published_ = false;
};

}  // namespace thermorig::files
