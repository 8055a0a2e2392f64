// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/rig/recording.h"

namespace thermorig::app {

/// Shows a recording while it runs.
class ProgressOutput {
 public:
  virtual ~ProgressOutput() = default;

  /// What happened is told at once; where things stand only as often as this output likes.
  void show(const rig::RecordingProgress& progress);

  virtual void note(const std::string& sentence) = 0;

 protected:
  explicit ProgressOutput(double period_s) : period_(from_s(period_s)) {}
  virtual void draw(const rig::RecordingProgress& progress) = 0;

 private:
  HostDuration period_;
  std::optional<HostTime> drawn_;
};

/// On a terminal a few lines that are drawn over at most four times a second; elsewhere a plain line every
/// ten seconds; with `json` one object a second.
std::unique_ptr<ProgressOutput> make_progress_output(bool json);

/// The lines of the terminal: one a device, where the sweep stands, and which speeds have their valid frames.
/// No escape codes.
std::vector<std::string> status_lines(const rig::RecordingProgress& progress);

}  // namespace thermorig::app
