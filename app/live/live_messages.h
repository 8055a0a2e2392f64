// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/estimate_row.h"
#include "thermorig/core/sample.h"
#include "thermorig/estimators/estimator.h"
#include "thermorig/estimators/live/scores.h"
#include "thermorig/rig/recording/recording.h"

namespace thermorig::app {

enum class LiveMode : std::uint8_t { live, record, replay };
std::string name_of(LiveMode mode);

/// What is known before the first frame.
struct LiveFacts {
  LiveMode mode = LiveMode::live;
  bool recording = false;        // a session is kept
  std::filesystem::path output;  // where
  bool control = false;
  RecordingHeader header;
  std::string plan_name;
  std::size_t legs = 0;
  int frames_per_leg = 0;
  double expected_s = 0.0;
  bool repeats = false;  // the plan again and again: no end is known
};

/// One frame and all that is said of it.
struct LiveFrame {
  const TimedFrame& frame;
  const LabelledSample& sample;
  const std::vector<EstimatorColumn>& estimators;  // of the row
  const EstimateRow& row;
  const live::LiveScores& scores;
  double inference_us = 0.0;  // that all estimators took together
};

/// How it ended.
struct LiveEnd {
  int exit = 0;
  std::string message;
  std::string advice;
  std::string session;    // empty: none
  bool is_error = false;  // it is told on standard error as well
};

// The messages of docs/live_messages.md. `begin` is the host time of second 0. What is not known is null;
// a float is written as the shortest text that gives it back.

nlohmann::json hello_message(const LiveFacts& facts);
nlohmann::json state_message(const rig::RecordingProgress& progress, const LiveFacts& facts,
                             std::optional<std::uint64_t> disk_free_bytes);
nlohmann::json frame_message(const LiveFrame& frame, HostTime begin);
/// `image_c`: Odometer::map_image_c(). `view_deg`: of the camera, across its columns.
nlohmann::json surroundings_message(std::span<const float> image_c, double time_s, double view_deg);
nlohmann::json image_message(const LiveFrame& frame, HostTime begin, bool mirrored);
nlohmann::json event_message(const RecordingEvent& event, HostTime begin);
nlohmann::json ended_message(const LiveEnd& end);

/// Why a frame enters no figure: the reasons of the frame itself or, if it is valid, that its window is not.
/// Empty if it is counted.
std::string why_excluded(const LiveFrame& frame);

/// Names of the reasons whose bits are set.
std::vector<std::string> reason_texts(std::uint32_t bits);
/// "both", "half" or "repeated": how many chess halves of the image are new.
std::string freshness(const TimedFrame& frame);

}  // namespace thermorig::app
