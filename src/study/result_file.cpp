// SPDX-License-Identifier: MIT
#include "result_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "fingerprint.h"
#include "thermorig/core/error.h"

namespace thermorig::study {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_file_bytes = 4'000'000;

[[noreturn]] void refuse(const std::string& action, const fs::path& path) {
  throw Error(ExitCode::storage, fmt::format("{}: {}", action, std::strerror(errno)), path.string(),
              "check the folder and its disk, then run the study again: finished jobs are not repeated");
}

/// An open file or folder, closed when this goes.
class OpenFile {
 public:
  OpenFile(const fs::path& path, int flags, const std::string& action) : path_(path) {
    descriptor_ = ::open(path.c_str(), flags | O_CLOEXEC, 0644);
    if (descriptor_ < 0) refuse(action, path);
  }
  ~OpenFile() { ::close(descriptor_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  void write(std::string_view text) const {
    while (!text.empty()) {
      const ::ssize_t count = ::write(descriptor_, text.data(), text.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) refuse("cannot write the result", path_);
      text.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  std::string read() const {
    std::string text;
    char part[65536];
    while (text.size() <= max_file_bytes) {
      const ::ssize_t count = ::read(descriptor_, part, sizeof part);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) refuse("cannot read the result", path_);
      if (count == 0) break;
      text.append(part, static_cast<std::size_t>(count));
    }
    return text;
  }

  void sync() const {
    if (::fsync(descriptor_) != 0 && errno != EINVAL) refuse("cannot sync the result", path_);
  }

 private:
  fs::path path_;
  int descriptor_ = -1;
};

/// Only letters, digits, '-' and '_': a name in a session must not lead out of the folder.
std::string safe_name(const std::string& text) {
  std::string name = text.substr(0, 80);
  std::replace_if(
      name.begin(), name.end(),
      [](char c) {
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        return !letter && !(c >= '0' && c <= '9') && c != '-' && c != '_';
      },
      '_');
  return name;
}

/// Every field of a job on a line of its own.
std::string text_of(const Job& job) {
  return fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n", job.engine, job.frames,
                     job.reduction, job.fusion, job.seed, job.preset, job.settings, job.epochs, job.history,
                     job.test, job.test_hash, job.data_hash);
}

}  // namespace

std::string file_name_of(const Job& job) {
  constexpr std::size_t digits = 12;
  return fmt::format("{}_nf{}_nr{}_{}_{}_seed{}_{}.json", safe_name(job.test), job.frames, job.reduction,
                     job.fusion ? "fusion" : "thermal", safe_name(job.preset), job.seed,
                     fingerprint_of(text_of(job)).substr(0, digits));
}

void write_result(const fs::path& folder, const JobResult& result) {
  const fs::path path = folder / file_name_of(result.job);
  const fs::path part = path.string() + ".part";
  {
    const OpenFile file(part, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW, "cannot create the result");
    file.write(to_json(result));
    file.sync();
  }
  if (::rename(part.c_str(), path.c_str()) != 0) refuse("cannot name the result", path);
  OpenFile(folder, O_RDONLY | O_DIRECTORY, "cannot open the folder").sync();
}

JobResult read_result(const fs::path& path) {
  const OpenFile file(path, O_RDONLY | O_NONBLOCK, "cannot open the result");
  return result_from_json(file.read(), path.string());
}

std::optional<JobResult> find_result(const fs::path& folder, const Job& job) {
  const fs::path path = folder / file_name_of(job);
  std::error_code hidden;  // a folder that may not be searched: reading says so
  if (fs::status(path, hidden).type() == fs::file_type::not_found) return std::nullopt;
  JobResult result = read_result(path);
  if (result.job == job) return result;
  throw Error(ExitCode::not_a_session, "this result holds another job than its name says", path.string(),
              "delete it and run the study again: only this job is then repeated");
}

FolderLock::FolderLock(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure) {
    errno = failure.value();
    refuse("cannot make the folder", folder);
  }
  descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0) refuse("cannot open the folder", folder);
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  ::close(descriptor_);
  throw Error(ExitCode::no_permission, "another program is running a study in this folder", folder.string(),
              "wait until it has ended, or choose another folder with --output");
}

FolderLock::~FolderLock() {
  ::close(descriptor_);
}

}  // namespace thermorig::study
