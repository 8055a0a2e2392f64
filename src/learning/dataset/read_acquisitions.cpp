// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>
#include <tuple>

#include "for_each_file.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/dataset/dataset.h"

namespace thermorig::dataset {

namespace {

namespace fs = std::filesystem;
using network::Acquisition;

Acquisition acquisition_in(const session::Session& session, Estimates estimates,
                           Label label = Label::commanded, int bound_frames = 0) {
  return acquisition_of(session, name_of(session), estimates, label, bound_frames);
}

/// What became of one file.
struct FileRead {
  std::optional<Acquisition> acquisition;  // none: its session is for a calibration
  std::optional<BadSession> bad;
};

FileRead read_file(const fs::path& path, Estimates estimates, Label label, int bound_frames) {
  const session::Session session = session::read_session(path);
  if (session::is_for_calibration(session.raw.header)) return {};
  require_label(session, label, path);
  return {acquisition_in(session, estimates, label, bound_frames), bad_session(session, path)};
}

/// Of what was read, only pixels are much.
void take_pixels(FileRead& read, FrameStore* store) {
  if (store != nullptr && read.acquisition) store->take(*read.acquisition);
}

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
  return acquisition_in(session::read_session(path), Estimates::made);
}

Acquisitions read_acquisitions(const std::vector<fs::path>& files, Estimates estimates,
                               const ReadingProgress& progress, Label label, int bound_frames,
                               FrameStore* store) {
  std::vector<FileRead> reads(files.size());
  for_each_file(
      files.size(),
      [&](std::size_t index) {
        reads[index] = read_file(files[index], estimates, label, bound_frames);
        take_pixels(reads[index], store);
      },
      progress);
  refuse_copies(reads, files);
  return sorted_out(std::move(reads), files);
}

}  // namespace thermorig::dataset
