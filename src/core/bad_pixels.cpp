// SPDX-License-Identifier: MIT
#include "thermorig/core/bad_pixels.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace thermorig {

namespace {
constexpr std::uint32_t fewest_readings = 24;
constexpr float memory_readings = 256.0F;
// Beyond: no pixel that works (data sheet: 1 K of difference between pixels, or 2 in the corners of a frame).
constexpr float hot_c = 3.0F;
constexpr float stuck_share = 0.1F;      // of the changes around it; those are noise at least
constexpr float least_change_c = 0.02F;  // two steps of what the bridge sends
constexpr float counts_per_c = 100.0F;   // the bridge's steps: frames of these are stored small
constexpr float most_unread = 0.5F;
constexpr std::size_t most_bad = 16;

/// Those of the same chess half around a pixel, at most eight, at least three.
struct Around {
  std::array<std::uint16_t, 8> place{};
  std::size_t count = 0;
};

constexpr Around look_around(std::size_t place) {
  constexpr std::array<std::array<int, 2>, 8> steps{
      {{-1, -1}, {-1, 1}, {1, -1}, {1, 1}, {-2, 0}, {0, -2}, {0, 2}, {2, 0}}};
  Around around;
  for (const auto& [down, right] : steps) {
    const int row = static_cast<int>(place / frame_columns) + down;
    const int column = static_cast<int>(place % frame_columns) + right;
    if (row < 0 || column < 0 || row >= static_cast<int>(frame_rows) ||
        column >= static_cast<int>(frame_columns))
      continue;
    around.place[around.count++] = static_cast<std::uint16_t>(row * static_cast<int>(frame_columns) + column);
  }
  return around;
}

constexpr std::array<Around, frame_pixels> all_arounds = [] {
  std::array<Around, frame_pixels> all{};
  for (std::size_t place = 0; place < frame_pixels; ++place) all[place] = look_around(place);
  return all;
}();

/// A sorting network for eight (Knuth, The Art of Computer Programming 3, 5.3.4): no branch depends on them.
void sort_eight(std::array<float, 8>& values) {
  constexpr std::array<std::uint8_t, 19> low{0, 1, 4, 5, 0, 1, 2, 3, 0, 2, 4, 6, 2, 3, 1, 3, 1, 3, 5};
  constexpr std::array<std::uint8_t, 19> high{2, 3, 6, 7, 4, 5, 6, 7, 1, 3, 5, 7, 4, 5, 4, 6, 2, 4, 6};
  for (std::size_t i = 0; i < low.size(); ++i) {
    const float a = values[low[i]], b = values[high[i]];
    values[low[i]] = std::min(a, b);
    values[high[i]] = std::max(a, b);
  }
}

/// Of those around the pixel; of an even number the lower one. `of` may say that one is no number.
template <typename Of>
float median_around(std::size_t place, Of of) {
  const Around& around = all_arounds[place];
  std::array<float, 8> values;
  values.fill(std::numeric_limits<float>::infinity());
  std::size_t count = 0;
  for (std::size_t i = 0; i < around.count; ++i)
    if (const float value = of(around.place[i]); std::isfinite(value)) values[count++] = value;
  if (count == 0) return 0.0F;
  sort_eight(values);
  return values[(count - 1) / 2];
}

std::optional<std::size_t> number_in(std::string_view text, std::size_t below) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_good = error == std::errc() && end == text.data() + text.size() && number < below;
  return is_good ? std::optional(number) : std::nullopt;
}
}  // namespace

PixelWatch::PixelWatch() {
  bad_.reserve(frame_pixels);
}

void PixelWatch::add(const TimedFrame& frame) {
  if (frame.stale || frame.stands_in) return;
  for (const unsigned parity : {0U, 1U})
    if (frame.is_fresh(parity)) add_half(frame.frame, parity);
  judge();
}

void PixelWatch::add_half(const ThermalFrame& frame, unsigned parity) {
  const std::uint32_t reading = ++readings_[parity];
  const float share = std::max(1.0F / static_cast<float>(reading), 1.0F / memory_readings);
  for (std::size_t place = 0; place < frame_pixels; ++place) {
    if (subpage_of(place / frame_columns, place % frame_columns) != parity) continue;
    Pixel& pixel = pixels_[place];
    const float temp_c = frame.temp_c[place];
    const bool is_read = std::isfinite(temp_c);
    pixel.unread += share * ((is_read ? 0.0F : 1.0F) - pixel.unread);
    if (!is_read) continue;
    const float off_c = temp_c - median_around(place, [&](std::size_t other) { return frame.temp_c[other]; });
    pixel.off_c += share * (off_c - pixel.off_c);
    if (reading > 1) pixel.change_c += share * (std::abs(temp_c - pixel.last_c) - pixel.change_c);
    pixel.last_c = temp_c;
  }
}

bool PixelWatch::is_stuck(std::size_t place) const {
  const float change_c = median_around(place, [&](std::size_t other) { return pixels_[other].change_c; });
  return change_c > least_change_c && pixels_[place].change_c < stuck_share * change_c;
}

void PixelWatch::judge() {
  bad_.clear();
  if (std::min(readings_[0], readings_[1]) < fewest_readings) return;
  const auto by_change = [](const Pixel& a, const Pixel& b) { return a.change_c < b.change_c; };
  const float most_change_c = std::max_element(pixels_.begin(), pixels_.end(), by_change)->change_c;
  for (std::size_t place = 0; place < frame_pixels; ++place) {
    const Pixel& pixel = pixels_[place];
    const bool may_be_stuck =
        pixel.change_c < stuck_share * most_change_c;  // few: those around need not be asked
    if (pixel.unread > most_unread || std::abs(pixel.off_c) > hot_c || (may_be_stuck && is_stuck(place)))
      bad_.push_back(static_cast<std::uint16_t>(place));
  }
  if (bad_.size() > most_bad) bad_.clear();
}

void mend(ThermalFrame& frame, std::span<const std::uint16_t> bad) {
  for (const std::uint16_t place : bad) {
    const Around& around = all_arounds[place];
    float sum_c = 0.0F, count = 0.0F;
    for (std::size_t i = 0; i < around.count; ++i) {
      const float temp_c = frame.temp_c[around.place[i]];
      if (!std::isfinite(temp_c) || std::find(bad.begin(), bad.end(), around.place[i]) != bad.end()) continue;
      sum_c += temp_c;
      count += 1.0F;
    }
    if (count > 0.0F) frame.temp_c[place] = std::round(sum_c / count * counts_per_c) / counts_per_c;
  }
}

std::string text_of(const PixelPlaces& places) {
  std::string text;
  for (const std::uint16_t place : places) {
    if (!text.empty()) text += ' ';
    text.append(std::to_string(place / frame_columns)).append(",");
    text.append(std::to_string(place % frame_columns));
  }
  return text;
}

PixelPlaces pixel_places(std::string_view text) {
  PixelPlaces places;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    const std::size_t comma = std::min(word.find(','), word.size());
    const auto row = number_in(word.substr(0, comma), frame_rows);
    const auto column = number_in(word.substr(std::min(comma + 1, word.size())), frame_columns);
    if (row && column) places.push_back(static_cast<std::uint16_t>(*row * frame_columns + *column));
  }
  return places;
}

}  // namespace thermorig
