// SPDX-License-Identifier: MIT
#include "gyro_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
constexpr double telling_scale = 0.02;      // one standard deviation, for the order of rows
constexpr double latency_step_s = 0.020, latency_reach_sigmas = 2.5;
constexpr std::array all_orders{RowOrder::at_once, RowOrder::first_to_last, RowOrder::last_to_first};
constexpr double named_rate_dps = 1.0;  // one standard deviation, at the speed of those halves
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

bool names_scale(const Priors& found) {
  constexpr double named_scale = 0.009;  // one standard deviation
  return found.scale_sigma < named_scale;
}

GyroSearch::GyroSearch(const Priors& priors, const SharedLens& lens, bool latency_measured)
    : priors_(priors), lens_(lens), latency_measured_(latency_measured), rows_{lens->rows(), 0.0} {
  for (std::size_t i = 0; i < looks; ++i)
    bearing_turns_[i] =
        static_cast<float>(share_of_turn(0.5 * (lens_->bearing_deg(2 * i) + lens_->bearing_deg(2 * i + 1))));
  placed_.reserve(most_halves);
  read_c_.reserve(looks * band_rows);
  cells_.reserve(cells_a_turn(fine_pitches) + 1);
  candidates_.reserve(most_candidates);
  best_.reserve(most_kept);
}

void GyroSearch::clear() {
  found_.reset();
  other_.reset();
  rows_ = {lens_->rows(), 0.0};
  level_ = order_level + 1;
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
  for (std::size_t band = 0; band < bands; ++band) {
    take_off_errors_of_looks(band);
    all_[band] = Squares();
    for (const Placed& one : placed_)
      for (std::size_t i = 0; i < looks; ++i) {
        all_[band].readings += double{band_rows * one.of[band].is_read[i]};
        for (const float temp_c : one.of[band].temp_c[i]) all_[band].k2 += square(double{temp_c});
      }
  }
  lay_grid();
}

double GyroSearch::spanned_s() const {
  return std::max(1.0, placed_.back().mean_s - placed_.front().mean_s);
}

void GyroSearch::place(const HalfReading& half, const GyroPath& path) {
  const ExposedTurn turn = path.over(half.begin_s, half.end_s);
  Placed& placed = placed_.emplace_back(Placed{.of = {},
                                               .parity = half.parity,
                                               .period_s = half.end_s - half.begin_s,
                                               .mean_s = turn.mean_s,
                                               .mean_deg = turn.mean_deg,
                                               .read_dps = turn.mean_read_dps()});
  for (std::size_t n = 0; n < bands; ++n) {
    Band& band = placed.of[n];
    for (std::size_t i = 0; i < looks; ++i) {
      const float* const left = &half.temp_c[2 * i * half_rows + n * band_rows];
      const float* const right = left + half_rows;
      float of_look = 0.0F;
      for (std::size_t k = 0; k < band_rows; ++k) of_look += band.temp_c[i][k] = 0.5F * (left[k] + right[k]);
      band.is_read[i] = std::isnan(of_look) ? 0.0F : 1.0F;
    }
    clip(band);
  }
}

/// About what all have in common. Something warm that moves would make the sharpest mosaic by itself.
void GyroSearch::clip(Band& band) {
  read_c_.clear();
  for (std::size_t i = 0; i < looks; ++i)
    if (band.is_read[i] > 0.0F) read_c_.insert(read_c_.end(), band.temp_c[i].begin(), band.temp_c[i].end());
  const float common_c = reordering_median(read_c_);
  for (float& temp_c : read_c_) temp_c = std::abs(temp_c - common_c);
  const float most_c = clipped_deviations * reordering_median(read_c_);
  for (std::size_t i = 0; i < looks; ++i)
    for (float& temp_c : band.temp_c[i])
      temp_c = band.is_read[i] > 0.0F ? std::clamp(temp_c - common_c, -most_c, most_c) : 0.0F;
}

/// What a look shows on average beyond its neighbours is its own error. Otherwise the mosaic is sharpest
/// where nothing seems to move.
void GyroSearch::take_off_errors_of_looks(std::size_t band) {
  for (const unsigned parity : {0U, 1U}) {
    std::array<Look, looks + 2> mean{};
    float count = no_look;
    for (const Placed& one : placed_) {
      if (one.parity != parity) continue;
      count += 1.0F;
      for (std::size_t i = 0; i < looks; ++i)
        for (std::size_t k = 0; k < band_rows; ++k) mean[i + 1][k] += one.of[band].temp_c[i][k];
    }
    mean.front() = mean[1];
    mean.back() = mean[looks];
    for (Placed& one : placed_) {
      if (one.parity != parity) continue;
      for (std::size_t i = 0; i < looks; ++i)
        for (std::size_t k = 0; k < band_rows; ++k) {
          const float about = 0.5F * (mean[i][k] + mean[i + 2][k]);
          one.of[band].temp_c[i][k] -= one.of[band].is_read[i] * (mean[i + 1][k] - about) / count;
        }
    }
  }
}

/// A step moves the outermost halves by two cells against the middle ones: the nearest candidate is half a
/// cell off there at most.
void GyroSearch::lay_grid() {
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
                               .latency_s = priors_.latency_s + 0.5 * late * placed_.back().period_s});
}

void GyroSearch::go_on() {
  const std::size_t looks_of_one = placed_.size() * looks * (level_ == order_level ? bands : 1);
  std::size_t work = 0;
  for (; next_ < candidates_.size() && work < work_a_step; ++next_, work += looks_of_one)
    candidates_[next_].log_likelihood = log_before(candidates_[next_]) + log_likelihood(candidates_[next_]);
  if (next_ == candidates_.size()) end_level();
}

void GyroSearch::end_level() {
  next_ = 0;
  if (level_ < finest_level) {
    refine();
  } else if (level_ == finest_level) {
    name();
    lay_orders();
  } else {
    if (named_.scale_sigma < telling_scale) name_rows();
    if (names_rate()) believe();
  }
  ++level_;
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

/// Of a gyro by the middle band alone, of an order of rows by all bands.
double GyroSearch::log_likelihood(const Candidate& candidate) {
  Squares within;
  if (level_ == order_level)
    for (std::size_t band = 0; band < bands; ++band) add_within_cells(candidate, band, within);
  else
    add_within_cells(candidate, middle, within);
  constexpr double least_k2 = 1e-6;  // of images that are all the same
  return -0.5 * trusted * within.readings *
         std::log(std::max(least_k2, within.k2) / std::max(1.0, within.readings - within.cells));
}

std::size_t GyroSearch::cells_a_turn(double pitches) const {
  return static_cast<std::size_t>(std::ceil(whole_turn_deg / (pitches * lens_->pitch_deg())));
}

/// How much later than the middle rows a band is exposed, in refresh periods: the mean of its middle rows.
double GyroSearch::band_delay_periods(RowOrder order, std::size_t band) const {
  constexpr std::size_t rows = frame_rows / bands;
  const std::size_t below = band * rows + rows / 2;
  return 0.5 * (lens_->row_delay_periods(order, below - 1) + lens_->row_delay_periods(order, below));
}

/// Of a band's readings within the cells of a mosaic: their squares, which no candidate changes, less those
/// of means.
void GyroSearch::add_within_cells(const Candidate& candidate, std::size_t band, Squares& within) {
  const std::size_t all = cells_a_turn(level_ == 0 ? coarse_pitches : fine_pitches);
  const auto all_cells = static_cast<float>(all);
  const double delay_periods = band == middle ? 0.0 : band_delay_periods(candidate.order, band);
  cells_.assign(all + 1, Cell());
  for (const Placed& one : placed_) {
    const double turned_deg = (one.mean_deg - candidate.bias_dps * one.mean_s) / candidate.scale;
    const double rate_dps = (one.read_dps - candidate.bias_dps) / candidate.scale;
    const double late_s = candidate.latency_s - delay_periods * one.period_s;
    const auto turns = static_cast<float>(share_of_turn(turned_deg - late_s * rate_dps));
    const Band& looked = one.of[band];
    for (std::size_t i = 0; i < looks; ++i) {
      float azimuth_turns = turns + bearing_turns_[i];
      azimuth_turns -= azimuth_turns >= 1.0F ? 1.0F : 0.0F;
      Cell& cell = cells_[static_cast<std::size_t>(azimuth_turns * all_cells)];
      for (std::size_t k = 0; k < band_rows; ++k) cell.sum[k] += looked.temp_c[i][k];
      cell.count += looked.is_read[i];
    }
  }
  within.k2 += all_[band].k2;
  within.readings += all_[band].readings;
  for (const Cell& cell : cells_) {
    if (cell.count == 0.0F) continue;
    within.cells += band_rows;
    for (const float sum : cell.sum) within.k2 -= double{sum * sum / cell.count};
  }
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
  named_ = priors_;
  named_.bias_dps += bias;
  named_.scale += scale;
  // Cells are no finer than two of the last steps.
  const double bias_sigma = std::sqrt(std::max(0.0, bias2 / sum - square(bias)));
  const double scale_sigma = std::sqrt(std::max(0.0, scale2 / sum - square(scale)));
  named_.bias_sigma_dps = std::hypot(bias_sigma, 2.0 * step_dps_, searched_bias_sigma_dps);
  named_.scale_sigma =
      std::min(std::hypot(scale_sigma, 2.0 * scale_step_, searched_scale_sigma), priors_.scale_sigma);
  named_.bias_scale_covariance = both / sum - bias * scale;
}

/// By the speed of the halves, within what is uncertain of bias and scale.
bool GyroSearch::names_rate() const {
  const double read_dps = (placed_.back().mean_deg - placed_.front().mean_deg) / spanned_s();
  const double turned_dps = (read_dps - named_.bias_dps) / named_.scale;
  const double rate_variance = square(named_.bias_sigma_dps) + square(turned_dps * named_.scale_sigma) +
                               2.0 * turned_dps * named_.bias_scale_covariance;
  return rate_variance < square(named_rate_dps);
}

/// With the best gyro. Each order with latencies of its own, or one would make up for the other.
void GyroSearch::lay_orders() {
  Candidate gyro = *std::max_element(
      candidates_.begin(), candidates_.end(),
      [](const Candidate& a, const Candidate& b) { return a.log_likelihood < b.log_likelihood; });
  const auto reach = static_cast<int>(latency_reach_sigmas * priors_.latency_sigma_s / latency_step_s);
  const double last_row_s = latency_measured_ ? 0.0 : 0.5 * placed_.back().period_s;
  const int later = reach + static_cast<int>(std::ceil(last_row_s / latency_step_s));
  candidates_.clear();
  for (const RowOrder order : all_orders) {
    if (lens_->knows_rows() && order != lens_->rows()) continue;
    gyro.order = order;
    for (int step = -reach; step <= later; ++step) {
      gyro.latency_s = priors_.latency_s + step * latency_step_s;
      candidates_.push_back(gyro);
    }
  }
}

void GyroSearch::name_rows() {
  std::array<double, all_orders.size()> best{};
  best.fill(-std::numeric_limits<double>::infinity());
  for (const Candidate& one : candidates_) {
    double& of_order = best[static_cast<std::size_t>(one.order)];
    of_order = std::max(of_order, one.log_likelihood);
  }
  const auto first = std::max_element(best.begin(), best.end());
  FoundRows told{static_cast<RowOrder>(first - best.begin()), std::numeric_limits<double>::infinity()};
  for (auto other = best.begin(); other != best.end(); ++other)
    if (other != first) told.margin = std::min(told.margin, *first - *other);
  if (told.margin < FoundRows::least_margin) return;
  double sum = 0.0, latency_s = 0.0;
  for (const Candidate& one : candidates_) {
    const double weight = one.order == told.order ? std::exp(one.log_likelihood - *first) : 0.0;
    sum += weight;
    latency_s += weight * one.latency_s;
  }
  named_.latency_s = latency_s / sum;
  if (!lens_->knows_rows() && told.margin > rows_.margin) rows_ = told;
}

/// What was named before stands until two searches in a row name the same other gyro.
void GyroSearch::believe() {
  const bool is_confirmed =
      !found_ || is_same_gyro(named_, *found_) || (other_ && is_same_gyro(named_, *other_));
  is_confirmed ? found_ = named_ : other_ = named_;
  if (is_confirmed) other_.reset();
}

}  // namespace thermorig::odometer
