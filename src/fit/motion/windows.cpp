// SPDX-License-Identifier: MIT
#include "windows.h"

#include <algorithm>
#include <cmath>

namespace thermorig::motion {
namespace {

constexpr double resting_dps = 3.0;
constexpr double even_dps = 3.0;  // the shaft's own ripple, averaged over a third of an exposure
constexpr double even_share = 0.2;
constexpr std::size_t rests_kept = 8;  // one of so many
constexpr std::size_t turn_rests_kept = 3;
constexpr std::size_t turn_halves = 700;
constexpr std::size_t window_halves = 500;  // a minute at 8 half-fresh frames a second
constexpr double longest_window_s = 150.0;

std::vector<FreshHalf> without_most_rests(std::span<const FreshHalf> halves, std::size_t one_of) {
  std::vector<FreshHalf> kept;
  std::size_t resting = 0;
  for (const FreshHalf& half : halves) {
    const bool moves = std::abs(half.rate_dps) > resting_dps;
    if (moves || resting % one_of == 0) kept.push_back(half);
    resting = moves ? 0 : resting + 1;
  }
  return kept;
}

/// A half during which the rig speeds up or slows down is smeared unevenly: the eye is drawn to where it
/// lingered. Those are left out, unless the rig never does anything else.
std::vector<FreshHalf> steady(std::vector<FreshHalf> halves) {
  const auto is_uneven = [](const FreshHalf& half) {
    return half.rate_change_dps > even_dps + even_share * std::abs(half.rate_dps);
  };
  const auto uneven = static_cast<std::size_t>(std::count_if(halves.begin(), halves.end(), is_uneven));
  if (uneven * 5 > halves.size() * 3) return halves;
  std::erase_if(halves, is_uneven);
  return halves;
}

/// Cuts what lies in one stretch of the gyro into equal windows.
void cut_evenly(std::span<const FreshHalf> run, std::vector<Window>& windows) {
  const double duration_s = run.back().end_s - run.front().begin_s;
  const double parts_by_time = std::ceil(duration_s / longest_window_s);
  const double parts_by_count = std::round(static_cast<double>(run.size()) / window_halves);
  const auto parts = static_cast<std::size_t>(std::max({1.0, parts_by_time, parts_by_count}));
  for (std::size_t i = 0; i < parts; ++i) {
    const auto part =
        run.subspan(run.size() * i / parts, run.size() * (i + 1) / parts - run.size() * i / parts);
    windows.emplace_back(part.begin(), part.end());
  }
}

/// Windows of up to `turn_halves` and `longest_window_s`, each of which begins in the middle of the one
/// before.
void cut_overlapping(std::span<const FreshHalf> run, std::vector<Window>& windows) {
  for (std::size_t begin = 0; begin < run.size();) {
    std::size_t end = begin;
    while (end < run.size() && end - begin < turn_halves &&
           run[end].end_s - run[begin].begin_s < longest_window_s)
      ++end;
    if (end == begin) ++end;
    windows.emplace_back(run.begin() + static_cast<std::ptrdiff_t>(begin),
                         run.begin() + static_cast<std::ptrdiff_t>(end));
    if (end == run.size()) return;
    begin += std::max<std::size_t>(1, (end - begin) / 2);
  }
}

template <typename Cut>
std::vector<Window> cut_stretches(std::span<const FreshHalf> halves, const Cut& cut) {
  std::vector<Window> windows;
  for (std::size_t begin = 0; begin < halves.size();) {
    std::size_t end = begin + 1;
    while (end < halves.size() && halves[end].stretch == halves[begin].stretch) ++end;
    cut(halves.subspan(begin, end - begin), windows);
    begin = end;
  }
  return windows;
}

/// `most` of them, evenly spread.
std::vector<Window> some_of(std::vector<Window> windows, std::size_t most) {
  if (windows.size() <= most) return windows;
  std::vector<Window> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(std::move(windows[i * windows.size() / most]));
  return some;
}

}  // namespace

std::vector<Window> moving_windows(std::span<const FreshHalf> halves, std::size_t most) {
  const std::vector<FreshHalf> kept = steady(without_most_rests(halves, rests_kept));
  return some_of(cut_stretches(kept, cut_evenly), most);
}

std::vector<Window> turning_windows(std::span<const FreshHalf> halves, std::size_t most) {
  const std::vector<FreshHalf> kept = steady(without_most_rests(halves, turn_rests_kept));
  return some_of(cut_stretches(kept, cut_overlapping), most);
}

RateRange rates_of(std::span<const FreshHalf> halves) {
  RateRange range;
  for (const FreshHalf& half : halves) {
    range.negative_dps = std::min(range.negative_dps, half.rate_dps);
    range.positive_dps = std::max(range.positive_dps, half.rate_dps);
  }
  return range;
}

double fastest_dps(std::span<const FreshHalf> halves) {
  const RateRange range = rates_of(halves);
  return std::max(range.positive_dps, -range.negative_dps);
}

}  // namespace thermorig::motion
