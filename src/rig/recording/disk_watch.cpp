// SPDX-License-Identifier: MIT
#include "disk_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::rig {

namespace {

constexpr auto look_period = std::chrono::seconds(1);
constexpr auto late_told_period = std::chrono::seconds(10);
constexpr std::uint64_t smallest_step = 1U << 20U;

double megabytes(std::uint64_t bytes) {
  return static_cast<double>(bytes) / 1e6;
}

RecordingEvent warning(HostTime now, std::string message) {
  return {now, EventKind::warning, std::nullopt, std::move(message)};
}

std::string when_synced(HostDuration period) {
  return period == HostDuration::zero() ? "at the end" : fmt::format("every {:.0f} ms", to_s(period) * 1e3);
}

/// As `doctor` judges a disk; else the sync began late: the computer was busy.
bool is_of_disk(const LateSync& late, HostDuration period) {
  return late.lasted > period;
}

std::string text_of(const LateSync& late, HostDuration period) {
  const std::string cause = is_of_disk(late, period)
                                ? fmt::format("the disk is slow: a sync took {:.0f} ms (limit {:.0f})",
                                              to_s(late.lasted) * 1e3, to_s(period) * 1e3)
                                : std::string("this computer is busy: a sync came late");
  return fmt::format("{}; data of {:.0f} ms was not on the disk (a power cut would have lost it)", cause,
                     to_s(late.waited) * 1e3);
}

}  // namespace

void require_space(files::Disk& disk, const std::filesystem::path& path, std::uint64_t needed) {
  const auto free = disk.free_bytes(files::folder_of(path));
  if (!free.good() || free.value >= needed) return;  // unknown: let the writes tell
  throw Error(ExitCode::storage,
              fmt::format("not enough space for the recording and its session: {:.1f} MB needed, {:.1f} MB "
                          "free, {:.1f} MB missing",
                          megabytes(needed), megabytes(free.value), megabytes(needed - free.value)),
              path.string(), "free some space, or record to another disk with --output");
}

DiskWatch::DiskWatch(journal::JournalWriter& journal, HostDuration period)
    : journal_(journal), sync_period_(period), step_(std::max(smallest_step, journal.reserved() / 8)) {}

std::vector<RecordingEvent> DiskWatch::look(HostTime now, const std::optional<LateSync>& late) {
  std::vector<RecordingEvent> said;
  const bool is_told = late && (is_of_disk(*late, sync_period_) || late->waited > 2 * sync_period_);
  if (is_told && now >= next_late_) {
    next_late_ = now + late_told_period;
    said.push_back(warning(now, text_of(*late, sync_period_)));
  }
  if (!next_look_)
    said.push_back(
        {now, EventKind::info, std::nullopt,
         fmt::format(
             "saved to disk {}; {:.1f} MB {}", when_synced(sync_period_), megabytes(journal_.reserved()),
             journal_.can_reserve() ? "reserved" : "expected (this file system cannot reserve them)")});
  if (next_look_ && now < *next_look_) return said;
  next_look_ = now + look_period;
  look_at_reserve(now, said);
  look_at_space(now, said);
  return said;
}

void DiskWatch::look_at_reserve(HostTime now, std::vector<RecordingEvent>& said) {
  if (journal_.bytes_written() + step_ / 2 <= journal_.reserved()) return;
  const std::uint64_t wanted = std::max(journal_.reserved(), journal_.bytes_written()) + step_;
  if (journal_.reserve(wanted)) {
    reserve_told_ = false;
    return;
  }
  if (std::exchange(reserve_told_, true)) return;
  const std::uint64_t left = journal_.reserved() - std::min(journal_.reserved(), journal_.bytes_written());
  said.push_back(warning(now, fmt::format("the disk is nearly full: {:.1f} MB are left of what is reserved "
                                          "for the recording, and no more can be reserved",
                                          megabytes(left))));
}

void DiskWatch::look_at_space(HostTime now, std::vector<RecordingEvent>& said) {
  const std::uint64_t expected = std::max(journal_.bytes_written(), journal_.reserved());
  const std::uint64_t unwritten = journal_.can_reserve() ? 0 : expected - journal_.bytes_written();
  const std::uint64_t needed = unwritten + session_bytes_beside(expected);
  const std::uint64_t free = journal_.free_bytes();
  if (free >= needed) {
    space_told_ = false;
    return;
  }
  if (std::exchange(space_told_, true)) return;
  said.push_back(warning(
      now, fmt::format("the disk is nearly full: {:.1f} MB are free, but the session{} needs up to {:.1f} MB",
                       megabytes(free), unwritten > 0 ? " and the rest of the recording" : "",
                       megabytes(needed))));
}

}  // namespace thermorig::rig
