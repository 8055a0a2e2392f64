// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "thermorig/core/error.h"

namespace thermorig::app {

/// What becomes of a text whose reader does not keep up: frames have a quarter of the room, states half,
/// words all of it.
enum class Matter : std::uint8_t { frame, state, word };

/// Texts for which there was no room.
struct DroppedTexts {
  std::uint64_t frames = 0, states = 0, words = 0;
  std::uint64_t all() const { return frames + states + words; }
};

struct OutputOptions {
  using Time = std::chrono::steady_clock::time_point;
  int descriptor = 1;  // standard output
  bool waits = false;  // write() waits for room and drops nothing: nothing moves by the wall's clock
  std::size_t bytes = 512U * 1024;                             // that may wait for the reader
  std::chrono::milliseconds patience{2000};                    // at the end, for a reader that takes nothing
  std::function<Time()> now = std::chrono::steady_clock::now;  // what patience is counted on
  std::function<bool()> hurried;                               // Ctrl-C: waits no longer; may be empty
  std::function<std::string(const DroppedTexts&)> of_dropped;  // tells of a gap where it is; may be empty
};

/// Standard output of a run that must not wait for its reader (`| less`, Ctrl-S): a bounded queue, and a
/// thread that writes. Each text is written whole or not at all, unless the reader leaves within one that is
/// longer than a pipe takes at once (4096 bytes). All calls come from one thread.
class OutputWriter {
 public:
  explicit OutputWriter(const OutputOptions& options);
  ~OutputWriter();  // finish()
  OutputWriter(const OutputWriter&) = delete;
  OutputWriter& operator=(const OutputWriter&) = delete;

  /// False if the text was dropped.
  bool write(std::string text, Matter matter);

  /// For the text that ends a run: what was dropped is told before it, and it has room whatever waits.
  void write_last(std::string text);

  /// The reader went away, or the disk is full: nothing more is written.
  bool failed() const;

  /// Waits for a reader that reads; one that takes nothing for `patience` is given up, and what the program
  /// prints afterwards goes nowhere. Nothing may be written afterwards.
  void finish();

  /// After finish(): Error(storage) if writing failed, or if the reader was given up of a run that ended as
  /// `code`. Not if it was interrupted: an end at once was asked for.
  std::optional<Error> failure(ExitCode code = ExitCode::ok) const;

  /// Throws it.
  void require_written(ExitCode code = ExitCode::ok) const;

 private:
  struct Parts;
  std::shared_ptr<Parts> parts_;  // shared with the thread, which outlives this if its reader holds it
};

}  // namespace thermorig::app
