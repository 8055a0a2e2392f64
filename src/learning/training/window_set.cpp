// SPDX-License-Identifier: MIT
#include "window_set.h"

#include <algorithm>
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
    if (acquisitions_[index].packed)
      is_partly_packed_ = true;
    else
      prepared_[index] = network::prepare(acquisitions_[index], shape_, scaling_);
}

std::size_t WindowSet::first_frame(std::size_t index) const {
  return std::size_t{windows_[index].last} + 1 - static_cast<std::size_t>(shape_.frames);
}

const float* WindowSet::in_memory(std::size_t index) const {
  const std::vector<float>& prepared = prepared_[windows_[index].acquisition];
  return prepared.empty() ? nullptr : prepared.data() + first_frame(index) * shape_.pixels();
}

/// Prepared as network::prepare() does it, so that the network sees the same bits.
void WindowSet::read(std::size_t index, std::span<float> place) const {
  const auto frames = static_cast<std::size_t>(shape_.frames);
  std::array<float, network::max_frames * frame_pixels> temp_c;
  acquisition_of(index).packed->read(first_frame(index), std::span(temp_c).first(frames * frame_pixels));
  for (std::size_t frame = 0; frame < frames; ++frame)
    network::prepare_frame(std::span(temp_c).subspan(frame * frame_pixels, frame_pixels), shape_, scaling_,
                           place.subspan(frame * shape_.pixels(), shape_.pixels()));
}

/// What does not depend on a turn is done first, in place; the mirror is the kernels'.
void WindowSet::prepare(std::size_t index, network::Turn turn, std::span<float> place) const {
  std::array<float, network::max_frames * frame_pixels> whole;
  const std::span<float> window =
      turn.without_mirror().is_none() ? place : std::span(whole).first(place.size());
  if (const float* const frames = in_memory(index))
    std::copy_n(frames, window.size(), window.data());
  else
    read(index, window);
  if (scaling_.by_window) network::scale_window(window, shape_);
  if (window.data() != place.data()) network::turn_window(window, shape_, turn.without_mirror(), place);
}

BatchBuffer::BatchBuffer(const WindowSet& set)
    : set_(set), prepared_(network::max_batch * set.shape().inputs()) {}

void BatchBuffer::clear() {
  sources_.clear();
  has_unprepared_ = false;
  frames_.clear();
  gyro_.clear();
  label_.clear();
  mirrored_.clear();
}

void BatchBuffer::add(std::size_t index, network::Turn turn) {
  const float* const ready = turn.without_mirror().is_none() ? set_.frames(index) : nullptr;
  add({.index = index, .turn = turn}, ready, set_.label(index), set_.gyro(index));
}

void BatchBuffer::add(const MadeWindow& window, network::Turn turn) {
  const float* const ready = turn.without_mirror().is_none() ? window.frames : nullptr;
  add({.made = window.frames, .turn = turn}, ready, window.label, window.gyro);
}

void BatchBuffer::add(const Source& source, const float* ready, float label, float gyro) {
  const float sign = source.turn.sign();
  frames_.push_back(ready != nullptr ? ready : place_of(sources_.size()).data());
  sources_.push_back(source);
  has_unprepared_ = has_unprepared_ || ready == nullptr;
  gyro_.push_back(sign * gyro);
  label_.push_back(sign * label);
  mirrored_.push_back(source.turn.mirrored() ? 1 : 0);
}

std::span<float> BatchBuffer::place_of(std::size_t place) {
  const std::size_t window = set_.shape().inputs();
  return std::span(prepared_).subspan(place * window, window);
}

void BatchBuffer::prepare(std::size_t place) {
  const Source& source = sources_[place];
  const std::span<float> to = place_of(place);
  if (frames_[place] != to.data()) return;
  if (source.made == nullptr) return set_.prepare(source.index, source.turn, to);
  network::turn_window({source.made, to.size()}, set_.shape(), source.turn.without_mirror(), to);
}

network::Batch BatchBuffer::batch() const {
  network::Batch batch{.frames = frames_, .gyro = {}, .label = label_, .mirrored = mirrored_};
  if (set_.shape().fusion) batch.gyro = gyro_;
  return batch;
}

}  // namespace thermorig::training
