// SPDX-License-Identifier: MIT
#include "gyro_search.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/statistics.h"

namespace thermorig::odometer {

namespace {

constexpr double bias_reach_dps = 30.0, scale_reach_sigmas = 2.2;
constexpr int most_bias_steps = 64, most_scale_steps = 31;  // to either side
constexpr std::size_t most_candidates = 2 * (2 * most_bias_steps + 1) * (2 * most_scale_steps + 1);
constexpr std::size_t most_kept = 64;                       // of a level: each becomes four of the next one
constexpr double coarse_pitches = 4.0, fine_pitches = 2.0;  // of the lens, a cell
constexpr std::size_t work_a_step = 300'000;                // looks
constexpr double trusted = 0.1;  // of the likelihood: halves are blurred, and what moves is in several
constexpr float clipped_deviations = 1.0F;  // from the median, in the median of such deviations
constexpr float no_look = 1e-9F;            // of an empty cell: it can be divided by that
constexpr double named_rate_dps = 1.0;      // one standard deviation, at the speed of those halves
// Time stamps, rows and lens are off in all halves alike.
constexpr double searched_bias_sigma_dps = 0.3, searched_scale_sigma = 0.003;

/// Biases within 1 deg/s and scales within 1.5 %, or both within three deviations.
bool is_same_gyro(const Priors& one, const Priors& other) {
  constexpr double most_sigmas = 3.0, same_bias_dps = 1.0;
  const double bias_sigma_dps = std::hypot(one.bias_sigma_dps, other.bias_sigma_dps);
  const double scale_sigma = std::hypot(one.scale_sigma, other.scale_sigma);
  return std::abs(one.bias_dps - other.bias_dps) < std::max(same_bias_dps, most_sigmas * bias_sigma_dps) &&
         std::abs(one.scale - other.scale) < std::max(same_scale, most_sigmas * scale_sigma);
}

}  // namespace

GyroSearch::GyroSearch(const Priors& priors, const SharedLens& lens, bool latency_measured)
    : priors_(priors), lens_(lens), latency_measured_(latency_measured) {
  for (std::size_t i = 0; i < looks; ++i)
    bearing_turns_[i] =
        static_cast<float>(share_of_turn(0.5 * (lens_->bearing_deg(2 * i) + lens_->bearing_deg(2 * i + 1))));
  placed_.reserve(most_halves);
  read_c_.reserve(looks * rows);
  cells_.reserve(cells_a_turn(fine_pitches) + 1);
  candidates_.reserve(most_candidates);
  best_.reserve(most_kept);
}

void GyroSearch::clear() {
  found_.reset();
  other_.reset();
  level_ = levels;
  new_halves_ = 0;
}

void GyroSearch::add(const HalfStore& store, const GyroPath& path) {
  ++new_halves_;
  if (is_searching()) return go_on();
  if (store.count() >= fewest_halves && new_halves_ >= halves_between) begin(store, path);
}

void GyroSearch::begin(const HalfStore& store, const GyroPath& path) {
  new_halves_ = 0;
  placed_.clear();
  for (std::size_t i = store.count() - std::min(store.count(), most_halves); i < store.count(); ++i) {
    const HalfReading& half = store.at(i).half;
    if (half.begin_s > path.begin_s()) place(half, path);
  }
  if (placed_.size() < fewest_halves) return;
  take_off_errors_of_looks();
  squares_ = readings_ = 0.0;
  for (const Placed& one : placed_)
    for (std::size_t i = 0; i < looks; ++i) {
      readings_ += double{rows * one.is_read[i]};
      for (const float temp_c : one.temp_c[i]) squares_ += square(double{temp_c});
    }
  const HalfReading& newest = store.at(store.count() - 1).half;
  lay_grid(newest.end_s - newest.begin_s);
}

double GyroSearch::spanned_s() const {
  return std::max(1.0, placed_.back().mean_s - placed_.front().mean_s);
}

void GyroSearch::place(const HalfReading& half, const GyroPath& path) {
  const ExposedTurn turn = path.over(half.begin_s, half.end_s);
  Placed& placed = placed_.emplace_back(Placed{.temp_c = {},
                                               .is_read = {},
                                               .parity = half.parity,
                                               .mean_s = turn.mean_s,
                                               .mean_deg = turn.mean_deg,
                                               .read_dps = turn.mean_read_dps()});
  for (std::size_t i = 0; i < looks; ++i) {
    const float* const left = &half.temp_c[2 * i * half_rows + first_row];
    const float* const right = left + half_rows;
    float of_look = 0.0F;
    for (std::size_t k = 0; k < rows; ++k) of_look += placed.temp_c[i][k] = 0.5F * (left[k] + right[k]);
    placed.is_read[i] = std::isnan(of_look) ? 0.0F : 1.0F;
  }
  clip(placed);
}

/// About what all have in common. Something warm that moves would make the sharpest mosaic by itself.
void GyroSearch::clip(Placed& placed) {
  read_c_.clear();
  for (std::size_t i = 0; i < looks; ++i)
    if (placed.is_read[i] > 0.0F)
      read_c_.insert(read_c_.end(), placed.temp_c[i].begin(), placed.temp_c[i].end());
  const float common_c = reordering_median(read_c_);
  for (float& temp_c : read_c_) temp_c = std::abs(temp_c - common_c);
  const float most_c = clipped_deviations * reordering_median(read_c_);
  for (std::size_t i = 0; i < looks; ++i)
    for (float& temp_c : placed.temp_c[i])
      temp_c = placed.is_read[i] > 0.0F ? std::clamp(temp_c - common_c, -most_c, most_c) : 0.0F;
}

/// What a look shows on average beyond its neighbours is its own error. Otherwise the mosaic is sharpest
/// where nothing seems to move.
void GyroSearch::take_off_errors_of_looks() {
  for (const unsigned parity : {0U, 1U}) {
    std::array<Look, looks + 2> mean{};
    float count = no_look;
    for (const Placed& one : placed_) {
      if (one.parity != parity) continue;
      count += 1.0F;
      for (std::size_t i = 0; i < looks; ++i)
        for (std::size_t k = 0; k < rows; ++k) mean[i + 1][k] += one.temp_c[i][k];
    }
    mean.front() = mean[1];
    mean.back() = mean[looks];
    for (Placed& one : placed_) {
      if (one.parity != parity) continue;
      for (std::size_t i = 0; i < looks; ++i)
        for (std::size_t k = 0; k < rows; ++k) {
          const float about = 0.5F * (mean[i][k] + mean[i + 2][k]);
          one.temp_c[i][k] -= one.is_read[i] * (mean[i + 1][k] - about) / count;
        }
    }
  }
}

/// `period_s`: of refresh. A step moves the outermost halves by two cells against the middle ones: the
/// nearest candidate is half a cell off there at most.
void GyroSearch::lay_grid(double period_s) {
  level_ = 0;
  next_ = 0;
  const double cell_deg = coarse_pitches * lens_->pitch_deg();
  const auto [least, most] =
      std::minmax_element(placed_.begin(), placed_.end(),
                          [](const Placed& a, const Placed& b) { return a.mean_deg < b.mean_deg; });
  const double turned_deg = std::max(cell_deg, most->mean_deg - least->mean_deg);
  const double scale_reach = std::min(scale_reach_sigmas * priors_.scale_sigma, 0.5 * priors_.scale);
  step_dps_ = std::max(2.0 * cell_deg / spanned_s(), bias_reach_dps / most_bias_steps);
  scale_step_ = std::max(2.0 * cell_deg / turned_deg, scale_reach / most_scale_steps);
  const auto biases = static_cast<int>(std::ceil(bias_reach_dps / step_dps_));
  const auto scales = static_cast<int>(std::ceil(scale_reach / scale_step_));
  // With the middle row's times alone two of eight simulated rooms whose rows are exposed in turn start after
  // 86 s instead of 43.
  const bool may_be_last_row = !lens_->knows_rows() && !latency_measured_;
  candidates_.clear();
  for (int late = 0; late < (may_be_last_row ? 2 : 1); ++late)
    for (int scale = -scales; scale <= scales; ++scale)
      for (int bias = -biases; bias <= biases; ++bias)
        candidates_.push_back({.bias_dps = priors_.bias_dps + bias * step_dps_,
                               .scale = priors_.scale + scale * scale_step_,
                               .latency_s = priors_.latency_s + 0.5 * late * period_s});
}

void GyroSearch::go_on() {
  const std::size_t looks_of_one = placed_.size() * looks;
  std::size_t work = 0;
  for (; next_ < candidates_.size() && work < work_a_step; ++next_, work += looks_of_one)
    candidates_[next_].log_likelihood = log_before(candidates_[next_]) + log_likelihood(candidates_[next_]);
  if (next_ == candidates_.size()) end_level();
}

void GyroSearch::end_level() {
  ++level_;
  next_ = 0;
  if (!is_searching()) return name();
  refine();
}

void GyroSearch::refine() {
  const std::size_t count = std::min(most_kept, candidates_.size());
  std::partial_sort(
      candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(count), candidates_.end(),
      [](const Candidate& a, const Candidate& b) { return a.log_likelihood > b.log_likelihood; });
  best_.assign(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(count));
  candidates_.clear();
  for (const Candidate& one : best_)
    for (const double bias_steps : {-0.25, 0.25})
      for (const double scale_steps : {-0.25, 0.25}) {
        Candidate finer = one;
        finer.bias_dps += bias_steps * step_dps_;
        finer.scale += scale_steps * scale_step_;
        candidates_.push_back(finer);
      }
  step_dps_ *= 0.5;
  scale_step_ *= 0.5;
}

/// Cauchy's density of a bias, for a profile may be of another day or of another gyro: none is ruled out.
double GyroSearch::log_before(const Candidate& candidate) const {
  return -std::log(1.0 + square((candidate.bias_dps - priors_.bias_dps) / priors_.bias_sigma_dps)) -
         0.5 * square((candidate.scale - priors_.scale) / priors_.scale_sigma);
}

double GyroSearch::log_likelihood(const Candidate& candidate) {
  return -0.5 * trusted * readings_ * std::log(variance(candidate));
}

std::size_t GyroSearch::cells_a_turn(double pitches) const {
  return static_cast<std::size_t>(std::ceil(whole_turn_deg / (pitches * lens_->pitch_deg())));
}

/// Of the readings within the cells of the mosaic: their squares, which no candidate changes, less those of
/// means.
double GyroSearch::variance(const Candidate& candidate) {
  const std::size_t all = cells_a_turn(level_ == 0 ? coarse_pitches : fine_pitches);
  const auto all_cells = static_cast<float>(all);
  cells_.assign(all + 1, Cell());
  for (const Placed& one : placed_) {
    const double turned_deg = (one.mean_deg - candidate.bias_dps * one.mean_s) / candidate.scale;
    const double rate_dps = (one.read_dps - candidate.bias_dps) / candidate.scale;
    const auto turns = static_cast<float>(share_of_turn(turned_deg - candidate.latency_s * rate_dps));
    for (std::size_t i = 0; i < looks; ++i) {
      float azimuth_turns = turns + bearing_turns_[i];
      azimuth_turns -= azimuth_turns >= 1.0F ? 1.0F : 0.0F;
      Cell& cell = cells_[static_cast<std::size_t>(azimuth_turns * all_cells)];
      for (std::size_t k = 0; k < rows; ++k) cell.sum[k] += one.temp_c[i][k];
      cell.count += one.is_read[i];
    }
  }
  double of_means = 0.0, used = 0.0;
  for (const Cell& cell : cells_) {
    if (cell.count == 0.0F) continue;
    used += rows;
    for (const float sum : cell.sum) of_means += double{sum * sum / cell.count};
  }
  constexpr double least_k2 = 1e-6;  // of images that are all the same
  return std::max(least_k2, squares_ - of_means) / std::max(1.0, readings_ - used);
}

void GyroSearch::name() {
  double most = candidates_.front().log_likelihood;
  for (const Candidate& one : candidates_) most = std::max(most, one.log_likelihood);
  double sum = 0.0, bias = 0.0, scale = 0.0, bias2 = 0.0, scale2 = 0.0, both = 0.0;
  for (const Candidate& one : candidates_) {
    const double weight = std::exp(one.log_likelihood - most);
    const double bias_off = one.bias_dps - priors_.bias_dps, scale_off = one.scale - priors_.scale;
    sum += weight;
    bias += weight * bias_off;
    scale += weight * scale_off;
    bias2 += weight * square(bias_off);
    scale2 += weight * square(scale_off);
    both += weight * bias_off * scale_off;
  }
  bias /= sum;
  scale /= sum;
  Priors found = priors_;
  found.bias_dps += bias;
  found.scale += scale;
  // Cells are no finer than two of the last steps.
  const double bias_sigma = std::sqrt(std::max(0.0, bias2 / sum - square(bias)));
  const double scale_sigma = std::sqrt(std::max(0.0, scale2 / sum - square(scale)));
  found.bias_sigma_dps = std::hypot(bias_sigma, 2.0 * step_dps_, searched_bias_sigma_dps);
  found.scale_sigma =
      std::min(std::hypot(scale_sigma, 2.0 * scale_step_, searched_scale_sigma), priors_.scale_sigma);
  found.bias_scale_covariance = both / sum - bias * scale;
  const double read_dps = (placed_.back().mean_deg - placed_.front().mean_deg) / spanned_s();
  const double turned_dps = (read_dps - found.bias_dps) / found.scale;
  const double rate_variance = square(found.bias_sigma_dps) + square(turned_dps * found.scale_sigma) +
                               2.0 * turned_dps * found.bias_scale_covariance;
  if (rate_variance < square(named_rate_dps)) believe(found);
}

/// What was named before stands until two searches in a row name the same other gyro.
void GyroSearch::believe(const Priors& named) {
  const bool is_confirmed =
      !found_ || is_same_gyro(named, *found_) || (other_ && is_same_gyro(named, *other_));
  is_confirmed ? found_ = named : other_ = named;
  if (is_confirmed) other_.reset();
}

}  // namespace thermorig::odometer
