// SPDX-License-Identifier: MIT
#include "network_window.h"

#include <algorithm>

#include "thermorig/windows/soundness.h"

namespace thermorig::estimators {

NetworkWindow::NetworkWindow(const model::Model& model, network::Precision precision)
    : estimator_(model.weights, precision),
      scaling_(model.scaling),
      prepared_(shape().pixels()),
      images_(static_cast<std::size_t>(shape().frames), shape().pixels()) {}

const std::optional<network::Output>& NetworkWindow::look(const Observation& observation) {
  if (seen_ == observation.index) return output_;
  seen_ = observation.index;
  const TimedFrame& frame = observation.frame;
  const std::span<const float> temp_c(frame.frame.temp_c);
  const bool is_sound = windows::is_sound_image(temp_c);
  const bool gap_before = frame.resync_before || frame.missing_before > 0;
  in_a_row_ = !is_sound ? 0 : gap_before ? 1 : std::min(in_a_row_ + 1, shape().frames);
  windows::prepare_frame(temp_c, shape(), scaling_, prepared_);
  images_.push(prepared_);
  output_.reset();
  reason_ = is_sound ? EstimateReason::window_incomplete : EstimateReason::no_image;
  if (in_a_row_ == shape().frames) output_ = estimator_.estimate(images_.all(), 0.0F);
  return output_;
}

void NetworkWindow::reset() {
  in_a_row_ = 0;
  seen_.reset();
  output_.reset();
}

}  // namespace thermorig::estimators
