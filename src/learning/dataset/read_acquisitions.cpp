// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "for_each_file.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/dataset/dataset.h"

namespace thermorig::dataset {

namespace {

namespace fs = std::filesystem;
using network::Acquisition;

/// What became of one file.
struct FileRead {
  std::optional<Acquisition> acquisition;  // none: its session is for a calibration, or bad and left out
  std::optional<BadSession> bad;
};

FileRead read_file(const fs::path& path, Label label, bool packs, const LeavesOut& leaves_out) {
  const session::Session session = session::read_session(path);
  if (session::is_for_calibration(session.raw.header)) return {};
  std::optional<BadSession> bad = bad_session(session, path);
  if (bad && leaves_out && leaves_out(path)) return {std::nullopt, std::move(bad)};
  require_label(session, label, path);
  Acquisition acquisition = acquisition_of(session, name_of(session), label);
  if (packs)
    acquisition.packed = std::make_shared<network::PackedFrames>(std::exchange(acquisition.temp_c, {}));
  return {std::move(acquisition), std::move(bad)};
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

/// The places of those that are taken, by environment, number, name.
std::vector<std::size_t> order_of(const std::vector<FileRead>& reads) {
  std::vector<std::size_t> order;
  for (std::size_t index = 0; index < reads.size(); ++index)
    if (reads[index].acquisition) order.push_back(index);
  std::sort(order.begin(), order.end(), [&](std::size_t one, std::size_t other) {
    const Acquisition &a = *reads[one].acquisition, &b = *reads[other].acquisition;
    return std::tie(a.environment, a.number, a.name, a.hash) <
           std::tie(b.environment, b.number, b.name, b.hash);
  });
  return order;
}

Acquisitions sorted_out(std::vector<FileRead> reads, const std::vector<fs::path>& files) {
  Acquisitions sorted;
  for (const std::size_t index : order_of(reads)) {
    sorted.acquisitions.push_back(std::move(*reads[index].acquisition));
    sorted.files.push_back(files[index]);
  }
  for (std::size_t index = 0; index < files.size(); ++index) {
    FileRead& read = reads[index];
    const bool is_taken = read.acquisition.has_value();  // though its value was moved out
    if (read.bad)
      (is_taken ? sorted.bad : sorted.left_out).push_back(std::move(*read.bad));
    else if (!is_taken)
      sorted.for_calibration.push_back(files[index]);
  }
  return sorted;
}

void run_estimators_over(Acquisition& acquisition, const fs::path& file, int bound_frames) {
  const session::Session session = session::read_session(file);
  if (acquisition_of(session, acquisition.name).hash != acquisition.hash)
    throw Error(ExitCode::not_a_session, "holds another recording than a moment ago", file.string(),
                "run the command again, and leave its sessions alone while it runs");
  add_estimates(acquisition, session, bound_frames);
}

}  // namespace

std::optional<BadSession> bad_session(const session::Session& session, const fs::path& file) {
  session::Quality quality = session::quality_of(session);
  if (quality.verdict != "bad") return std::nullopt;
  return BadSession{file, std::move(quality.verdict_reasons)};
}

Acquisition read_acquisition(const fs::path& path) {
  const session::Session session = session::read_session(path);
  return acquisition_of(session, name_of(session));
}

Acquisitions read_acquisitions(const std::vector<fs::path>& files, const ReadingProgress& progress,
                               Label label, bool packs, const LeavesOut& leaves_out) {
  std::vector<FileRead> reads(files.size());
  for_each_file(
      files.size(),
      [&](std::size_t index) { reads[index] = read_file(files[index], label, packs, leaves_out); }, progress);
  refuse_copies(reads, files);
  return sorted_out(std::move(reads), files);
}

void run_estimators_over(Acquisitions& data, const IsWanted& is_wanted, int bound_frames,
                         const ReadingProgress& progress) {
  std::vector<std::size_t> wanted;
  for (std::size_t i = 0; i < data.acquisitions.size(); ++i)
    if (is_wanted(data.acquisitions[i])) wanted.push_back(i);
  for_each_file(
      wanted.size(),
      [&](std::size_t i) {
        run_estimators_over(data.acquisitions[wanted[i]], data.files[wanted[i]], bound_frames);
      },
      progress);
}

}  // namespace thermorig::dataset
