// SPDX-License-Identifier: MIT
#include "window_set.h"

#include <array>
#include <set>

#include "thermorig/core/frame.h"

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
    if (acquisitions_[index].stored)
      is_partly_stored_ = true;
    else
      prepared_[index] = network::prepare(acquisitions_[index], shape_, scaling_);
}

std::size_t WindowSet::first_frame(std::size_t index) const {
  return std::size_t{windows_[index].last} + 1 - static_cast<std::size_t>(shape_.frames);
}

const float* WindowSet::frames(std::size_t index) const {
  const std::vector<float>& prepared = prepared_[windows_[index].acquisition];
  return prepared.empty() ? nullptr : prepared.data() + first_frame(index) * shape_.pixels();
}

void WindowSet::announce(std::size_t index) const {
  const Acquisition& acquisition = acquisition_of(index);
  if (acquisition.stored)
    acquisition.stored->announce(first_frame(index), static_cast<std::size_t>(shape_.frames));
}

/// Prepared as prepare() does it, so that the network sees the same bits.
void WindowSet::read(std::size_t index, std::span<float> place) const {
  const auto frames = static_cast<std::size_t>(shape_.frames);
  std::array<float, network::max_frames * frame_pixels> temp_c;
  acquisition_of(index).stored->read(first_frame(index), std::span(temp_c).first(frames * frame_pixels));
  for (std::size_t frame = 0; frame < frames; ++frame)
    network::prepare_frame(std::span(temp_c).subspan(frame * frame_pixels, frame_pixels), shape_, scaling_,
                           place.subspan(frame * shape_.pixels(), shape_.pixels()));
}

BatchBuffer::BatchBuffer(const WindowSet& set) : set_(set) {
  const std::size_t window = static_cast<std::size_t>(set.shape().frames) * set.shape().pixels();
  if (set.is_partly_stored()) read_.resize(network::max_batch * window);
}

void BatchBuffer::clear() {
  indices_.clear();
  frames_.clear();
  gyro_.clear();
  label_.clear();
  mirrored_.clear();
}

void BatchBuffer::add(std::size_t index, bool mirrored) {
  const float sign = mirrored ? -1.0F : 1.0F;
  const float* const in_memory = set_.frames(index);
  frames_.push_back(in_memory != nullptr ? in_memory : place_of(indices_.size()).data());
  indices_.push_back(index);
  gyro_.push_back(sign * set_.gyro(index));
  label_.push_back(sign * set_.label(index));
  mirrored_.push_back(mirrored ? 1 : 0);
}

std::span<float> BatchBuffer::place_of(std::size_t place) {
  const std::size_t window = read_.size() / network::max_batch;
  return std::span(read_).subspan(place * window, window);
}

void BatchBuffer::read(std::size_t place) {
  if (set_.frames(indices_[place]) == nullptr) set_.read(indices_[place], place_of(place));
}

network::Batch BatchBuffer::batch() const {
  network::Batch batch{.frames = frames_, .gyro = {}, .label = label_, .mirrored = mirrored_};
  if (set_.shape().fusion) batch.gyro = gyro_;
  return batch;
}

}  // namespace thermorig::training
