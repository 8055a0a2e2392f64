// SPDX-License-Identifier: MIT
#include "speed_search.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace thermorig::likelihood {

namespace {

// Assumed: a motor holds its rate. A hand does not, and may, since the density of what is expected has heavy
// tails. With 100 the errors of faint rooms are a fifth larger; with 12 turns are known worse.
constexpr double change_dps2 = 25.0;

}  // namespace

void EarlierRates::add(const EarlierRate& earlier) {
  std::rotate(told_.begin(), told_.begin() + 1, told_.end());
  told_.back() = earlier;
  count_ = std::min(count_ + 1, told_.size());
}

std::optional<EarlierRate> EarlierRates::expected(HostTime begin, HostTime end) const {
  for (std::size_t i = 1; i <= count_; ++i) {
    EarlierRate earlier = told_[told_.size() - i];
    if (earlier.end > begin) continue;
    earlier.sigma_dps = std::hypot(earlier.sigma_dps, change_dps2 * to_s(end - earlier.end));
    return earlier;
  }
  return std::nullopt;
}

namespace {

constexpr std::size_t waves_a_time = 4;
static_assert(shared_waves == 1 + waves_a_time);
constexpr std::size_t rough_step = 2, rough_waves = shared_waves, rough_patterns = 16;
constexpr std::size_t patterns_a_product = 4 * patterns_a_group;  // their product is finite
constexpr double seen_variance = 0.05;      // of a pattern, in the noise's: what is less changes nothing
constexpr double most_contrast = 1e6;       // of a scene's variance in the noise's: products stay finite
constexpr double distinct_logarithm = 9.0;  // a speed that is less likely by so much has no weight
constexpr std::size_t most_climbs = 12;
constexpr double trusted = 0.7;   // of the likelihood: scenes are not Gaussian, nor speeds constant
constexpr int parts_a_place = 8;  // in which the likelihood about a speed of the table is summed

// A wave's energy tells its contrast badly where a wall has one window and nothing else: it may be each of
// these times that as well, all as likely before.
constexpr std::array contrasts{0.25F, 1.0F, 4.0F};
constexpr std::array rough_contrasts{1.0F};

}  // namespace

struct SearchDepth {
  std::size_t waves, patterns;
  std::span<const float> contrasts;
};

namespace {

constexpr SearchDepth rough_depth{rough_waves, rough_patterns, rough_contrasts};
constexpr SearchDepth fine_depth{half_rows, 2 * most_halves* line_pixels, contrasts};

/// Patterns side by side: eight sums do not wait for each other.
using Side = Eigen::Array<float, static_cast<int>(patterns_a_group), 1>;

/// What the patterns of one speed explain.
struct Explained {
  std::array<std::array<double, contrasts.size()>, half_rows> doubled{};  // logarithm of the likelihood
  double seen = 0.0;                                                      // all that lies along the patterns
  std::size_t patterns = 0;                                               // of all waves
};

/// The lines of one class of rows, or of both: `waves` waves of each, `stride` numbers apart.
struct Lines {
  std::array<const float*, 2> values{};
  std::size_t classes = 1, stride = 1, class_lines = 0;

  std::size_t count() const { return classes * class_lines; }
};

/// How much of each pattern of a group there is in each wave.
template <std::size_t waves>
std::array<Side, waves> along(const float* group, const Lines& lines) {
  std::array<Side, waves> even, odd;
  even.fill(Side::Zero());
  odd.fill(Side::Zero());
  for (std::size_t row_class = 0; row_class < lines.classes; ++row_class)
    for (std::size_t i = 0; i < lines.class_lines; i += 2, group += 2 * patterns_a_group) {
      const Eigen::Map<const Side> pattern(group), next(pattern.data() + pattern.size());
      const float *here = lines.values[row_class] + i * lines.stride, *behind = here + lines.stride;
      for (std::size_t wave = 0; wave < waves; ++wave) even[wave] += pattern * here[wave];
      for (std::size_t wave = 0; wave < waves; ++wave) (waves == 1 ? odd : even)[wave] += next * behind[wave];
    }
  if constexpr (waves == 1) even[0] += odd[0];
  return even;
}

/// What a wave's patterns explain if its contrast is so large; several groups of them before the logarithm.
struct Gain {
  Side energy = Side::Zero();   // of it, in units of the noise's variance
  Side product = Side::Ones();  // of 1 + their variances in those units

  void add(const Side& square, const Side& ratio) {
    const Side growth = 1.0F + ratio;
    energy += square * ratio / growth;
    product *= growth;
  }
  double doubled() const { return double{energy.sum()} - std::log(product.cast<double>().prod()); }
};

/// Of waves from `first_wave` on. `variance`: of the scene, a wave each, in units of the noise's; of no more
/// waves than `waves`.
template <std::size_t waves>
void explain(const Lines& lines, const SpeedPatterns& table, std::span<const float> variance,
             std::size_t first_wave, const SearchDepth& depth, float noise_variance, Explained& out) {
  const std::size_t choices = depth.contrasts.size();
  const float most = *std::max_element(variance.begin(), variance.end()) * depth.contrasts.back();
  const std::size_t all = std::min(depth.patterns, table.variance.size());
  std::size_t end = 0;
  while (end < all && table.variance[end] * most >= static_cast<float>(seen_variance))
    end += patterns_a_group;
  Side seen = Side::Zero();
  for (std::size_t first = 0; first < end;) {
    std::array<std::array<Gain, contrasts.size()>, waves> gains;
    for (const std::size_t stop = std::min(end, first + patterns_a_product); first < stop;
         first += patterns_a_group) {
      const auto found = along<waves>(&table.pattern[first * lines.count()], lines);
      const Eigen::Map<const Side> own(&table.variance[first]);
      for (std::size_t wave = 0; wave < variance.size(); ++wave) {
        const Side square = found[wave].square() / noise_variance, ratio = own * variance[wave];
        seen += square;
        for (std::size_t k = 0; k < choices; ++k) gains[wave][k].add(square, ratio * depth.contrasts[k]);
      }
    }
    for (std::size_t wave = 0; wave < variance.size(); ++wave)
      for (std::size_t k = 0; k < choices; ++k) out.doubled[first_wave + wave][k] += gains[wave][k].doubled();
  }
  out.seen += double{noise_variance * seen.sum()};
  out.patterns += variance.size() * std::min(end, table.count);
}

/// A wave's contrast is about that which the window's own energy has at that speed.
template <std::size_t waves>
void explain_at(const WindowLines& window, const Lines& lines, const SpeedPatterns& patterns,
                std::size_t first_wave, const SearchDepth& depth, double noise_variance, Explained& out) {
  std::array<float, waves> variance{};
  const std::size_t count = std::min(waves, depth.waves - first_wave);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t wave = first_wave + k;
    const auto degrees_of_freedom = static_cast<double>(window.lines() - (wave == 0 ? window.halves() : 0));
    const double contrast = window.energy(wave) / (2.0 * degrees_of_freedom * noise_variance) - 1.0;
    variance[k] =
        static_cast<float>(std::clamp(contrast, 0.0, most_contrast) * static_cast<double>(lines.classes) *
                           degrees_of_freedom / patterns.trace);
  }
  explain<waves>(lines, patterns, std::span(variance).first(count), first_wave, depth,
                 static_cast<float>(noise_variance), out);
}

/// Of a wave whose contrast is one of several, all as likely before.
double over_contrasts(std::span<const double> doubled) {
  const double best = *std::max_element(doubled.begin(), doubled.end());
  double sum = 0.0;
  for (const double one : doubled) sum += std::exp(0.5 * (one - best));
  return 0.5 * best + std::log(sum);
}

/// A speed of which the logarithm of the likelihood is known, both less those of the top.
struct Known {
  double speed = 0.0, logarithm = 0.0;
};

/// Of all speeds, by how likely they are, off the top.
class Moments {
 public:
  /// What is nearest to `here` of three: the logarithm lies on the parabola through them.
  void add_about(const Known& here, const Known& before, const Known& next) {
    const double x0 = before.speed - here.speed, y0 = before.logarithm - here.logarithm;
    const double x1 = next.speed - here.speed, y1 = next.logarithm - here.logarithm;
    const double bend = (y1 / x1 - y0 / x0) / (x1 - x0), slope = y0 / x0 - bend * x0;
    const double step = 0.5 * (x1 - x0) / parts_a_place;
    for (int part = 0; part < parts_a_place; ++part) {
      const double x = 0.5 * x0 + step * (part + 0.5), speed = here.speed + x;
      const double own = step * std::exp(here.logarithm + (bend * x + slope) * x);
      mass_ += own;
      sum_ += own * speed;
      squares_ += own * speed * speed;
    }
  }
  double mean() const { return sum_ / mass_; }
  double deviation() const { return std::sqrt(std::max(0.0, squares_ / mass_ - mean() * mean())); }

 private:
  double mass_ = std::numeric_limits<double>::min();  // of nothing: the top
  double sum_ = 0.0, squares_ = 0.0;
};

}  // namespace

SpeedSearch::SpeedSearch() : rough_(SpeedTable::speeds()), fine_(SpeedTable::speeds()) {}

SpeedSearch::Fit SpeedSearch::fit(const WindowLines& lines, std::size_t place, const SearchDepth& depth,
                                  double noise_variance) const {
  const SpeedTable& table = SpeedTable::of(lines.halves());
  const std::size_t middle = table.own().size() / 2, opposite = 2 * middle - place;
  const std::size_t first = place >= middle ? 0 : 1, second = 1 - first;
  const std::size_t shared = std::max(place, opposite) - middle;
  Explained explained;
  explain_at<1>(lines, {{lines.longest(first), lines.longest(second)}, 2, 1, lines.lines()},
                table.longest()[shared], 0, depth, noise_variance, explained);
  explain_at<waves_a_time>(lines,
                           {{lines.waves(first) + 1, lines.waves(second) + 1}, 2, half_rows, lines.lines()},
                           table.shared()[shared], 1, depth, noise_variance, explained);
  for (std::size_t wave = shared_waves; wave < depth.waves; wave += waves_a_time)
    for (std::size_t row_class = 0; row_class < 2; ++row_class)
      explain_at<waves_a_time>(lines, {{lines.waves(row_class) + wave}, 1, half_rows, lines.lines()},
                               table.own()[row_class == 0 ? place : opposite], wave, depth, noise_variance,
                               explained);
  Fit fit{.unexplained = -explained.seen};
  for (std::size_t wave = 0; wave < depth.waves; ++wave) {
    fit.unexplained += lines.energy(wave);
    fit.logarithm +=
        trusted * over_contrasts(std::span(explained.doubled[wave]).first(depth.contrasts.size()));
  }
  fit.degrees_of_freedom =
      static_cast<double>(2 * (depth.waves * lines.lines() - lines.halves()) - explained.patterns);
  return fit;
}

double SpeedSearch::fine(const WindowLines& lines, std::size_t place, double noise_variance) {
  double& logarithm = fine_[place];
  if (std::isnan(logarithm)) logarithm = fit(lines, place, fine_depth, noise_variance).logarithm;
  return logarithm;
}

/// All places first, then those that may be.
void SpeedSearch::look(const WindowLines& lines, double noise_variance, Range range) {
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t k = range.low; k <= range.high; k += rough_step) {
    rough_[k] = fit(lines, k, rough_depth, noise_variance).logarithm;
    best = std::max(best, rough_[k]);
  }
  std::fill(fine_.begin(), fine_.end(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = range.low; k <= range.high; k += rough_step)
    if (rough_[k] >= best - distinct_logarithm) fine(lines, k, noise_variance);
}

/// Uphill from the best place so far; then those about it are known, for the top may be narrow.
std::size_t SpeedSearch::top(const WindowLines& lines, double noise_variance, Range range) {
  std::size_t place = range.low;
  for (std::size_t k = range.low; k <= range.high; ++k)
    if (std::isnan(fine_[place]) || fine_[k] > fine_[place]) place = k;
  for (std::size_t climb = 0; climb < most_climbs && place > range.low && place < range.high; ++climb) {
    const double here = fine_[place];
    const double up = fine(lines, place + 1, noise_variance), down = fine(lines, place - 1, noise_variance);
    if (std::max(up, down) <= here) break;
    up > down ? ++place : --place;
  }
  const std::size_t end = std::min(range.high, place + rough_step);
  for (std::size_t k = std::max(range.low + rough_step, place) - rough_step; k <= end; ++k)
    fine(lines, k, noise_variance);
  return place;
}

template <typename Prior>
void SpeedSearch::sum_up(const Prior& prior, SpeedPosterior& posterior) const {
  const double top_speed = speeds_[top_].speed, top_logarithm = fine_[top_] + prior(top_speed);
  Moments moments;
  std::array<Known, 3> known;  // the last three of all
  std::size_t count = 0, last = range_.low;
  for (std::size_t k = range_.low; k <= range_.high; ++k) {
    if (std::isnan(fine_[k])) continue;
    count = k - last <= rough_step ? count + 1 : 1;  // in a row
    last = k;
    std::rotate(known.begin(), known.begin() + 1, known.end());
    const double speed = speeds_[k].speed;
    known.back() = {speed - top_speed, fine_[k] + prior(speed) - top_logarithm};
    if (count >= known.size()) moments.add_about(known[1], known[0], known[2]);
  }
  posterior.speed = top_speed + moments.mean();
  posterior.sigma = moments.deviation();
}

SpeedPosterior SpeedSearch::search(const WindowLines& lines, double noise_variance, double fastest) {
  speeds_ = SpeedTable::of(lines.halves()).own();
  const std::size_t middle = speeds_.size() / 2;
  std::size_t reach = rough_step;
  while (reach + rough_step <= middle && speeds_[middle + reach + rough_step].speed <= fastest)
    reach += rough_step;
  range_ = {middle - reach, middle + reach};
  look(lines, noise_variance, range_);
  top_ = top(lines, noise_variance, range_);
  sum_up([](double) { return 0.0; }, found_);
  found_.is_at_end = top_ <= range_.low || top_ >= range_.high;
  const Fit best = fit(lines, top_, fine_depth, noise_variance);
  found_.noise_variance = best.unexplained / best.degrees_of_freedom;
  return found_;
}

SpeedPosterior SpeedSearch::expecting(const ExpectedSpeed& expected) const {
  const auto prior = [&](double speed) {
    const double widths = (speed - expected.speed) / expected.width;
    return -std::log1p(widths * widths);
  };
  SpeedPosterior posterior = found_;
  sum_up(prior, posterior);
  return posterior;
}

}  // namespace thermorig::likelihood
