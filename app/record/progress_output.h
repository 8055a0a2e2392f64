// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "print/output_writer.h"
#include "thermorig/rig/recording/recording.h"

namespace thermorig::app {

/// Shows a recording while it runs.
class ProgressOutput {
 public:
  virtual ~ProgressOutput() = default;

  /// What happened is told at once; where things stand only as often as this output likes.
  void show(const rig::RecordingProgress& progress);

  virtual void note(const std::string& sentence) = 0;

 protected:
  /// What the period is of: the clock on the wall for an eye that reads along, or the recording's own, which
  /// virtual time lets run faster.
  enum class Clock : std::uint8_t { wall, recording };
  explicit ProgressOutput(double period_s, Clock clock = Clock::wall)
      : period_(from_s(period_s)), clock_(clock) {}
  virtual void draw(const rig::RecordingProgress& progress) = 0;

 private:
  HostDuration period_;
  Clock clock_;
  std::optional<HostTime> drawn_;
};

enum class ProgressStyle : std::uint8_t {
  terminal,  // a few lines that are drawn over at most four times a second
  lines,     // a plain one every ten seconds
  json,      // an object a second of the recording, in virtual time too
};

/// Of what is told on standard output.
ProgressStyle progress_style(bool json);

std::unique_ptr<ProgressOutput> make_progress_output(OutputWriter& output, ProgressStyle style);

/// How it is written: virtual time waits for a slow reader, ports do not.
OutputOptions progress_output_options(ProgressStyle style, bool fast);

/// The lines of the terminal: one a device, where the sweep stands, and which speeds have their valid frames.
/// No escape codes.
std::vector<std::string> status_lines(const rig::RecordingProgress& progress);

}  // namespace thermorig::app
