// SPDX-License-Identifier: MIT
#include "gyro_search.h"

#include <algorithm>
#include <cmath>

namespace thermorig::odometer {

namespace {

constexpr double bias_reach_dps = 30.0, scale_reach_sigmas = 2.2;
constexpr std::size_t most_candidates = 16384, kept = 64, parts = 2;  // each step becomes so many finer ones
constexpr std::size_t work_a_step = 300'000;                          // looks
constexpr double trusted = 0.1;  // of the likelihood: halves are blurred, and what moves is in several of them
constexpr float no_look = 1e-9F;  // of an empty cell: it can be divided by that
constexpr double named_rate_dps = 1.0;  // one standard deviation, at the speed of those halves
// Time stamps, rows and lens are off in all halves alike.
constexpr double searched_bias_sigma_dps = 0.3, searched_scale_sigma = 0.003;

/// As many steps to either side of the middle as reach so far, but at most so many.
std::size_t steps_to(double reach, double step, std::size_t most) {
  return std::min(most, static_cast<std::size_t>(std::ceil(reach / step)));
}

}  // namespace

GyroSearch::GyroSearch(const Priors& priors, const SharedLens& lens, bool latency_measured)
    : priors_(priors), lens_(lens), latency_measured_(latency_measured) {
  for (std::size_t i = 0; i < looks; ++i)
    bearing_turns_[i] = static_cast<float>(
        share_of_turn(0.5 * (lens_->bearing_deg(2 * i) + lens_->bearing_deg(2 * i + 1))));
  placed_.reserve(most_halves);
  cells_.reserve(frame_pixels);
  candidates_.reserve(most_candidates);
  best_.reserve(kept);
}

void GyroSearch::clear() {
  found_.reset();
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
  const HalfReading& newest = store.at(store.count() - 1).half;
  period_s_ = newest.end_s - newest.begin_s;
  for (std::size_t i = store.count() - std::min(store.count(), most_halves); i < store.count(); ++i) {
    const HalfReading& half = store.at(i).half;
    if (half.begin_s > path.begin_s()) place(half, path);
  }
  if (placed_.size() < fewest_halves) return;
  read_dps_ = (placed_.back().mean_deg - placed_.front().mean_deg) /
              (placed_.back().mean_s - placed_.front().mean_s);
  take_off_errors_of_looks();
  squares_ = readings_ = 0.0;
  for (const Placed& one : placed_)
    for (std::size_t i = 0; i < looks; ++i) {
      readings_ += double{rows * one.is_read[i]};
      for (const float temp_c : one.temp_c[i]) squares_ += square(double{temp_c});
    }
  lay_grid();
}

void GyroSearch::place(const HalfReading& half, const GyroPath& path) {
  const ExposedTurn turn = path.over(half.begin_s, half.end_s);
  Placed& placed = placed_.emplace_back(Placed{.temp_c = {},
                                               .is_read = {},
                                               .parity = half.parity,
                                               .mean_s = turn.mean_s,
                                               .mean_deg = turn.mean_deg,
                                               .read_dps = turn.mean_read_dps()});
  float sum = 0.0F, count = 0.0F;
  for (std::size_t i = 0; i < looks; ++i) {
    const float* const left = &half.temp_c[2 * i * half_rows + first_row];
    const float* const right = left + half_rows;
    float of_look = 0.0F;
    for (std::size_t k = 0; k < rows; ++k) of_look += placed.temp_c[i][k] = 0.5F * (left[k] + right[k]);
    placed.is_read[i] = std::isnan(of_look) ? 0.0F : 1.0F;
    if (std::isnan(of_look)) continue;
    sum += of_look;
    count += rows;
  }
  const float common_c = count > 0.0F ? sum / count : 0.0F;
  for (std::size_t i = 0; i < looks; ++i)
    for (float& temp_c : placed.temp_c[i]) temp_c = placed.is_read[i] > 0.0F ? temp_c - common_c : 0.0F;
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

/// A step moves the outermost halves by two cells against the middle ones: the nearest candidate is half a
/// cell off there at most.
void GyroSearch::lay_grid() {
  level_ = 0;
  next_ = 0;
  const double cell_deg = 4.0 * lens_->pitch_deg();
  const auto [least, most] = std::minmax_element(
      placed_.begin(), placed_.end(), [](const Placed& a, const Placed& b) { return a.mean_deg < b.mean_deg; });
  const double turned_deg = std::max(cell_deg, most->mean_deg - least->mean_deg);
  const double spanned_s = placed_.back().mean_s - placed_.front().mean_s;
  step_dps_ = 2.0 * cell_deg / spanned_s;
  scale_step_ = 2.0 * cell_deg / turned_deg;
  const double scale_reach = scale_reach_sigmas * priors_.scale_sigma;
  const std::size_t biases = steps_to(bias_reach_dps, step_dps_, 64);
  const std::size_t scales = steps_to(scale_reach, scale_step_, 31);
  const bool may_be_last_row = !lens_->knows_rows() && !latency_measured_;
  candidates_.clear();
  for (std::size_t late = 0; late < (may_be_last_row ? 2U : 1U); ++late)
    for (std::size_t s = 0; s < 2 * scales + 1; ++s)
      for (std::size_t b = 0; b < 2 * biases + 1; ++b)
        candidates_.push_back({.bias_dps = priors_.bias_dps + step_dps_ * (double(b) - double(biases)),
                               .scale = priors_.scale + scale_step_ * (double(s) - double(scales)),
                               .latency_s = priors_.latency_s + 0.5 * period_s_ * double(late)});
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
  const std::size_t count = std::min(kept, candidates_.size());
  std::partial_sort(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(count),
                    candidates_.end(), [](const Candidate& a, const Candidate& b) {
                      return a.log_likelihood > b.log_likelihood;
                    });
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

/// Of the readings within the cells of the mosaic: their squares, which no candidate changes, less those of
/// means.
double GyroSearch::variance(const Candidate& candidate) {
  const double pitches = level_ == 0 ? 4.0 : 2.0;
  const auto all = static_cast<std::size_t>(whole_turn_deg / (pitches * lens_->pitch_deg()));
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
  return (squares_ - of_means) / (readings_ - used + 1.0);
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
  found.bias_sigma_dps = std::hypot(std::sqrt(std::max(0.0, bias2 / sum - square(bias))), searched_bias_sigma_dps);
  found.scale_sigma = std::hypot(std::sqrt(std::max(0.0, scale2 / sum - square(scale))), searched_scale_sigma);
  found.bias_scale_covariance = both / sum - bias * scale;
  const double turned_dps = (read_dps_ - found.bias_dps) / found.scale;
  const double rate_variance = square(found.bias_sigma_dps) + square(turned_dps * found.scale_sigma) +
                               2.0 * turned_dps * found.bias_scale_covariance;
  if (rate_variance < square(named_rate_dps)) found_ = found;
}

}  // namespace thermorig::odometer
