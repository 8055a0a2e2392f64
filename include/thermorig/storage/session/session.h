// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/annotation.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"
#include "thermorig/io/files/replaced_file.h"
#include "thermorig/sensors/wire/counters.h"
#include "thermorig/storage/session/stored_file.h"

namespace thermorig::session {

enum class State : std::uint8_t { complete, recovered, partial };

/// A recording with everything that was made of it: what one `.h5` file holds.
struct Session {
  RawRecording raw;
  State state = State::complete;
  std::vector<TimedFrame> frames;
  std::vector<TimedGyro> gyro;
  std::vector<TimedServo> servo;
  std::vector<TimedShaft> shaft;  // empty where RecordingHeader::shaft_sensor is
  std::vector<TimedPong> pongs;
  std::vector<LabelledSample> samples;  // one a frame, same order
  PerDevice<wire::Counters> counters;
  double settle_s = 0.2;                // of the label rule
  std::string camera_mode;              // "half-fresh" or "full-fresh"
  double frame_period_s = 0.0;          // measured
  SyncReport sync;                      // clocks, camera offset, gyro errors, servo response
  std::vector<Annotation> annotations;  // made afterwards, in order; their exclusions are in `samples`
  unsigned format_major = 2;            // of the file that it was read from
  // Of that file's /samples: 1 had the commanded speed alone, 2 none that is corrected (those are then NaN).
  unsigned label_version = 3;
};

/// Which share of a camera's frames may be missing in a session that is usable. Each that is missing is
/// noticed and ends a run. With one chess half in three lost all labels and times are as good as ever
/// (docs/evidence/hard_table.md); beyond, nobody has looked.
inline constexpr double most_missing_frames = 0.35;

/// Figures of `/quality`, computed from a session; also what `inspect` prints.
struct Quality {
  struct Stream {
    std::uint64_t received = 0, lost = 0, bad = 0, repeated = 0;
    double rate_min_hz = 0, rate_mean_hz = 0, rate_max_hz = 0;  // over windows of one second
    double gap_max_s = 0;
  };
  struct Speed {
    double rate_dps = 0;
    int frames = 0, valid = 0;
  };
  struct Clock {
    double uncertainty_s = 0;  // median over the messages; NaN: the clock could not be fitted
    double bound_s = 0;        // median width of the bounds; NaN likewise
  };
  PerDevice<Stream> stream;
  double duration_s = 0;
  std::uint64_t frames = 0, swept = 0, valid = 0;      // swept: within legs
  std::map<std::string, std::uint64_t> reason_counts;  // by name, frames within legs
  std::uint64_t sound = 0;        // within legs, with no reason but that the gyro disagrees
  std::uint64_t disagreeing = 0;  // of these, where it does
  std::vector<Speed> speeds;      // ascending
  PerDevice<Clock> clock;
  std::optional<Estimate> camera_offset_s;  // of the camera against the gyro, by the images
  double rate_shaft_uncertainty_dps = 0;    // median over the valid frames; NaN if there is none
  double gyro_residual_dps = 0;  // root mean square of corrected gyro minus rate_shaft over the frames
                                 // that are valid or would be but for the gyro; NaN if not fitted
  std::string verdict;           // "good", "usable" or "bad"
  std::vector<std::string> verdict_reasons;
};
Quality quality_of(const Session& session);

/// "17.5 % of the camera's messages were lost or damaged"; empty of a stream that lost no more than a good
/// session may.
std::string losses_text(Device device, const Quality::Stream& stream);

/// "complete", "recovered" or "partial".
std::string name_of(State state);

/// Does the plan say that it was recorded for a calibration? Its legs, if there are any, show what that
/// needs, and not the speeds of a data set.
bool is_for_calibration(const RecordingHeader& header);

/// Writes the file: to a temporary name in the same folder, read back and checked, read as read_session() of
/// a stranger's file does, synced, renamed to `path`. Never overwrites: throws Error(storage) if `path`
/// exists, and what the reader says of a session that could not be read again. Schema:
/// docs/recording_format.md.
void write_session(const std::filesystem::path& path, const Session& session,
                   files::Disk& disk = files::real_disk());

/// The file of a session that is to be written again: to be locked before it is read, if others may change
/// it.
files::ReplacedFile replaced_session(const std::filesystem::path& path,
                                     files::Disk& disk = files::real_disk());

/// The same as write_session() into a part, which is then to be published. Attributes that somebody else has
/// put into the file `old` are kept, on the objects that both have; other objects are not: returns the paths
/// of the outermost ones ("/notes"), of a file of format 1.3 or later. Throws also as read_session() does of
/// `old`.
std::vector<std::string> write_again(files::PartFile& part, const std::filesystem::path& old,
                                     const Session& session, files::Disk& disk = files::real_disk());

/// Reads a whole session. Throws Error(not_a_session) if it is not one, is damaged, or is of another major
/// version; Error as StoredFile does. A child process reads it first, if try_sessions_first() was called
/// (trial.h). This and what follows may be called from several threads: one at a time is in the HDF5 library.
Session read_session(const std::filesystem::path& path);
/// The same of a file that is open.
Session read_session(const StoredFile& file);

/// A session as its figures tell it.
struct Overview {
  Session session;  // without the bytes of the ports, frames, gyro, servo and pongs
  Quality quality;
};

/// Looks at all of the file as read_session() does, and throws as that, but keeps less of it.
Overview read_overview(const StoredFile& file);

/// Reads only what is needed to make the session again: header, raw bytes, events, legs.
RawRecording read_raw(const std::filesystem::path& path);

}  // namespace thermorig::session
