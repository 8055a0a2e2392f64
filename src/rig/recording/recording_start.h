// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "preflight_watch.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/rig/recording/recording.h"

namespace thermorig::rig {

/// What is known before the first byte, but for the acquisition's number.
RecordingHeader make_header(const RecordingOptions& options, HostTime now);

/// The computer's wall clock against its steady one.
std::int64_t wall_offset_ns(const RecordingOptions& options);

/// By how much the wall clock was set during `run_s`; 0 if it was only slewed (adjtimex(2): by 500 ppm).
std::int64_t clock_set_ns(std::int64_t offset_at_begin_ns, std::int64_t offset_at_end_ns, double run_s);

/// From the first byte to the first motion: the servo is greeted, every device speaks, the rig at rest is
/// judged, and the start is allowed.
class RecordingStart {
 public:
  explicit RecordingStart(const RecordingOptions& options);

  /// False: it was allowed before.
  bool allow();
  /// The servo has answered. False: that is known.
  bool greeted();
  /// Every device is there, at each tick until it begins.
  void ready(HostTime now, const PreflightCounts& counts);
  /// What came before does not count: a device was away, or was not there yet.
  void listen_anew(HostTime now, const PreflightCounts& counts);

  /// May something move? Judges the rig, once, before the servo is armed, which may already turn it.
  bool is_due(HostTime now, const PreflightCounts& counts);
  /// What it was judged then; none where nothing is judged.
  const std::optional<PreflightReport>& judged() const { return report_; }
  /// Something would move that is not fit for it.
  bool is_to_be_refused() const;
  void begin() { state_ = State::begun; }
  void refuse() { state_ = State::refused; }

  bool was_ready() const { return state_ == State::ready || state_ == State::begun; }
  bool has_begun() const { return state_ == State::begun; }

  PreflightWatch& watch() { return watch_; }
  double heard_s(HostTime now) const { return watch_.heard_s(now); }
  /// What was said of the rig before it began or, as long as it has not, would be said now. None before all
  /// devices have sent for a second, and where nothing is judged.
  std::optional<PreflightReport> report(HostTime now, const PreflightCounts& counts) const;

 private:
  PreflightReport judge_now(HostTime now, const PreflightCounts& counts) const;

  enum class State : std::uint8_t { awaiting_devices, ready, begun, refused };
  RigProfile profile_;
  PreflightMode mode_;
  bool moves_;
  bool is_allowed_;
  bool is_greeted_ = false;
  State state_ = State::awaiting_devices;
  PreflightWatch watch_;
  std::optional<PreflightReport> report_;  // of the time before it began
};

}  // namespace thermorig::rig
