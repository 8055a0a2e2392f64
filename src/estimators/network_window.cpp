// SPDX-License-Identifier: MIT
#include "network_window.h"

namespace thermorig::estimators {

NetworkWindow::NetworkWindow(const model::Model& model, network::Precision precision)
    : estimator_(model.weights, precision),
      scaling_(model.scaling),
      prepared_(shape().pixels()),
      images_(static_cast<std::size_t>(shape().frames), shape().pixels()),
      in_a_row_(shape().frames) {}

const std::optional<network::Output>& NetworkWindow::look(const Observation& observation) {
  if (seen_ == observation.index) return output_;
  seen_ = observation.index;
  const TimedFrame& frame = observation.frame;
  const std::span<const float> temp_c(frame.frame.temp_c);
  const int in_a_row = in_a_row_.push(frame);
  network::prepare_frame(temp_c, shape(), scaling_, prepared_);
  images_.push(prepared_);
  output_.reset();
  reason_ = in_a_row > 0 ? EstimateReason::window_incomplete : EstimateReason::no_image;
  if (in_a_row == shape().frames) output_ = estimator_.estimate(images_.all(), 0.0F);
  return output_;
}

}  // namespace thermorig::estimators
