// SPDX-License-Identifier: MIT
#include "export_files.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "thermorig/core/error.h"

namespace thermorig::app {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, int reason) {
  if (reason == EEXIST)
    throw Error(ExitCode::storage, "it exists already, and nothing is overwritten", path.string(),
                "another folder with -o, or remove it first");
  throw Error(ExitCode::storage, fmt::format("it cannot be written: {}", std::strerror(reason)),
              path.string(), "a folder that can be written to, with -o");
}

void require_folder(const std::filesystem::path& folder) {
  std::error_code failure;
  if (!folder.empty()) std::filesystem::create_directories(folder, failure);
  if (failure) refuse(folder, failure.value() == EEXIST ? ENOTDIR : failure.value());
}

/// Errno, 0 if it was written. A file that was there is left alone.
int write_new(const NewFile& file) {
  std::FILE* stream = std::fopen(file.path.c_str(), "wbxe");  // x: must not exist
  if (stream == nullptr) return errno;
  const bool whole = std::fwrite(file.bytes.data(), 1, file.bytes.size(), stream) == file.bytes.size();
  const int reason = errno;
  if (std::fclose(stream) == 0 && whole) return 0;
  const int failure = whole ? errno : reason;
  std::remove(file.path.c_str());
  return failure;
}

}  // namespace

void write_new_files(const std::vector<NewFile>& files) {
  for (std::size_t done = 0; done < files.size(); ++done) {
    require_folder(files[done].path.parent_path());
    const int failure = write_new(files[done]);
    if (failure == 0) continue;
    for (std::size_t i = 0; i < done; ++i) std::remove(files[i].path.c_str());
    refuse(files[done].path, failure);
  }
}

}  // namespace thermorig::app
