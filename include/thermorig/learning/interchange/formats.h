// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/learning/interchange/table.h"
#include "thermorig/network/acquisition.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::interchange {

/// Where a file's bytes go, one after another: nothing is ever gone back to, so it may be a pipe.
class Sink {
 public:
  virtual ~Sink() = default;

  /// Throws Error(storage).
  virtual void write(std::span<const std::byte> bytes) = 0;

  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
};

/// RFC 4180, UTF-8: a header "time [s]", then a line a row. Numbers in the shortest form that reads back as
/// the same; one that is not known is an empty field. Text that a spreadsheet would take for a formula has a
/// leading '. Throws as the sink does.
void write_csv(const Table& table, Sink& sink);

/// Which windows: Nf frames, pixels averaged Nr x Nr.
struct WindowShape {
  int frames = 3;     // Nf, 1 to 6
  int reduction = 1;  // Nr, 1 to 3
};

/// A row a frame: the numbers of `samples`, and `temperature` (N, 24, 32) in degrees Celsius. Throws as the
/// sink does.
void write_rows_npz(const session::Session& session, Sink& sink);

/// The windows that a training sees: `images` (W, Nf, H, W') in degrees Celsius, `label_dps`,
/// `corrected_dps`, `shaft_dps`, `gyro_dps`, `last`, `middle_s`; `measured_dps` where something measured the
/// shaft. `acquisition` is made of `session`. Returns how many. Throws as the sink does.
std::size_t write_windows_npz(const session::Session& session, const network::Acquisition& acquisition,
                              WindowShape shape, Sink& sink);

/// An angle at a time, of something that turns about the servo's axis.
struct AngleAt {
  HostTime time{};
  double angle_deg = 0.0;
};

/// What one thing did over a recording.
struct Trajectory {
  std::string name;  // "shaft", "measured", or of the table of estimators
  // At the end of each frame's exposure where it is known; measured: of each reading.
  std::vector<AngleAt> angles;
};

/// The shaft by the servo's model, as a sensor on it measured it if there is one, then each estimator: those
/// of a live run as it showed them, else all that need no network. Each counts from an origin of its own.
std::vector<Trajectory> trajectories_of(const session::Session& session);

/// A line each: "t x y z qx qy qz qw", t in seconds of Unix time, no translation, turned about z. Throws as
/// the sink does.
void write_tum(const RecordingHeader& header, const Trajectory& trajectory, Sink& sink);

/// How the chunks of an MCAP file are stored.
enum class McapCompression { none, zstd };

/// The session as MCAP (https://mcap.dev/spec), messages in JSON, in order of time: /camera, /gyro, /servo,
/// /label, /events, and /shaft where something measured it. Chunked and indexed. Throws as the sink does.
void write_mcap(const session::Session& session, Sink& sink,
                McapCompression compression = McapCompression::none);

}  // namespace thermorig::interchange
