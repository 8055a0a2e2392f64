// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/label.h"
#include "thermorig/core/time.h"
#include "thermorig/network/camera_view.h"
#include "thermorig/network/stored_frames.h"

namespace thermorig::network {

/// What an estimator without a network says of the frames of one session.
struct RateSeries {
  std::string name;             // of the table of estimators, e.g. "gyro-rest"
  std::vector<float> rate_dps;  // (N) mean over the exposures of `frames` frames, the last of them this one;
                                // NaN where it says nothing
  int frames = 1;
  std::vector<float>
      bias_sigma_dps;  // (N) of its bias, as it states it, one standard deviation; NaN as above
};

/// What training and evaluation know of one session: a row a frame (N frames).
struct Acquisition {
  std::string name;         // "<environment>_acq-<number>": a re-recorded simulated session has it again
  std::string environment;  // e.g. "garden"
  int number = 0;           // acquisition number within the environment
  bool simulated = false;
  double frame_period_s = 0.125;   // measured; above 0
  std::optional<CameraView> view;  // none: not known
  std::string licence;             // of the data, as the session says it; "not stated" if it does not
  std::string hash;  // SHA-256, hexadecimal, of frames, commanded speeds, gyro means, times and runs: not of
                     // the file, whose name and creation time do not matter to a model
  std::vector<float> temp_c;                   // (N, 24, 32); empty where `packed` has them
  std::shared_ptr<const PackedFrames> packed;  // null: they are not
  bool is_labelled_by_gyro =
      false;                       // of a rig without a servo: label_dps is the gyro's, whatever `label` says
  Label label = Label::commanded;  // what label_dps is
  std::string label_hash;          // the same as `hash`, but of label_dps as it is; empty: commanded
  std::vector<float> label_dps;    // (N) speed over the exposure that is learnt, NaN if unknown
  std::vector<float> shaft_dps;    // (N) speed of the shaft by the servo model; not in the hash
  std::vector<float>
      gyro_dps;  // (N) mean of the gyro over the exposure, bias not removed, NaN if there is none
  std::vector<HostTime> time;       // (N) middle of the newest exposure
  std::vector<std::uint32_t> run;   // (N) unbroken run of valid frames within one leg, from 1; 0: not valid
  std::vector<float> leg_rate_dps;  // (N) commanded speed of the leg that the frame lies in; 0 outside legs;
                                    // NaN without a servo
  std::vector<RateSeries> rates;    // of all estimators that need no network, those of one frame first, then
                                    // those that look at longer windows at once; not in the hash
  std::vector<float> bound_dps;  // (N) Cramer-Rao bound of the rate of a window of bound_frames frames that
                                 // ends here, NaN if unknown; empty where nobody asked; not in the hash
  int bound_frames = 0;

  std::size_t frames() const { return run.size(); }

  /// Of all that a training takes, its label among it.
  const std::string& learnt_hash() const { return label_hash.empty() ? hash : label_hash; }
};

}  // namespace thermorig::network
