// SPDX-License-Identifier: MIT
#include "speed_search.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace thermorig::likelihood {

namespace {

constexpr std::size_t waves_a_time = 4;
constexpr std::size_t rough_step = 2, rough_waves = 1 + waves_a_time, rough_patterns = 16;
constexpr double seen_variance = 0.05;       // of a pattern, in the noise's: what is less changes nothing
constexpr double most_contrast = 1e6;        // of a scene's variance in the noise's: products stay finite
constexpr double distinct_logarithm = 12.0;  // a mode that is less likely by so much has no weight
constexpr std::size_t most_climbs = 12;
constexpr double trusted = 0.7;  // of the likelihood: scenes are not Gaussian, nor speeds constant

/// Patterns side by side: eight sums do not wait for each other.
using Side = Eigen::Array<float, static_cast<int>(patterns_a_group), 1>;

/// What the patterns of one speed explain of one class of rows.
struct Explained {
  double energy = 0.0;       // of it, in units of the noise's variance
  double logarithm = 0.0;    // of the product of 1 + their variances in those units
  double seen = 0.0;         // all that lies along the patterns
  std::size_t patterns = 0;  // of all waves
};

/// The lines of one class of rows: `waves` waves of each, `stride` numbers apart.
struct Lines {
  const float* values = nullptr;
  std::size_t stride = 1, count = 0;
};

/// How much of each pattern of a group there is in each wave.
template <std::size_t waves>
std::array<Side, waves> along(const float* group, const Lines& lines) {
  std::array<Side, waves> even, odd;
  even.fill(Side::Zero());
  odd.fill(Side::Zero());
  for (std::size_t i = 0; i < lines.count; i += 2) {
    const Eigen::Map<const Side> pattern(group + i * patterns_a_group), next(pattern.data() + pattern.size());
    const float *here = lines.values + i * lines.stride, *behind = here + lines.stride;
    for (std::size_t wave = 0; wave < waves; ++wave) even[wave] += pattern * here[wave];
    for (std::size_t wave = 0; wave < waves; ++wave) (waves == 1 ? odd : even)[wave] += next * behind[wave];
  }
  if constexpr (waves == 1) even[0] += odd[0];
  return even;
}

/// `variance`: of the scene, a wave each, in units of the noise's; of no more waves than `waves`.
template <std::size_t waves>
void explain(const Lines& lines, const SpeedPatterns& table, std::span<const float> variance,
             std::size_t most_patterns, Explained& out) {
  const float most = *std::max_element(variance.begin(), variance.end());
  const std::size_t all = std::min(most_patterns, table.variance.size());
  std::size_t end = 0;
  while (end < all && table.variance[end] * most >= static_cast<float>(seen_variance))
    end += patterns_a_group;
  Side energy = Side::Zero(), seen = Side::Zero();
  for (std::size_t first = 0; first < end; first += patterns_a_group) {
    const auto found = along<waves>(&table.pattern[first * lines.count], lines);
    const Eigen::Map<const Side> own(&table.variance[first]);
    Side growth = Side::Ones();
    for (std::size_t wave = 0; wave < variance.size(); ++wave) {
      const Side ratio = own * variance[wave], square = found[wave].square();
      seen += square;
      energy += square * ratio / (1.0F + ratio);
      growth *= 1.0F + ratio;
    }
    out.logarithm += std::log(growth.cast<double>().prod());
  }
  out.energy += double{energy.sum()};
  out.seen += double{seen.sum()};
  out.patterns += variance.size() * std::min(end, table.count);
}

/// The speeds for which a place of the table stands.
double width_of(std::span<const SpeedPatterns> speeds, std::size_t place) {
  const std::size_t next = std::min(place + 1, speeds.size() - 1), before = place > 0 ? place - 1 : 0;
  return (speeds[next].speed - speeds[before].speed) / static_cast<double>(next - before);
}

}  // namespace

SpeedSearch::SpeedSearch() {
  const std::size_t places = SpeedTable::of(least_halves).plain().size();
  rough_.resize(places);
  fine_.resize(places);
}

/// Of the scene's variance by wave that is taken which the window's own energy has at that speed.
SpeedSearch::Fit SpeedSearch::fit(const WindowLines& lines, std::size_t place, std::size_t waves,
                                  std::size_t most_patterns, double noise_variance) const {
  const auto plain = SpeedTable::of(lines.halves()).plain();
  const auto centred = SpeedTable::of(lines.halves()).centred();
  Fit fit;
  for (std::size_t row_class = 0; row_class < 2; ++row_class) {
    const std::size_t at = row_class == 0 ? place : plain.size() - 1 - place;
    std::array<float, half_rows> variance{};
    for (std::size_t wave = 0; wave < waves; ++wave) {
      const auto freedom = static_cast<double>(lines.lines() - (wave == 0 ? lines.halves() : 0));
      const double contrast = lines.energy(wave) / (2.0 * freedom * noise_variance) - 1.0;
      const double trace = (wave == 0 ? centred : plain)[at].trace;
      variance[wave] = static_cast<float>(std::clamp(contrast, 0.0, most_contrast) * freedom / trace);
    }
    const std::span all(variance);
    Explained explained;
    explain<1>({lines.longest(row_class), 1, lines.lines()}, centred[at], all.first(1), most_patterns,
               explained);
    for (std::size_t wave = 1; wave < waves; wave += waves_a_time)
      explain<waves_a_time>({lines.waves(row_class) + wave, half_rows, lines.lines()}, plain[at],
                            all.subspan(wave, std::min(waves_a_time, waves - wave)), most_patterns,
                            explained);
    fit.logarithm += 0.5 * trusted * (explained.energy / noise_variance - explained.logarithm);
    fit.unexplained -= explained.seen;
    fit.freedom += static_cast<double>(waves * lines.lines() - lines.halves() - explained.patterns);
  }
  for (std::size_t wave = 0; wave < waves; ++wave) fit.unexplained += lines.energy(wave);
  return fit;
}

void SpeedSearch::look_roughly(const WindowLines& lines, double noise_variance, Range range) {
  for (std::size_t k = range.low; k <= range.high; k += rough_step)
    rough_[k] = fit(lines, k, rough_waves, rough_patterns, noise_variance).logarithm;
}

/// The likeliest tops of the rough likelihood.
void SpeedSearch::find_modes(Range range) {
  double best = rough_[range.low];
  for (std::size_t k = range.low; k <= range.high; k += rough_step) best = std::max(best, rough_[k]);
  mode_count_ = 0;
  for (std::size_t k = range.low; k <= range.high; k += rough_step) {
    const bool is_top = (k == range.low || rough_[k] >= rough_[k - rough_step]) &&
                        (k == range.high || rough_[k] > rough_[k + rough_step]);
    if (!is_top || rough_[k] < best - distinct_logarithm) continue;
    if (mode_count_ < most_modes) {
      modes_[mode_count_++].place = k;
      continue;
    }
    Mode& least = *std::min_element(modes_.begin(), modes_.end(), [this](const Mode& a, const Mode& b) {
      return rough_[a.place] < rough_[b.place];
    });
    if (rough_[least.place] < rough_[k]) least.place = k;
  }
}

double SpeedSearch::fine(const WindowLines& lines, std::size_t place, double noise_variance) {
  double& logarithm = fine_[place];
  if (std::isnan(logarithm))
    logarithm = fit(lines, place, half_rows, lines.lines(), noise_variance).logarithm;
  return logarithm;
}

/// Uphill from a place, then the top of the parabola through three.
SpeedSearch::Mode SpeedSearch::refined(const WindowLines& lines, std::size_t place, double noise_variance,
                                       Range range) {
  const auto at = [&](std::size_t k) { return fine(lines, k, noise_variance); };
  for (std::size_t climb = 0; climb < most_climbs && place > range.low && place < range.high; ++climb) {
    const double here = at(place), up = at(place + 1), down = at(place - 1);
    if (std::max(up, down) <= here) break;
    up > down ? ++place : --place;
  }
  const auto speeds = SpeedTable::of(lines.halves()).plain();
  const double width = width_of(speeds, place);
  Mode mode{.place = place, .logarithm = at(place), .speed = speeds[place].speed, .variance = width * width};
  mode.is_at_end = place <= range.low || place >= range.high;
  if (mode.is_at_end) return mode;
  const double x0 = speeds[place - 1].speed - mode.speed, x1 = speeds[place + 1].speed - mode.speed;
  const double y0 = at(place - 1) - mode.logarithm, y1 = at(place + 1) - mode.logarithm;
  const double bend = (y1 / x1 - y0 / x0) / (x1 - x0), slope = y0 / x0 - bend * x0;
  if (!(bend < 0.0)) return mode;
  const double top = std::clamp(-0.5 * slope / bend, x0, x1);
  mode.speed += top;
  mode.logarithm += (bend * top + slope) * top;
  mode.variance = -0.5 / bend;
  return mode;
}

SpeedPosterior SpeedSearch::search(const WindowLines& lines, double noise_variance, double fastest) {
  const auto speeds = SpeedTable::of(lines.halves()).plain();
  const std::size_t middle = speeds.size() / 2;
  std::size_t reach = rough_step;
  while (reach + rough_step <= middle && speeds[middle + reach + rough_step].speed <= fastest)
    reach += rough_step;
  const Range range{middle - reach, middle + reach};
  look_roughly(lines, noise_variance, range);
  find_modes(range);
  std::fill(fine_.begin(), fine_.end(), std::numeric_limits<double>::quiet_NaN());
  for (Mode& mode : std::span(modes_).first(mode_count_))
    mode = refined(lines, mode.place, noise_variance, range);
  const auto end = modes_.begin() + static_cast<std::ptrdiff_t>(mode_count_);
  const Mode top = *std::max_element(modes_.begin(), end,
                                     [](const Mode& a, const Mode& b) { return a.logarithm < b.logarithm; });
  SpeedPosterior posterior{.is_at_end = top.is_at_end};
  double mass = 0.0, sum = 0.0, squares = 0.0;
  std::for_each(modes_.begin(), end, [&](const Mode& mode) {
    const double own = std::exp(mode.logarithm - top.logarithm) * std::sqrt(mode.variance);
    const double off = mode.speed - top.speed;
    mass += own;
    sum += own * off;
    squares += own * (mode.variance + off * off);
  });
  posterior.speed = top.speed + sum / mass;
  posterior.sigma = std::sqrt(std::max(0.0, squares / mass - (sum / mass) * (sum / mass)));
  const Fit best = fit(lines, top.place, half_rows, lines.lines(), noise_variance);
  posterior.noise_variance = best.unexplained / best.freedom;
  return posterior;
}

}  // namespace thermorig::likelihood
