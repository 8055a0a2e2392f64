// SPDX-License-Identifier: MIT
#include "thermorig/learning/training/run_folder.h"

#include <nlohmann/json.hpp>

#include "checkpoint_bytes.h"
#include "run_json.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/holder.h"
#include "thermorig/io/files/whole_file.h"

namespace thermorig::training {

namespace {

namespace fs = std::filesystem;

constexpr const char* description_name = "run.json";
constexpr const char* checkpoint_name = "checkpoint.bin";
constexpr const char* metrics_name = "metrics.ndjson";
constexpr std::size_t description_bytes_max = 4U << 20U;

[[noreturn]] void refuse_damaged(const fs::path& file) {
  throw Error(ExitCode::not_a_session, "is damaged, or was not written by thermorig train", file.string(),
              "train anew, with another --run-folder and without --resume");
}

nlohmann::json read_description(const fs::path& folder) {
  const fs::path path = folder / description_name;
  const auto text = files::read_whole(path, description_bytes_max, "the run's description");
  auto found = description_from({reinterpret_cast<const char*>(text.data()), text.size()});
  if (!found) refuse_damaged(path);
  return *std::move(found);
}

/// Of two programs that do it one is refused.
void make_folder(const fs::path& path) {
  std::error_code failure;
  const fs::path folder = path.has_filename() ? path : path.parent_path();  // without a slash at its end
  if (fs::exists(path, failure) || (!fs::create_directories(folder, failure) && !failure))
    throw Error(ExitCode::bad_usage, "there is a run already", path.string(),
                "--resume to go on with it, another --run-folder, or remove it");
  if (failure)
    throw Error(ExitCode::storage, "the run folder cannot be made: " + failure.message(), path.string(),
                "choose another one with --run-folder");
}

std::string json_text(const nlohmann::json& object, int indent) {
  return object.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string metrics_text(const Checkpoint& checkpoint, const TrainingConfig& config) {
  std::string text;
  for (const EpochReport& report : checkpoint.epochs) text += json_text(to_json(report, config), -1);
  return text;
}

std::unique_ptr<files::FileLock> locked(const fs::path& folder) {
  const fs::path path = folder / description_name;
  auto lock = std::make_unique<files::FileLock>(path, files::FileLock::Wait::no, files::real_disk());
  if (lock->is_held()) return lock;
  throw Error(ExitCode::no_permission, files::holder_of(path) + " trains in this folder", folder.string(),
              "wait until it has ended, or another --run-folder without --resume");
}

}  // namespace

RunFolder::RunFolder(fs::path path, const TrainingConfig& config)
    : path_(std::move(path)), config_(config), lock_(locked(path_)) {}

RunFolder RunFolder::create(const fs::path& path, const RunDescription& description) {
  make_folder(path);
  files::write_whole(path / description_name, json_text(to_json(description), 2), "the run's description");
  return RunFolder(path, description.config);
}

RunFolder RunFolder::reopen(const fs::path& path, const RunDescription& description) {
  std::error_code hidden;
  if (!fs::exists(path / description_name, hidden))
    throw Error(ExitCode::bad_usage, "there is no run to go on with", path.string(),
                "name its folder with --run-folder, or leave --resume out");
  const std::string other =
      differences(read_description(path), nlohmann::json::parse(json_text(to_json(description), -1)));
  if (!other.empty())
    throw Error(ExitCode::bad_usage, "the run was begun with something else: " + other, path.string(),
                "the same arguments as then, or another --run-folder without --resume");
  RunFolder folder(path, description.config);
  folder.read_checkpoint();
  return folder;
}

void RunFolder::read_checkpoint() {
  const fs::path path = path_ / checkpoint_name;
  std::error_code hidden;
  if (!fs::exists(path, hidden)) return;
  const auto bytes = files::read_whole(path, checkpoint_bytes_max(config_), "the checkpoint");
  checkpoint_ = checkpoint_from({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, config_);
  if (!checkpoint_) refuse_damaged(path);
  for (const EpochReport& report : checkpoint_->epochs) seconds_.push_back(report.seconds);
}

double RunFolder::seconds() const {
  return seconds_.empty() ? 0.0 : seconds_.back();
}

void RunFolder::save(const Checkpoint& checkpoint, double seconds) {
  seconds_.resize(checkpoint.epochs.size(), seconds);
  Checkpoint timed = checkpoint;
  for (std::size_t i = 0; i < seconds_.size(); ++i) timed.epochs[i].seconds = seconds_[i];
  files::write_whole(path_ / checkpoint_name, checkpoint_bytes(timed), "the checkpoint");
  files::write_whole(path_ / metrics_name, metrics_text(timed, config_), "the metrics");
}

}  // namespace thermorig::training
