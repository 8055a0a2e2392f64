// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "file_driver.h"
#include "format.h"
#include "group_reader.h"
#include "recording_columns.h"
#include "thermorig/storage/session/annotations.h"
#include "thermorig/storage/session/session.h"
#include "thermorig/storage/session/trial.h"
#include "trial.h"

namespace thermorig::session {

/// A session file that has shown its format; gives access to its groups.
class SessionFile {
 public:
  /// `source` must outlive this.
  explicit SessionFile(DriverSource& source);

  hid_t id() const { return file_.get(); }
  const std::filesystem::path& path() const { return path_; }

  GroupReader group(const std::string& path) const { return GroupReader(id(), path, facts_); }

  bool has_group(const std::string& path) const {
    return check(H5Lexists(id(), path.c_str(), H5P_DEFAULT), "look for groups") > 0;
  }

  RecordingHeader read_header();

  /// As it stands in the file; of use after read_header().
  const std::string& header_text() const { return header_text_; }

  FormatVersion version() const { return facts_.version; }
  bool is_cut() const { return facts_.is_cut(); }

 private:
  /// HDF5 does not look beyond the end that the file states: what was appended would travel with the session,
  /// unseen.
  void require_nothing_behind(std::uint64_t end) const;

  /// Other readers may change what stands in attributes: these must be what was written.
  RigProfile profile() const;

  /// What the attribute says, not the header: owners of data state the licence of files that they have.
  std::string licence() const;

  std::filesystem::path path_;
  FileFacts facts_;
  Handle file_;
  std::string header_text_;
};

/// Chunks that follow each other and end with the last byte, at times that a recording can have.
template <typename Stream>
void read_stream(const SessionFile& file, const std::string& name, const char* time_name, HostTime reference,
                 Stream& stream) {
  auto group = file.group("/raw/" + name);
  std::uint64_t end = 0;
  const auto set_end = [&](std::uint64_t& at, std::uint64_t chunk_end) {
    if (chunk_end < end) throw Hdf5Failure("believe the chunks of /raw/" + name);
    at = end = chunk_end;
  };
  const auto set_time = [&](std::int64_t& at, std::int64_t ns) {
    if (!is_of_recording(host_time_ns(ns), reference)) throw Hdf5Failure("believe the times of /raw/" + name);
    at = ns;
  };
  raw_columns(group, stream, time_name, "", set_end, set_time);
  if (end != stream.bytes.size() && !file.is_cut()) throw Hdf5Failure("believe the chunks of /raw/" + name);
}

/// Of a live run; other sessions have none. Before format 2 the header named no estimators.
std::vector<EstimateRow> read_estimates(const SessionFile& file, RecordingHeader& header);

/// What was said of it afterwards; most sessions have none.
std::vector<Annotation> read_annotations(const SessionFile& file);

/// Who holds hdf5_turn() reads. `end`: of the file.
template <typename Read>
auto read_or_explain(const StoredFile& stored, std::uint64_t end, Read read) {
  DriverSource source{&stored, end, 0, nullptr};
  try {
    prepare_hdf5();
    const ClearedErrors cleared;
    SessionFile file(source);
    return read(file);
  } catch (const Hdf5Failure& failure) {
    if (source.failure) std::rethrow_exception(source.failure);
    refuse(stored.path(), failure.what());
  } catch (const std::bad_alloc&) {
    refuse(stored.path(), "claims to be larger than the memory of this computer");
  }
}

/// A child process first, if one tries files; it begins while no other thread is in the library.
template <typename Read>
void try_first(const StoredFile& stored, std::uint64_t end, Read read) {
  if (!are_sessions_tried()) return;
  std::unique_lock turn(hdf5_turn());
  Trial trial(stored, [&] { read_or_explain(stored, end, read); });
  turn.unlock();
  trial.require_good();
}

template <typename Read>
auto read_in_turn(const StoredFile& stored, std::uint64_t end, Read read) {
  const std::lock_guard turn(hdf5_turn());
  return read_or_explain(stored, end, read);
}

}  // namespace thermorig::session
