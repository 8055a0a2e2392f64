// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "thermorig/core/freshness.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::labels {

/// How the bridge fills its frames: one fresh chess half a frame, or both.
enum class CameraMode : std::uint8_t { half_fresh, full_fresh };

using thermorig::Freshness;

/// What the fresh halves of a half-fresh source say of what lies between a frame and the one before it.
enum class HalvesWitness : std::uint8_t {
  unsure,            // one of the two repeats the frame before it, or that one brought both halves; or the
                     // source is not half-fresh
  none_missing,      // the halves take turns
  due_half_missing,  // the same half again: the other one never came, as a frame or within one
  frames_missing,    // both at once: a frame with the older one never came
};

inline bool may_be_missing(HalvesWitness halves) {
  return halves == HalvesWitness::due_half_missing || halves == HalvesWitness::frames_missing;
}

/// Hears them frame by frame. What follows a repeated frame shows what that one did not: both halves at once
/// mean nothing then.
class HalvesOrder {
 public:
  HalvesWitness push(const Freshness& freshness, CameraMode mode);

 private:
  Freshness before_;  // none fresh: nothing is known
};

/// Decides between the camera's modes by majority of the frames seen so far. Frames that repeat the one
/// before say nothing; a tie is half-fresh. A frame after a lost one has both halves fresh in either mode,
/// which is why a single one decides nothing.
class ModeVote {
 public:
  /// The recording's first frame, which has nothing to differ from, must be left out.
  void push(const Freshness& freshness);
  CameraMode mode() const { return full_ > half_ ? CameraMode::full_fresh : CameraMode::half_fresh; }
  bool empty() const { return full_ + half_ == 0; }

 private:
  std::size_t half_ = 0;
  std::size_t full_ = 0;
};

/// Says over which time a frame was exposed and whether it shows what it should.
///
/// The sensor exposes one chess half for a refresh period, then the other. With t the frame's stamp and P the
/// time between frames:
///
///     half-fresh: a refresh period is P;     the halves saw [t - 2P, t - P] and [t - P, t]
///     full-fresh: a refresh period is P / 2; the halves saw [t - P, t - P/2] and [t - P/2, t]
///
/// Where the mode is not given it is decided causally, frame by frame, by a ModeVote over the frames so far.
///
/// Each half of TimedFrame::half gets its own period. Half-fresh: the half that alone is fresh was exposed
/// last. Where both are, frames are missing before this one, and which half was the last follows from how
/// many periods went by since it was last known. Full-fresh: nothing in a frame tells the order of its
/// halves, only motion does. Where the order is unknown both halves get the whole span. A half that is not
/// fresh keeps the interval of its last fresh reading.
class ExposureRule {
 public:
  /// `frame_period_s` > 0: time between frames, nominal or measured. `newer_half`: the half that a full-fresh
  /// source exposes last, 0 even, 1 odd.
  explicit ExposureRule(double frame_period_s, std::optional<CameraMode> mode = std::nullopt,
                        std::optional<unsigned> newer_half = std::nullopt);

  /// Each frame in order: look(), then expose(). apply() is both.
  ///
  /// Fills in stale and half_lost of a frame whose fresh_even and fresh_odd are known. Returns what its
  /// halves say of frames that may be missing before it.
  ///
  /// stale: half-fresh: no half is fresh, or only one and the same one as the last time that only one was
  /// (the other half was lost); full-fresh: not both halves are fresh.
  HalvesWitness look(TimedFrame& frame);

  /// Fills in half, exposure_begin and exposure_end of the frame that was looked at; its stamp is known.
  void expose(TimedFrame& frame);

  void apply(TimedFrame& frame) {
    look(frame);
    expose(frame);
  }

  /// The mode that the frame before was taken in.
  CameraMode mode() const { return mode_.value_or(vote_.mode()); }

 private:
  enum class Half : std::uint8_t { none, even, odd };
  bool is_stale(const Freshness& freshness);
  std::optional<unsigned> newest_half(const Freshness& freshness, HostTime time) const;
  void note_newest(const Freshness& freshness, HostTime time);
  void expose_halves(const Freshness& freshness, TimedFrame& frame);

  HostDuration frame_period_;
  std::optional<CameraMode> mode_;
  Freshness freshness_;  // of the frame that was looked at
  ModeVote vote_;
  HalvesOrder order_;
  Half last_single_ = Half::none;  // the half that alone was fresh, the last time that only one was
  std::array<std::optional<HalfExposure>, 2> half_{};  // of the last fresh reading
  std::optional<unsigned> newest_;                     // half-fresh: half that was exposed last,
  HostTime newest_time_{};                             // at this time
  std::optional<unsigned> newer_half_;
  std::size_t looked_ = 0;  // frames
};

}  // namespace thermorig::labels
