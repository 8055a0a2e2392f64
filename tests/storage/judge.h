// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <unordered_map>

#include "recorded_session.h"

namespace thermorig::storage_test {

/// Chunks of each device.
using Chunks = PerDevice<std::size_t>;

/// What recovery made of a disk, held against what had really been received.
struct Found {
  bool has_session = false;
  bool is_loud = false;  // recovery said that something is amiss
  Chunks kept{};         // chunks in the session, the same as were received, in order
  std::size_t sent = 0;
  std::string wrong;    // a value that was never recorded, a session that does not open; else empty
  std::string said;     // by recovery, if it is loud
  std::string session;  // its path
};

/// Recovery on a disk in memory, as it is run after a crash.
Found recover_on(files::Disk& disk);

/// What becomes of images, each different one once. A disk with nothing but a journal on it is read as
/// recovery reads it; the session, which depends on nothing but what was read, is made of every so many-th
/// different recording. Any other disk is recovered whole.
class Judge {
 public:
  explicit Judge(const RecordedSession& truth, std::size_t recover_stride)
      : truth_(truth), recover_stride_(recover_stride) {}

  const Found& found(const DiskImage& image);
  /// By a whole recovery in any case.
  Found recovered(const DiskImage& image);

  std::size_t readings() const { return known_.size(); }
  std::size_t recoveries() const { return recoveries_; }
  /// Every so many-th session is written to this folder, with what must be read of it (FILE.expected: chunks
  /// and bytes of each device), for a stock reader.
  void keep_samples(const std::filesystem::path& folder, std::size_t every);

 private:
  std::optional<Found> read(const DiskImage& image);
  void keep_sample(const DiskImage& recovered, const Found& found);

  const RecordedSession& truth_;
  std::unordered_map<std::uint64_t, Found> known_;
  std::unordered_map<std::uint64_t, bool> recordings_;  // by what was read
  std::size_t recover_stride_;
  std::size_t recoveries_ = 0;
  std::filesystem::path samples_;
  std::size_t every_ = 0;
};

/// Clean: all that was promised is there. Loud: it is, and recovery says that something is amiss. Beyond:
/// less is there than was promised, and recovery says so. Silent: a value that was never recorded, a session
/// that does not open, or a loss that nobody speaks of.
enum class Outcome : std::uint8_t { clean, loud, beyond, silent };

/// `required`: chunks that must be there.
Outcome outcome_of(const Found& found, const Chunks& required);

}  // namespace thermorig::storage_test
