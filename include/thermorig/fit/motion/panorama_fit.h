// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>

#include "thermorig/core/estimate.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/run_all.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"

namespace thermorig::motion {

// One idea serves everything that images can tell about time and rotation. Each chess half of each frame is a
// view of the same surroundings, turned by the angle of the shaft while that half was exposed. Laid side by
// side at the angles that the gyro gives, all halves make one panorama; it is sharpest (the variance among
// the readings of one direction is least) for the true time offset, gyro scale, gyro bias, mirror and order
// of the halves. Pixels' own offsets are removed first: else the panorama is sharpest when nothing moves.

/// What is known already, and what a recording's images are to tell.
struct View {
  double field_of_view_deg = 55.0;
  bool mirrored = true;
};

/// How much the camera is later (positive) than its stamps say, against the gyro: to be taken off its times.
/// It includes the lag with which the pixels' membranes follow the scene (some ten milliseconds), which no
/// clock shows: what is measured is when the camera saw what it shows. Needs motion in both directions over
/// the same surroundings. `frames` carry the exposures of both halves; `gyro` the rate about the axis; both
/// as finally stamped, and in order. The uncertainty is from the spread among blocks of the recording, and at
/// least 0.3 ms, since a lag delays fine structure less than coarse; where that shows, the lag is long, and
/// the uncertainty grows by three times the difference. Searched within 0.3 s either way. Bands of rows are
/// looked at apart: where they differ, rows are read one after the other, and the offset is that of the
/// middle rows.
CameraOffset camera_offset(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro,
                           const View& view, const GyroErrors& errors, const RunAll& run_all = in_turn);

/// Full-fresh camera: which chess half (0 even, 1 odd) is the newer one in every frame. What
/// `TimedFrame::half` says is not used. None: cannot be told, or the frames are half-fresh.
std::optional<unsigned> newer_half(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro,
                                   const View& view, const GyroErrors& errors);

/// The gyro's scale from at least one whole turn that closes in the image (the whole rig may be turned, by
/// hand or by the servo). Owes nothing to the scale in `errors` but where to look (three of its uncertainties
/// either way); the bias in `errors` matters where a turn goes one way only. None, and why, where no turn
/// closes.
struct TurnResult {
  std::optional<Estimate> gyro_scale;
  double turned_deg = 0.0;  // from the one end to the other within a window of about a minute, by the gyro
  std::string why_not;      // ready to print, if there is no scale
};
/// How many windows of a session finalising looks at.
inline constexpr std::size_t session_windows = 3;

/// `most_windows` of about a minute and a half are looked at, evenly spread. Where they differ by more than
/// they claim to know, the scale changed on the way, and the uncertainty is their spread.
TurnResult gyro_scale(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro, const View& view,
                      const GyroErrors& errors, std::size_t most_windows = 8,
                      const RunAll& run_all = in_turn);

/// Is the image mirrored, given that the gyro's rate has the right sign? `view.mirrored` is not used. One
/// direction of turning is enough. None: cannot be told.
struct Orientation {
  std::optional<bool> mirrored;
  double contrast = 0.0;  // how much more of the images the better choice explains, 0..1
  std::string why_not;    // ready to print, if it cannot be told
};
Orientation orientation(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro, const View& view,
                        const GyroErrors& errors);

}  // namespace thermorig::motion
