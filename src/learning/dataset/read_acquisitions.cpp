// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <mutex>
#include <thread>
#include <tuple>

#include "session_name.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/dataset/dataset.h"
#include "thermorig/storage/session/trial.h"

namespace thermorig::dataset {

namespace {

namespace fs = std::filesystem;
using network::Acquisition;

std::mutex hdf5_turn;  // the library may be in one thread at a time

session::Session read_in_turn(const fs::path& path) {
  const sandbox::SealedCopy copy = session::tried_copy(path);  // by a process of its own: side by side
  const std::lock_guard turn(hdf5_turn);
  return session::read_session(copy);
}

Acquisition acquisition_in(const session::Session& session, Estimates estimates) {
  return acquisition_of(session, name_of(session.raw.header), estimates);
}

/// What became of one file.
struct FileRead {
  std::optional<Acquisition> acquisition;  // none: its session is for a calibration
  std::optional<BadSession> bad;
};

FileRead read_file(const fs::path& path, Estimates estimates) {
  const session::Session session = read_in_turn(path);
  if (session::is_for_calibration(session.raw.header)) return {};
  return {acquisition_in(session, estimates), bad_session(session, path)};
}

/// Files are taken in order; one thread's file is read while others hash theirs.
class Reading {
 public:
  Reading(const std::vector<fs::path>& files, Estimates estimates,
          const std::function<void(std::size_t, std::size_t)>& progress)
      : files_(files),
        estimates_(estimates),
        progress_(progress),
        reads_(files.size()),
        failures_(files.size()) {}

  void work() {
    while (!failed_) {
      const std::size_t index = next_++;  // who has taken one reads it, so that the first failure is the same
      if (index >= files_.size()) return;
      read(index);
    }
  }

  /// Throws what went wrong with the first of the files.
  std::vector<FileRead> result() {
    for (const std::exception_ptr& failure : failures_)
      if (failure) std::rethrow_exception(failure);
    return std::move(reads_);
  }

 private:
  void read(std::size_t index) {
    try {
      reads_[index] = read_file(files_[index], estimates_);
      const std::lock_guard turn(progress_turn_);
      ++done_;
      if (progress_) progress_(done_, files_.size());
    } catch (...) {
      failures_[index] = std::current_exception();
      failed_ = true;
    }
  }

  const std::vector<fs::path>& files_;
  Estimates estimates_;
  const std::function<void(std::size_t, std::size_t)>& progress_;
  std::vector<FileRead> reads_;
  std::vector<std::exception_ptr> failures_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex progress_turn_;
  std::size_t done_ = 0;
};

void refuse_copies(const std::vector<FileRead>& reads, const std::vector<fs::path>& files) {
  std::map<std::string, std::size_t> seen;
  for (std::size_t index = 0; index < files.size(); ++index) {
    if (!reads[index].acquisition) continue;
    const auto [first, is_new] = seen.emplace(reads[index].acquisition->hash, index);
    if (is_new) continue;
    throw Error(ExitCode::not_a_session, "holds the same recording as " + files[first->second].string(),
                files[index].string(),
                "name one of the two only: a copy in training and test falsifies both");
  }
}

void sort_by_name(std::vector<Acquisition>& acquisitions) {
  const auto key = [](const Acquisition& a) { return std::tie(a.environment, a.number, a.name, a.hash); };
  std::sort(acquisitions.begin(), acquisitions.end(),
            [&](const Acquisition& a, const Acquisition& b) { return key(a) < key(b); });
}

Acquisitions sorted_out(std::vector<FileRead> reads, const std::vector<fs::path>& files) {
  Acquisitions sorted;
  for (std::size_t index = 0; index < files.size(); ++index) {
    FileRead& read = reads[index];
    if (!read.acquisition) sorted.for_calibration.push_back(files[index]);
    if (read.acquisition) sorted.acquisitions.push_back(std::move(*read.acquisition));
    if (read.bad) sorted.bad.push_back(std::move(*read.bad));
  }
  sort_by_name(sorted.acquisitions);
  return sorted;
}

}  // namespace

std::optional<BadSession> bad_session(const session::Session& session, const fs::path& file) {
  session::Quality quality = session::quality_of(session);
  if (quality.verdict != "bad") return std::nullopt;
  return BadSession{file, std::move(quality.verdict_reasons)};
}

Acquisition read_acquisition(const fs::path& path) {
  return acquisition_in(read_in_turn(path), Estimates::made);
}

Acquisitions read_acquisitions(const std::vector<fs::path>& files, Estimates estimates,
                               const std::function<void(std::size_t done, std::size_t all)>& progress) {
  Reading reading(files, estimates, progress);
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < std::min(cores, files.size()); ++i)
    others.emplace_back([&reading] { reading.work(); });
  reading.work();
  others.clear();  // waits for them
  std::vector<FileRead> reads = reading.result();
  refuse_copies(reads, files);
  return sorted_out(std::move(reads), files);
}

}  // namespace thermorig::dataset
