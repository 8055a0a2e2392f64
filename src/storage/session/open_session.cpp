// SPDX-License-Identifier: MIT
#include "open_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "attributes.h"
#include "estimate_columns.h"
#include "profile_attributes.h"
#include "stored_attributes.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/recording_header/header_json.h"
#include "thermorig/storage/session/salvage.h"

namespace thermorig::session {

namespace {

namespace fs = std::filesystem;

/// "<major>.<minor>.<patch>", of a major version that this program reads.
std::optional<FormatVersion> version_of(const std::string& text) {
  FormatVersion version;
  unsigned patch = 0;
  char behind = 0;
  const int fields =
      std::sscanf(text.c_str(), "%3u.%3u.%3u%c", &version.major, &version.minor, &patch, &behind);
  if (fields != 3 || version.major < first_format_major || version.major > format_version.major)
    return std::nullopt;
  return version;
}

}  // namespace

SessionFile::SessionFile(DriverSource& source) : path_(source.file->path()) {
  const fs::path& path = path_;
  facts_.bytes = source.end;
  facts_.bytes_there = source.file->size();
  if (source.end == 0) refuse(path, "is empty");
  if (!is_cut()) require_whole(*source.file);
  file_ = open_to_read(source, "open it as HDF5");
  require_nothing_behind(source.used);
  if (!has_attribute(id(), "format") || get_text_attribute(id(), "format") != format_name)
    refuse(path, "is HDF5, but not a thermorig session");
  const std::string version = get_text_attribute(id(), "format_version");
  const auto known = version_of(version);
  if (!known)
    refuse(path, fmt::format("is a session of format version {}, and this program reads versions {} to {}",
                             version, first_format_major, format_version.major));
  facts_.version = *known;
}

RecordingHeader SessionFile::read_header() {
  using recording_header::ProfileAndPlan;
  const bool is_apart = version() >= with_profile_apart;
  header_text_ = get_text_attribute(group("/rig").id(), "header_json");
  auto header = recording_header::header_from_json_text(
      header_text_, path_.string(), is_apart ? ProfileAndPlan::elsewhere : ProfileAndPlan::in_header);
  if (is_apart) {
    header.profile = profile();
    header.plan_toml = group("/rig").text(plan_column);
  }
  facts_.reference = header.time_reference;
  header.licence = licence();
  return header;
}

void SessionFile::require_nothing_behind(std::uint64_t end) const {
  if (end < facts_.bytes)
    refuse(path_, fmt::format("ends after {} bytes, and {} more stand behind", end, facts_.bytes - end));
}

RigProfile SessionFile::profile() const {
  if (facts_.is_cut()) return read_profile(id(), path_);  // the sums are written last
  const std::string sums = group("/quality").text(attribute_sums_column);
  const std::vector<std::string> altered = altered_attributes(id(), profile_group, sums);
  if (!altered.empty()) throw Hdf5Failure("believe " + altered.front() + ": it differs from its checksum");
  return read_profile(id(), path_);
}

std::string SessionFile::licence() const {
  if (!has_attribute(id(), "license")) return "";
  std::string licence = get_text_attribute(id(), "license");
  if (licence.empty() || licence == licence_not_stated) return "";
  if (!recording_header::is_line(licence))
    refuse(path_, "has an attribute `license` that is not a line of up to 1000 bytes of UTF-8");
  return licence;
}

std::vector<EstimateRow> read_estimates(const SessionFile& file, RecordingHeader& header) {
  std::vector<EstimateRow> rows;
  if (!file.has_group("/estimates")) return rows;
  auto group = file.group("/estimates");
  estimate_row_columns(group, rows);
  if (file.version() < with_named_estimators) {
    estimate_columns_before_format_2(group, rows);
    header.estimators = columns_before_format_2(header.live_model);
  } else {
    estimate_columns_by_name(group, rows, EstimateAxes(header.estimators));
  }
  const auto not_ascending = [](const EstimateRow& a, const EstimateRow& b) {
    return a.frame_index >= b.frame_index;
  };
  if (std::adjacent_find(rows.begin(), rows.end(), not_ascending) != rows.end())
    throw Hdf5Failure("believe /estimates/frame: it does not ascend");
  return rows;
}

std::vector<Annotation> read_annotations(const SessionFile& file) {
  std::vector<Annotation> annotations;
  if (!file.has_group("/annotations")) return annotations;
  auto group = file.group("/annotations");
  annotation_columns(group, annotations);
  for (const Annotation& annotation : annotations)
    if (const auto problem = problem_of(annotation)) throw Hdf5Failure("believe /annotations: " + *problem);
  return annotations;
}

std::mutex& hdf5_turn() {
  static std::mutex turn;
  return turn;
}

}  // namespace thermorig::session
