// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "thermorig/io/files/disk.h"
#include "thermorig/io/files/part_file.h"

namespace thermorig::files {

/// The file whose place a new one will take, or its place while nothing is there: what a symbolic link leads
/// to. A PartFile that is made of it takes over who may read it, and takes its place only if it is still the
/// same. Whoever reads it first and writes it again locks it before:
///
///   files::ReplacedFile old(path, "the session");   // refuses what could not be replaced
///   old.lock();                                     // from here on nobody else changes it
///   ... read old.path() ...
///   files::PartFile part(std::move(old));
///   part.reserve(bytes);
///   part.write(...), part.sync(), part.publish();
///
/// Whoever works for long makes the part at the start as well, so that an end in vain is refused there.
class ReplacedFile {
 public:
  /// Throws Error(storage) with `noun` in the sentence for a folder, a pipe or a device, for what is
  /// write-protected, or held in its place (a bind mount), and where it cannot be looked at;
  /// Error(no_permission) for one that may not be read.
  ReplacedFile(const std::filesystem::path& path, std::string noun, Advice advice = usual_advice,
               Disk& disk = real_disk());

  /// Until this and its part have gone. Others may go on reading the file as it was, HDF5's readers as well.
  /// Throws Error(no_permission) that names who has it open to write, in HDF5 as well, or replaces it.
  void lock();
  bool try_lock();

  bool is_unchanged() const;

  const std::filesystem::path& path() const { return path_; }  // behind its links
  bool exists() const { return before_.has_value(); }
  std::uint64_t bytes() const { return before_ ? static_cast<std::uint64_t>(before_->bytes) : 0; }

 private:
  friend class PartFile;
  [[noreturn]] void refuse(const std::string& why, const std::string& advice) const;
  [[noreturn]] void refuse_as_used(const std::string& holder) const;
  void note();

  std::filesystem::path path_;
  std::string noun_;
  Advice advice_;
  Disk* disk_;
  std::unique_ptr<ClosedOnExit> file_;  // empty where there is none
  std::optional<FileIdentity> before_;
};

}  // namespace thermorig::files
