// SPDX-License-Identifier: MIT
#include "export_files.h"

#include <list>
#include <span>

#include "thermorig/core/error.h"

namespace thermorig::app {

namespace {

void require_folder(const std::filesystem::path& folder) {
  std::error_code failure;
  if (!folder.empty()) std::filesystem::create_directories(folder, failure);
  if (failure)
    throw Error(ExitCode::storage, "the folder cannot be made: " + failure.message(), folder.string(),
                files::usual_advice(failure.value()));
}

void require_absent(const std::filesystem::path& path, const std::string& advice) {
  std::error_code hidden;  // a folder that may not be searched: creating the file says so
  if (!std::filesystem::exists(std::filesystem::symlink_status(path, hidden))) return;
  throw Error(ExitCode::storage, "it exists already, and nothing is overwritten", path.string(), advice);
}

}  // namespace

void require_new(const std::filesystem::path& path, const std::string& advice) {
  require_folder(path.parent_path());
  require_absent(path, advice);
}

ExportFile::ExportFile(const std::filesystem::path& path) : part_(path, "the export") {}

void ExportFile::write(std::span<const std::byte> bytes) {
  part_.write(bytes);
}

void ExportFile::publish() {
  part_.sync();
  part_.publish();
}

void write_new_files(const std::vector<NewFile>& files) {
  for (const NewFile& file : files) require_new(file.path);
  std::list<ExportFile> parts;
  for (const NewFile& file : files) parts.emplace_back(file.path).write(std::string_view(file.bytes));
  for (ExportFile& part : parts) part.publish();
}

}  // namespace thermorig::app
