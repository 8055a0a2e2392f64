// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "speed_table.h"
#include "thermorig/core/time.h"
#include "window_lines.h"

namespace thermorig::likelihood {

/// The rate by the window's own images: what was expected before it is not in it.
struct EarlierRate {
  HostTime end{};  // of its exposures
  double rate_dps = 0.0, sigma_dps = 0.0;
};

/// What the windows before have shown: what is expected of the next one. Each speaks for itself, so that one
/// that is wrong is gone as soon as there is another.
class EarlierRates {
 public:
  void add(const EarlierRate& earlier);

  /// The newest one that ended before that time: it shares no half with a window that begins then. Its sigma
  /// holds that the rate has changed since, until `end`.
  std::optional<EarlierRate> expected(HostTime begin, HostTime end) const;

 private:
  std::array<EarlierRate, most_halves> told_{};  // the newest is the last one; one less may share halves
  std::size_t count_ = 0;
};

/// What a window tells of the camera's speed.
struct SpeedPosterior {
  double speed = 0.0;           // mean over all that may be, by how likely they are: pitches an exposure
  double sigma = 0.0;           // standard deviation of those
  bool is_at_end = false;       // of the speeds that were tried: it may be faster
  double noise_variance = 0.0;  // of a reading: of what no scene at that speed explains
};

/// A speed that is expected before the window is looked at: Cauchy's density, half of it within `width`. Any
/// speed is possible before, however far off, so that a window that tells another one outweighs it.
struct ExpectedSpeed {
  double speed = 0.0, width = 1.0;  // above 0
};

struct SearchDepth;

/// Finds the speed with which the halves of a window agree on one piece of scene. The scene is a Gaussian
/// process of which nothing is known but how its parts go together, seen through noise; the likelihood of all
/// speeds is computed, roughly first and then where they may be.
class SpeedSearch {
 public:
  SpeedSearch();

  /// `noise_variance`: of a reading, as known before, above 0. `fastest`: no speed beyond is tried.
  SpeedPosterior search(const WindowLines& lines, double noise_variance, double fastest);

  /// What the search found last, if that was expected before it.
  SpeedPosterior expecting(const ExpectedSpeed& expected) const;

 private:
  struct Fit {
    double logarithm = 0.0;           // of the likelihood
    double unexplained = 0.0;         // energy beside all patterns
    double degrees_of_freedom = 0.0;  // of that
  };
  struct Range {
    std::size_t low = 0, high = 0;
  };

  Fit fit(const WindowLines& lines, std::size_t place, const SearchDepth& depth, double noise_variance) const;
  double fine(const WindowLines& lines, std::size_t place, double noise_variance);
  void look(const WindowLines& lines, double noise_variance, Range range);
  std::size_t top(const WindowLines& lines, double noise_variance, Range range);
  /// `prior`: logarithm of a speed's density before.
  template <typename Prior>
  void sum_up(const Prior& prior, SpeedPosterior& posterior) const;

  std::vector<double> rough_, fine_;  // logarithm of each speed's likelihood; fine: NaN where not known
  std::span<const SpeedPatterns> speeds_;
  Range range_;
  std::size_t top_ = 0;
  SpeedPosterior found_;
};

}  // namespace thermorig::likelihood
