// SPDX-License-Identifier: MIT
#include "judge.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "support/stored_bytes.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::storage_test {

namespace {

namespace fs = std::filesystem;

template <typename Value>
bool begins_with(const std::vector<Value>& whole, const std::vector<Value>& front) {
  return front.size() <= whole.size() && std::equal(front.begin(), front.end(), whole.begin());
}

bool is_front_of(const RawStream& front, const RawStream& whole) {
  const std::size_t bytes = front.chunk_end.empty() ? 0 : front.chunk_end.back();
  return front.bytes.size() == bytes && begins_with(whole.bytes, front.bytes) &&
         begins_with(whole.chunk_end, front.chunk_end) && begins_with(whole.time_ns, front.time_ns);
}

/// What happened to the rig; what is said of the disk depends on the disk.
std::vector<RecordingEvent> of_the_rig(const std::vector<RecordingEvent>& events) {
  std::vector<RecordingEvent> kept;
  std::copy_if(events.begin(), events.end(), std::back_inserter(kept), [](const RecordingEvent& event) {
    return event.kind != EventKind::info && event.kind != EventKind::warning;
  });
  return kept;
}

bool are_front_of(const std::vector<RecordingEvent>& front, const std::vector<RecordingEvent>& whole) {
  return front.size() <= whole.size() &&
         std::equal(front.begin(), front.end(), whole.begin(), [](const auto& a, const auto& b) {
           return a.time == b.time && a.kind == b.kind && a.source == b.source && a.message == b.message;
         });
}

std::string what_is_wrong(const RawRecording& raw, const RecordedSession& truth) {
  for (const Device device : all_devices)
    if (!is_front_of(raw.received[device], truth.received[device].chunks))
      return "chunks that the " + std::string(name_of(device)) + " never sent";
  for (const Device device : all_devices)
    if (!is_front_of(raw.sent[device], truth.sent[device].chunks))
      return "bytes that were never sent to the " + std::string(name_of(device));
  if (!are_front_of(of_the_rig(raw.events), of_the_rig(truth.raw.events)))
    return "events that never happened";
  if (raw.header.environment != "kitchen" || raw.header.acquisition != 1) return "another header";
  return {};
}

session::Session read_image(const Bytes& bytes, const fs::path& path) {
  return session::read_session(tests::stored_bytes(std::as_bytes(std::span(bytes)), path));
}

Bytes bytes_of(files::Disk& disk, const fs::path& path) {
  const files::ClosedOnExit file(disk, disk.open(path).value);
  Bytes bytes(disk.size(file.get()).value);
  disk.read(file.get(), 0, bytes);
  return bytes;
}

void read_session(files::Disk& disk, const RecordedSession& truth, Found& found) {
  try {
    const session::Session session = read_image(bytes_of(disk, found.session), found.session);
    found.has_session = true;
    found.wrong = what_is_wrong(session.raw, truth);
    found.sent = session.raw.sent[Device::servo].chunk_count();
    for (const Device device : all_devices) found.kept[device] = session.raw.received[device].chunk_count();
    const bool is_whole = std::all_of(all_devices.begin(), all_devices.end(), [&](Device device) {
      return found.kept[device] == truth.received[device].calls.size();
    });
    if (session.state != session::State::recovered && !is_whole) found.wrong = "passes for a whole session";
  } catch (const Error& error) {
    found.wrong = std::string("a session that does not open: ") + error.what();
  }
}

}  // namespace

Found recover_on(files::Disk& disk) {
  Found found;
  try {
    for (const rig::RecoveryResult& result : rig::recover(output_folder, disk)) {
      const bool is_good = result.kind == rig::RecoveryKind::made ||
                           result.kind == rig::RecoveryKind::already_there ||
                           result.kind == rig::RecoveryKind::empty;
      found.is_loud = found.is_loud || !is_good || result.bytes_ignored > 0;
      if (!is_good) found.said = result.message;
    }
  } catch (const Error& error) {
    if (error.code() == ExitCode::bad_usage) return found;  // there is not even a folder
    found.is_loud = true;
    found.said = error.what();
  }
  return found;
}

namespace {

/// The session that lies there now.
void look_for_session(const RecordedSession& truth, MemoryDisk& disk, Found& found) {
  for (const auto& [path, bytes] : disk.after_end().files) {
    if (fs::path(path).extension() != ".h5") continue;
    found.session = path;
    read_session(disk, truth, found);
  }
}

}  // namespace

Found Judge::recovered(const DiskImage& image) {
  MemoryDisk disk(image);
  Found found = recover_on(disk);
  look_for_session(truth_, disk, found);
  ++recoveries_;
  if (every_ > 0 && found.has_session && recoveries_ % every_ == 0) keep_sample(disk.after_end(), found);
  return found;
}

/// None: it has to be recovered whole.
std::optional<Found> Judge::read(const DiskImage& image) {
  if (image.files.size() != 1) return std::nullopt;
  const fs::path journal = image.files.begin()->first;
  if (journal.extension() != ".journal") return std::nullopt;
  MemoryDisk disk(image);
  try {
    const journal::JournalContents contents = journal::read_journal(journal, disk);
    const bool is_torn = contents.bytes_ignored > 0;
    const bool is_new = recordings_.try_emplace(contents.records * 2 + is_torn).second;
    if (is_new && recordings_.size() % recover_stride_ == 1) return std::nullopt;
    Found found;
    found.is_loud = is_torn;
    found.wrong = what_is_wrong(contents.recording, truth_);
    found.sent = contents.recording.sent[Device::servo].chunk_count();
    for (const Device device : all_devices)
      found.kept[device] = contents.recording.received[device].chunk_count();
    return found;
  } catch (const Error&) {
    return std::nullopt;  // no header
  }
}

const Found& Judge::found(const DiskImage& image) {
  const auto [at, is_new] = known_.try_emplace(image.hash());
  if (!is_new) return at->second;
  const auto read_only = read(image);
  at->second = read_only ? *read_only : recovered(image);
  return at->second;
}

void Judge::keep_samples(const fs::path& folder, std::size_t every) {
  samples_ = folder;
  every_ = every;
}

void Judge::keep_sample(const DiskImage& recovered, const Found& found) {
  const fs::path path = samples_ / (std::to_string(::getpid()) + "-" + std::to_string(recoveries_) + ".h5");
  const Bytes& bytes = *recovered.files.at(found.session);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  std::ofstream expected(path.string() + ".expected");
  for (const Device device : all_devices) {
    const auto& ends = truth_.received[device].chunks.chunk_end;
    const std::size_t chunks = found.kept[device];
    expected << name_of(device) << ' ' << chunks << ' ' << (chunks > 0 ? ends[chunks - 1] : 0) << '\n';
  }
}

Outcome outcome_of(const Found& found, const Chunks& required) {
  if (!found.wrong.empty()) return Outcome::silent;
  for (const Device device : all_devices)
    if (found.kept[device] < required[device]) return found.is_loud ? Outcome::beyond : Outcome::silent;
  return found.is_loud ? Outcome::loud : Outcome::clean;
}

}  // namespace thermorig::storage_test
