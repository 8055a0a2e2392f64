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
#include "thermorig/dataset/dataset.h"
#include "thermorig/session/trial.h"

namespace thermorig::dataset {

namespace {

namespace fs = std::filesystem;
using windows::Acquisition;

std::mutex hdf5_turn;  // the library may be in one thread at a time

session::Session read_in_turn(const fs::path& path) {
  const session::SealedCopy copy = session::tried_copy(path);  // by a process of its own: side by side
  const std::lock_guard turn(hdf5_turn);
  return session::read_session(copy);
}

Acquisition acquisition_at(const fs::path& path) {
  const session::Session session = read_in_turn(path);
  return acquisition_of(session, name_of(session.raw.header));
}

/// Files are taken in order; one thread's file is read while others hash theirs.
class Reading {
 public:
  Reading(const std::vector<fs::path>& files, const std::function<void(std::size_t, std::size_t)>& progress)
      : files_(files), progress_(progress), acquisitions_(files.size()), failures_(files.size()) {}

  void work() {
    while (!failed_) {
      const std::size_t index = next_++;  // who has taken one reads it, so that the first failure is the same
      if (index >= files_.size()) return;
      read(index);
    }
  }

  /// Throws what went wrong with the first of the files.
  std::vector<Acquisition> result() {
    for (const std::exception_ptr& failure : failures_)
      if (failure) std::rethrow_exception(failure);
    return std::move(acquisitions_);
  }

 private:
  void read(std::size_t index) {
    try {
      acquisitions_[index] = acquisition_at(files_[index]);
      const std::lock_guard turn(progress_turn_);
      ++done_;
      if (progress_) progress_(done_, files_.size());
    } catch (...) {
      failures_[index] = std::current_exception();
      failed_ = true;
    }
  }

  const std::vector<fs::path>& files_;
  const std::function<void(std::size_t, std::size_t)>& progress_;
  std::vector<Acquisition> acquisitions_;
  std::vector<std::exception_ptr> failures_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex progress_turn_;
  std::size_t done_ = 0;
};

void refuse_copies(const std::vector<Acquisition>& acquisitions, const std::vector<fs::path>& files) {
  std::map<std::string, std::size_t> seen;
  for (std::size_t index = 0; index < files.size(); ++index) {
    const auto [first, is_new] = seen.emplace(acquisitions[index].hash, index);
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

}  // namespace

Acquisition read_acquisition(const fs::path& path) {
  return acquisition_at(path);
}

std::vector<Acquisition> read_acquisitions(
    const std::vector<fs::path>& files,
    const std::function<void(std::size_t done, std::size_t all)>& progress) {
  Reading reading(files, progress);
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < std::min(cores, files.size()); ++i)
    others.emplace_back([&reading] { reading.work(); });
  reading.work();
  others.clear();  // waits for them
  std::vector<Acquisition> acquisitions = reading.result();
  refuse_copies(acquisitions, files);
  sort_by_name(acquisitions);
  return acquisitions;
}

}  // namespace thermorig::dataset
