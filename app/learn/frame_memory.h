// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "session_data.h"

namespace thermorig::app {

/// The memory that the frames of trainings and evaluations take. Those that do not fit are packed; what does
/// not fit even so lies in files without a name, whose pages are the system's.
class FrameMemory {
 public:
  /// `near`: the files lie beside it, where its disk has room.
  FrameMemory(const FrameOptions& options, std::filesystem::path near);

  /// Reads as read_data(). The network takes so many bytes a frame beside the pixels.
  dataset::Acquisitions read(SessionOptions options, std::uint64_t bytes_beside_a_frame);

  /// Runs estimators as run_estimators() does, with what memory the frames leave.
  void run_estimators(dataset::Acquisitions& data, bool json, const dataset::IsWanted& is_wanted,
                      int bound_frames = 0) const;

  /// Where the frames lie, and how much memory they may take: a line.
  std::string text() const;
  /// For programs: adds `memory_bytes`, `packed_bytes` and `bytes_on_disk`.
  void add_to(nlohmann::json& object) const;

 private:
  std::filesystem::path near_;
  std::uint64_t bytes_;
  std::uint64_t packed_bytes_ = 0, bytes_on_disk_ = 0;
};

}  // namespace thermorig::app
