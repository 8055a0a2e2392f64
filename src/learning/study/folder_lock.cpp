// SPDX-License-Identifier: MIT
#include "folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "thermorig/core/error.h"

namespace thermorig::study {

namespace {

[[noreturn]] void refuse(const std::string& reason, const std::filesystem::path& folder) {
  throw Error(ExitCode::storage, "cannot make the folder of results: " + reason, folder.string(),
              "choose another folder with --output");
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) refuse(failure.message(), folder);
  descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0) refuse(std::generic_category().message(errno), folder);
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  ::close(descriptor_);
  throw Error(ExitCode::no_permission, "another program is running a study in this folder", folder.string(),
              "wait until it has ended, or choose another folder with --output");
}

FolderLock::~FolderLock() {
  ::close(descriptor_);
}

}  // namespace thermorig::study
