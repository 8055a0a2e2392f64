// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/io/files/holder.h"
#include "thermorig/learning/training/training.h"

namespace thermorig::training {

/// What a run is of. It goes on only with exactly the same, else its model would be that of neither.
struct RunDescription {
  TrainingConfig config;
  Label label = Label::commanded;  // that is learnt
  std::vector<model::Provenance::Data>
      data;                     // all acquisitions, in order; hashes: Acquisition::learnt_hash()
  std::string instruction_set;  // whose kernels: sums differ in their last bits
  std::string producer;         // program and version
};

/// A folder that a training fills while it runs: `run.json` (settings, seed, data hashes, instruction set),
/// `metrics.ndjson` (a line an epoch), `checkpoint.bin`, at the end `model.onnx`. Every file is whole at any
/// time: written to a temporary name, synced, renamed. One program at a time has it: a lock on `run.json`,
/// which holds on all machines as far as locks of their shared disk do.
class RunFolder {
 public:
  /// A new folder. Throws Error(bad_usage) if there is something at `path`, Error(storage) if it cannot be
  /// written, Error(no_permission) if another program makes the same.
  static RunFolder create(const std::filesystem::path& path, const RunDescription& description);

  /// The folder of a run that was interrupted. Throws Error(bad_usage) if there is none or if it was made
  /// with other settings or data, saying which; Error(not_a_session) if it is damaged; Error(no_permission)
  /// if another program trains in it, with who it is where this machine knows.
  static RunFolder reopen(const std::filesystem::path& path, const RunDescription& description);

  /// From where to go on; none before the first epoch has ended.
  const std::optional<Checkpoint>& checkpoint() const { return checkpoint_; }

  /// Seconds that the run took so far, over all its parts.
  double seconds() const;

  /// Keeps an epoch that ended `seconds` after the run began. Throws Error(storage).
  void save(const Checkpoint& checkpoint, double seconds);

  std::filesystem::path model_path() const { return path_ / "model.onnx"; }

 private:
  RunFolder(std::filesystem::path path, const TrainingConfig& config);
  void read_checkpoint();

  std::filesystem::path path_;
  TrainingConfig config_;
  std::unique_ptr<files::FileLock> lock_;
  std::optional<Checkpoint> checkpoint_;  // as it was found
  std::vector<double> seconds_;           // by epoch
};

}  // namespace thermorig::training
