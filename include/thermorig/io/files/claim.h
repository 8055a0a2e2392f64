// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "thermorig/io/files/disk.h"
#include "thermorig/io/files/process.h"

namespace thermorig::files {

// Who works on something that programs of several machines share over a disk: `NAME.claim.N`, the newest N
// counts. See docs/decisions/0016-claims-on-a-shared-disk.md.

/// How often a claim gives a sign of life, and for how long another program looks for one in vain before it
/// takes the claim over.
struct ClaimTiming {
  std::chrono::milliseconds beat{5'000};
  std::chrono::milliseconds patience{60'000};
};

/// What a claim's newest file says at one moment. Its text is hostile: of what is no claim, or not whole yet,
/// the holder is not known.
struct ClaimSight {
  int number = 0;  // N; 0: nobody has ever claimed it
  std::optional<Process> holder;
  std::string since_utc;    // when it was claimed, by the holder's clock: for people
  std::uint64_t bytes = 0;  // of the file: it grows while the holder lives
  bool given_up = false;

  bool is_free() const { return number == 0 || given_up; }
};

/// "node7, process 4711, since 2026-11-24T03:49:01Z".
std::string text_of(const ClaimSight& claim);

/// `name`: path without ".claim.N". Throws Error(storage) where it cannot be looked at.
ClaimSight look_at_claim(const std::filesystem::path& name, Disk& disk = real_disk());

/// Removes what is left of a claim once nobody can want it any more, since what it was for is there. What
/// cannot be removed is left.
void remove_claim(const std::filesystem::path& name, Disk& disk = real_disk());

/// Of all claims in a folder the names, as above, each once and sorted. None where the folder cannot be read.
std::vector<std::filesystem::path> claimed_names(const std::filesystem::path& folder,
                                                 Disk& disk = real_disk());

/// Tells whether the holder of one claim lives, from looking at it again and again. It compares no clocks of
/// two machines, and a time in which nobody looked counts for two beats at most: then this machine may have
/// stood still, or the disk.
class ClaimWatch {
 public:
  explicit ClaimWatch(const ClaimTiming& timing = {}) : timing_(timing) {}

  /// Has the claim not changed for as long as patience goes? `now`: of a clock of this program, which never
  /// goes back.
  bool is_still(const ClaimSight& claim, std::chrono::steady_clock::time_point now);

 private:
  ClaimTiming timing_;
  int number_ = 0;
  std::uint64_t bytes_ = 0;
  std::chrono::steady_clock::time_point looked_{};
  std::chrono::steady_clock::duration quiet_{};
};

/// May a claim be taken over: does its watch say that it is still, or its machine, which is this one, that
/// the process has ended?
bool is_stale(const ClaimSight& claim, ClaimWatch& watch, std::chrono::steady_clock::time_point now);

/// A claim that this process holds. It stays on the disk as it is when this goes: as after a kill.
class Claim {
 public:
  /// Claims `name` after what was seen of it, which must be free or stale. None where another program was
  /// faster: of any number of programs that have seen the same, one gets it. Throws Error(storage).
  static std::optional<Claim> take(const std::filesystem::path& name, const ClaimSight& seen,
                                   Disk& disk = real_disk());

  /// Gives a sign of life. A disk that takes it not is tried again at the next.
  void beat();

  /// Has another program taken it over, as this one gave no sign of life for too long?
  bool is_taken_over() const;

  /// The next may have it at once.
  void give_up();

  /// What it was for is done and on the disk. One that was taken over is left to that program.
  void remove();

 private:
  Claim(std::filesystem::path name, int number, Disk& disk, OpenFile file)
      : name_(std::move(name)), number_(number), disk_(&disk), file_(new ClosedOnExit(disk, file)) {}
  int append(std::string_view text);

  std::filesystem::path name_;
  int number_;
  Disk* disk_;
  std::unique_ptr<ClosedOnExit> file_;
};

/// Claims something that only one program may work on, for which others do not wait. Where it is not known
/// whether a holder lives, looks for a sign of life for as long as patience goes. Throws
/// Error(no_permission), with who `does` it ("trains in this folder") and `advice`.
Claim take_alone(const std::filesystem::path& name, const std::string& does, const std::string& advice,
                 const ClaimTiming& timing = {}, Disk& disk = real_disk());

/// A claim that gives its signs of life in a thread of its own, and is given up when this goes.
class BeatingClaim {
 public:
  explicit BeatingClaim(Claim claim, const ClaimTiming& timing = {});
  ~BeatingClaim();
  BeatingClaim(const BeatingClaim&) = delete;
  BeatingClaim& operator=(const BeatingClaim&) = delete;

  /// As of the last beat.
  bool is_taken_over() const { return taken_over_; }

  /// What it was for is done and on the disk.
  void remove();

 private:
  void run(std::chrono::milliseconds beat);
  void stop();

  Claim claim_;
  bool removed_ = false;
  std::atomic<bool> taken_over_ = false;
  std::mutex mutex_;
  std::condition_variable stopped_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace thermorig::files
