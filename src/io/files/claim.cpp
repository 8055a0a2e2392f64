// SPDX-License-Identifier: MIT
#include "thermorig/io/files/claim.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <set>

#include "claim_text.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/part_file.h"

namespace thermorig::files {

namespace {

namespace fs = std::filesystem;

constexpr int most_numbers = 100'000;  // beyond it somebody plays with the folder
constexpr std::string_view sign_of_life = ".";

fs::path path_of(const fs::path& name, int number) {
  return fmt::format("{}.claim.{}", name.string(), number);
}

[[noreturn]] void refuse(const std::string& action, int error_number, const fs::path& path) {
  throw Error(ExitCode::storage, fmt::format("cannot {} a claim: {}", action, std::strerror(error_number)),
              path.string(), usual_advice(error_number));
}

bool is_there(const fs::path& path, Disk& disk) {
  const auto kind = disk.look(path);
  if (!kind.good()) refuse("look for", kind.error_number, path);
  return kind.value != FileKind::missing;
}

int newest_number(const fs::path& name, Disk& disk) {
  int number = 0;
  while (number < most_numbers && is_there(path_of(name, number + 1), disk)) ++number;
  if (number < most_numbers) return number;
  throw Error(ExitCode::storage, fmt::format("has been claimed {} times", number), name.string(),
              "remove its claims (.claim.*) while nobody runs it");
}

std::string read_at(OpenFile file, std::uint64_t offset, std::size_t bytes, Disk& disk,
                    const fs::path& path) {
  std::string text(bytes, '\0');
  const auto count = disk.read(file, offset, std::as_writable_bytes(std::span(text)));
  if (!count.good()) refuse("read", count.error_number, path);
  text.resize(count.value);
  return text;
}

/// Nothing if it was removed meanwhile; a network file system calls that stale.
std::optional<ClaimSight> sight_of(const fs::path& path, int number, Disk& disk) {
  const auto opened = disk.open(path);
  if (opened.error_number == ENOENT || opened.error_number == ESTALE) return std::nullopt;
  if (!opened.good()) refuse("open", opened.error_number, path);
  const ClosedOnExit file(disk, opened.value);
  const auto size = disk.size(file.get());
  if (size.error_number == ESTALE) return std::nullopt;
  if (!size.good()) refuse("read", size.error_number, path);
  const auto head = std::min<std::uint64_t>(size.value, longest_claim_text);
  const auto tail = std::min<std::uint64_t>(size.value, given_up_mark.size());
  ClaimSight sight = claim_from(read_at(file.get(), 0, static_cast<std::size_t>(head), disk, path));
  sight.number = number;
  sight.bytes = size.value;
  sight.given_up =
      read_at(file.get(), size.value - tail, static_cast<std::size_t>(tail), disk, path) == given_up_mark;
  return sight;
}

/// A link that leads nowhere counts as missing to those who look, and as taken to those who create: for ever.
void refuse_link(const fs::path& path, Disk& disk) {
  for (const FolderEntry& entry : disk.list(folder_of(path)).value)
    if (entry.kind == FileKind::other && entry.path == path)
      throw Error(ExitCode::storage, "a symbolic link stands where a claim is to be made", path.string(),
                  "nobody's claim is one: remove it");
}

std::string time_of_day() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace

std::string text_of(const ClaimSight& claim) {
  if (!claim.holder) return "a program that has not named itself yet";
  return fmt::format("{}, since {}", text_of(*claim.holder), claim.since_utc);
}

ClaimSight look_at_claim(const fs::path& name, Disk& disk) {
  const int number = newest_number(name, disk);
  if (number == 0) return {};
  return sight_of(path_of(name, number), number, disk).value_or(ClaimSight{});
}

void remove_claim(const fs::path& name, Disk& disk) {
  const std::string start = name.filename().string() + ".claim.";
  for (const FolderEntry& entry : disk.list(folder_of(name)).value)
    if (entry.path.filename().string().starts_with(start)) disk.remove(entry.path);
}

std::vector<fs::path> claimed_names(const fs::path& folder, Disk& disk) {
  std::set<fs::path> names;
  for (const FolderEntry& entry : disk.list(folder).value) {
    const std::string path = entry.path.string();
    const std::size_t mark = path.rfind(".claim.");
    if (mark != std::string::npos) names.insert(path.substr(0, mark));
  }
  return {names.begin(), names.end()};
}

bool ClaimWatch::is_still(const ClaimSight& claim, std::chrono::steady_clock::time_point now) {
  if (claim.number != number_ || claim.bytes != bytes_) {
    number_ = claim.number;
    bytes_ = claim.bytes;
    quiet_ = {};
  } else {
    quiet_ += std::min<std::chrono::steady_clock::duration>(now - looked_, 2 * timing_.beat);
  }
  looked_ = now;
  return quiet_ >= timing_.patience;
}

bool is_stale(const ClaimSight& claim, ClaimWatch& watch, std::chrono::steady_clock::time_point now) {
  const bool still = watch.is_still(claim, now);
  return still || (claim.holder && has_ended(*claim.holder));
}

std::optional<Claim> Claim::take(const fs::path& name, const ClaimSight& seen, Disk& disk) {
  const int number = seen.number + 1;
  const fs::path path = path_of(name, number);
  const std::string text = claim_text(this_process(), time_of_day());  // before: a kill leaves it empty
  const auto created = disk.create(path, 0644);
  if (created.error_number == EEXIST) {
    refuse_link(path, disk);
    return std::nullopt;
  }
  if (!created.good()) refuse("make", created.error_number, path);
  Claim claim(name, number, disk, created.value);
  const int written = claim.append(text);
  if (written == 0) return claim;
  claim.give_up();
  refuse("write", written, path);
}

int Claim::append(std::string_view text) {
  const auto written = append_all(*disk_, file_->get(), std::as_bytes(std::span(text)));
  // Other machines see what has reached the server.
  return written.good() ? disk_->sync(file_->get()) : written.error_number;
}

void Claim::beat() {
  append(sign_of_life);
}

bool Claim::is_taken_over() const {
  const auto kind = disk_->look(path_of(name_, number_ + 1));
  return kind.good() && kind.value != FileKind::missing;
}

void Claim::give_up() {
  append(given_up_mark);
}

void Claim::remove() {
  if (is_taken_over()) return;  // the next one is found by counting up to it
  for (int number = number_; number > 0; --number) disk_->remove(path_of(name_, number));
}

Claim take_alone(const fs::path& name, const std::string& does, const std::string& advice,
                 const ClaimTiming& timing, Disk& disk) {
  ClaimWatch watch(timing);
  const ClaimSight first = look_at_claim(name, disk);
  for (ClaimSight seen = first;; seen = look_at_claim(name, disk)) {
    if (seen.is_free() || is_stale(seen, watch, std::chrono::steady_clock::now())) {
      if (auto claim = Claim::take(name, seen, disk)) return *std::move(claim);
      continue;
    }
    const bool gave_sign = seen.number != first.number || seen.bytes != first.bytes;
    if (gave_sign || (seen.holder && life_of(*seen.holder) == Life::runs))
      throw Error(ExitCode::no_permission, fmt::format("{} {}", text_of(seen), does),
                  name.parent_path().string(), advice);
    std::this_thread::sleep_for(timing.beat / 4);
  }
}

BeatingClaim::BeatingClaim(Claim claim, const ClaimTiming& timing)
    : claim_(std::move(claim)), thread_([this, beat = timing.beat] { run(beat); }) {}

BeatingClaim::~BeatingClaim() {
  stop();
  if (!removed_) claim_.give_up();
}

void BeatingClaim::run(std::chrono::milliseconds beat) {
  std::unique_lock lock(mutex_);
  while (!stopped_.wait_for(lock, beat, [this] { return stopping_; })) {
    claim_.beat();
    taken_over_ = claim_.is_taken_over();
  }
}

void BeatingClaim::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stopped_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void BeatingClaim::remove() {
  stop();
  claim_.remove();
  removed_ = true;
}

}  // namespace thermorig::files
