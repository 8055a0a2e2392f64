// SPDX-License-Identifier: MIT
#include "thermorig/learning/dataset/run_estimators.h"

#include <algorithm>
#include <iterator>
#include <vector>

namespace thermorig::dataset {

namespace {

/// Takes those up to `end` from the front of what is left. A file may say any time: what no recording can
/// hold is left out.
template <typename Sample>
std::vector<Sample> take_until(HostTime end, HostTime reference, std::span<const Sample>& left) {
  const auto later =
      std::find_if(left.begin(), left.end(), [end](const Sample& sample) { return sample.stamp.time > end; });
  std::vector<Sample> taken;
  std::copy_if(left.begin(), later, std::back_inserter(taken),
               [reference](const Sample& sample) { return is_of_recording(sample.stamp.time, reference); });
  left = {later, left.end()};
  return taken;
}

}  // namespace

void run_estimators(const session::Session& session, estimators::Bank& bank, const FrameEstimates& told) {
  const HostTime reference = session.raw.header.time_reference;
  std::span gyro(session.gyro);
  std::span servo(session.servo);
  for (std::size_t i = 0; i < session.frames.size(); ++i) {
    const TimedFrame& frame = session.frames[i];
    if (!is_of_recording(frame.exposure_begin, reference) || !is_of_recording(frame.exposure_end, reference))
      continue;
    told(i, bank.add({.frame = frame,
                      .sample = session.samples[i],
                      .gyro = take_until(frame.exposure_end, reference, gyro),
                      .servo = take_until(frame.exposure_end, reference, servo)}));
  }
}

}  // namespace thermorig::dataset
