// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "thermorig/io/files/part_file.h"
#include "thermorig/learning/interchange/formats.h"

namespace thermorig::app {

/// Makes the folder of a file that is to be written, where it is missing. Throws Error(storage), also if
/// there is something of that name: nothing is overwritten. `advice`: what to try then.
void require_new(const std::filesystem::path& path,
                 const std::string& advice = "another folder with -o, or remove it first");

/// A file that is written bit by bit, and has its name once it is whole. All members throw Error(storage).
class ExportFile final : public interchange::Sink {
 public:
  explicit ExportFile(const std::filesystem::path& path);

  using Sink::write;
  void write(std::span<const std::byte> bytes) override;
  void publish();

 private:
  files::PartFile part_;
};

/// A file that is to be written.
struct NewFile {
  std::filesystem::path path;
  std::string bytes;
};

/// Writes all or none, in folders that are made where they are missing. Nothing is overwritten. Throws
/// Error(storage).
void write_new_files(const std::vector<NewFile>& files);

}  // namespace thermorig::app
