// SPDX-License-Identifier: MIT
#include <utility>

#include "camera_rhythm.h"
#include "thermorig/pipeline/pipeline.h"

namespace thermorig::pipeline {

Fits fit(const RawRecording& /*raw*/, Streams streams) {
  CameraRhythm rhythm = camera_rhythm(streams.frames);
  Fits fits;
  fits.camera_mode = rhythm.mode;
  fits.frame_period_s = rhythm.period_s;
  fits.gaps = std::move(rhythm.gaps);
  return fits;
}

}  // namespace thermorig::pipeline
