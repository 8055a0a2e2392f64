// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "session_data.h"
#include "thermorig/learning/dataset/frame_store.h"

namespace thermorig::app {

/// The memory that the frames of trainings and evaluations take, and where those lie that do not fit.
class FrameMemory {
 public:
  /// `near`: the file lies beside it, unless a folder was asked for. Throws Error(bad_usage) where that is
  /// none.
  FrameMemory(const FrameOptions& options, const std::filesystem::path& near);

  /// Reads as read_data(). The network takes so many bytes a frame beside the pixels.
  dataset::Acquisitions read(SessionOptions options, std::uint64_t bytes_beside_a_frame);

  /// Runs estimators as run_estimators() does, with what memory the frames leave.
  void run_estimators(dataset::Acquisitions& data, bool json, const dataset::IsWanted& is_wanted,
                      int bound_frames = 0) const;

  /// Where the frames lie, and how much memory they may take: a line.
  std::string text() const;
  /// For programs: adds `memory_bytes`, `frames_in_memory_bytes` and `frames_on_disk_bytes`.
  void add_to(nlohmann::json& object) const;

 private:
  dataset::FrameFolder folder_;
  std::uint64_t bytes_;
  dataset::FrameStore store_;
};

}  // namespace thermorig::app
