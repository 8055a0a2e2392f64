// SPDX-License-Identifier: MIT
#include "window_set.h"

#include <set>

namespace thermorig::training {

using network::Acquisition;
using network::Window;

WindowSet::WindowSet(std::span<const Acquisition> acquisitions, std::vector<Window> windows,
                     const network::Shape& shape, const network::Scaling& scaling)
    : acquisitions_(acquisitions),
      windows_(std::move(windows)),
      shape_(shape),
      scaling_(scaling),
      prepared_(acquisitions.size()) {
  std::set<std::uint32_t> used;
  rates_.reserve(windows_.size());
  for (const Window& window : windows_) {
    used.insert(window.acquisition);
    rates_.push_back(network::rates_of(acquisitions_[window.acquisition], window, shape_.frames));
  }
  for (const std::uint32_t index : used)
    prepared_[index] = network::prepare(acquisitions_[index], shape_, scaling_);
}

const float* WindowSet::frames(std::size_t index) const {
  const Window& window = windows_[index];
  const std::size_t first = std::size_t{window.last} + 1 - static_cast<std::size_t>(shape_.frames);
  return prepared_[window.acquisition].data() + first * shape_.pixels();
}

void BatchBuffer::clear() {
  frames_.clear();
  gyro_.clear();
  label_.clear();
  mirrored_.clear();
}

void BatchBuffer::add(std::size_t index, bool mirrored) {
  const float sign = mirrored ? -1.0F : 1.0F;
  frames_.push_back(set_.frames(index));
  gyro_.push_back(sign * set_.gyro(index));
  label_.push_back(sign * set_.label(index));
  mirrored_.push_back(mirrored ? 1 : 0);
}

network::Batch BatchBuffer::batch() const {
  network::Batch batch{.frames = frames_, .gyro = {}, .label = label_, .mirrored = mirrored_};
  if (set_.shape().fusion) batch.gyro = gyro_;
  return batch;
}

}  // namespace thermorig::training
