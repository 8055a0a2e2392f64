// SPDX-License-Identifier: MIT
#include "gyro_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "thermorig/core/statistics.h"

namespace thermorig::odometer {

namespace {

constexpr double bias_reach_dps = 30.0, scale_reach_sigmas = 2.2;
constexpr int most_bias_steps = 64, most_scale_steps = 31;  // to either side
constexpr std::size_t most_candidates = 2 * (2 * most_bias_steps + 1) * (2 * most_scale_steps + 1);
constexpr std::size_t most_kept = 64;                     // of a level: each becomes four of the next one
constexpr double coarse_pixels = 4.0, fine_pixels = 2.0;  // of the lens, a cell
constexpr std::size_t work_a_step = 300'000;              // pairs that are placed
constexpr double gyro_trust = 0.1, order_trust = 0.05;    // of the likelihood of a mosaic
constexpr double latency_step_s = 0.020, latency_reach_sigmas = 2.5, latest_s = 0.2;
constexpr std::array all_orders{RowOrder::at_once, RowOrder::first_to_last, RowOrder::last_to_first};
constexpr double known_rate_dps = 1.0;  // one standard deviation, at the speed of those halves
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

bool is_scale_known(const Priors& found) {
  constexpr double known_scale_sigma = 0.009;  // one standard deviation
  return found.scale_sigma < known_scale_sigma;
}

GyroSearch::GyroSearch(const Priors& priors, const SharedLens& lens, bool latency_measured)
    : priors_(priors),
      lens_(lens),
      latency_measured_(latency_measured),
      mosaic_(lens),
      rows_{lens->rows(), 0.0} {
  candidates_.reserve(most_candidates);
  best_.reserve(most_kept);
}

void GyroSearch::clear() {
  found_.reset();
  rival_.reset();
  rows_ = {lens_->rows(), 0.0};
  level_ = order_level + 1;
  new_halves_ = 0;
}

void GyroSearch::add(const HalfStore& store, const TurnPath& path) {
  ++new_halves_;
  if (is_searching()) return go_on();
  if (store.count() >= fewest_halves && new_halves_ >= halves_between) begin(store, path);
}

void GyroSearch::begin(const HalfStore& store, const TurnPath& path) {
  new_halves_ = 0;
  mosaic_.take(store, path);
  if (mosaic_.halves() >= fewest_halves) make_grid();
}

/// A step moves the outermost halves by two cells against the middle ones: the nearest candidate is half a
/// cell off there at most.
void GyroSearch::make_grid() {
  level_ = 0;
  next_ = 0;
  const double cell_deg = coarse_pixels * lens_->pitch_deg();
  const double scale_reach = std::min(scale_reach_sigmas * priors_.scale_sigma, 0.5 * priors_.scale);
  step_dps_ = std::max(2.0 * cell_deg / mosaic_.spanned_s(), bias_reach_dps / most_bias_steps);
  scale_step_ =
      std::max(2.0 * cell_deg / std::max(cell_deg, mosaic_.turned_deg()), scale_reach / most_scale_steps);
  const auto biases = static_cast<int>(std::ceil(bias_reach_dps / step_dps_));
  const auto scales = static_cast<int>(std::ceil(scale_reach / scale_step_));
  // Where rows are exposed in turn, the middle row's times alone make starts late.
  const bool may_be_last_row = !lens_->knows_rows() && !latency_measured_;
  candidates_.clear();
  for (int late = 0; late < (may_be_last_row ? 2 : 1); ++late)
    for (int scale = -scales; scale <= scales; ++scale)
      for (int bias = -biases; bias <= biases; ++bias)
        candidates_.push_back(
            {.hypothesis = {.bias_dps = priors_.bias_dps + bias * step_dps_,
                            .scale = priors_.scale + scale * scale_step_,
                            .latency_s = priors_.latency_s + 0.5 * late * mosaic_.period_s()}});
}

void GyroSearch::go_on() {
  const std::size_t of_one = mosaic_.work() * (level_ == order_level ? Mosaic::bands : 1);
  std::size_t work = 0;
  for (; next_ < candidates_.size() && work < work_a_step; ++next_, work += of_one) {
    Candidate& one = candidates_[next_];
    one.log_likelihood = log_before(one.hypothesis) + log_likelihood(one.hypothesis);
  }
  if (next_ == candidates_.size()) end_level();
}

void GyroSearch::end_level() {
  next_ = 0;
  if (level_ < finest_level) {
    refine();
  } else if (level_ == finest_level) {
    estimate_gyro();
    make_orders();
  } else if (is_rate_known()) {
    estimate_rows();
    confirm();
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
        finer.hypothesis.bias_dps += bias_steps * step_dps_;
        finer.hypothesis.scale += scale_steps * scale_step_;
        candidates_.push_back(finer);
      }
  step_dps_ *= 0.5;
  scale_step_ *= 0.5;
}

/// Cauchy's density of a bias, for a profile may be of another day or of another gyro: none is ruled out.
double GyroSearch::log_before(const Hypothesis& hypothesis) const {
  return -std::log(1.0 + square((hypothesis.bias_dps - priors_.bias_dps) / priors_.bias_sigma_dps)) -
         0.5 * square((hypothesis.scale - priors_.scale) / priors_.scale_sigma);
}

/// Of an order of rows by all bands, of a gyro by the one whose times hardly depend on it.
double GyroSearch::log_likelihood(const Hypothesis& hypothesis) {
  if (level_ == order_level) return order_trust * mosaic_.log_likelihood_of_bands(hypothesis, fine_pixels);
  return gyro_trust * mosaic_.log_likelihood(hypothesis, level_ == 0 ? coarse_pixels : fine_pixels);
}

const GyroSearch::Candidate& GyroSearch::best() const {
  return *std::max_element(
      candidates_.begin(), candidates_.end(),
      [](const Candidate& a, const Candidate& b) { return a.log_likelihood < b.log_likelihood; });
}

void GyroSearch::estimate_gyro() {
  const double most = best().log_likelihood;
  double sum = 0.0, bias = 0.0, scale = 0.0, bias2 = 0.0, scale2 = 0.0, both = 0.0;
  for (const Candidate& one : candidates_) {
    const double weight = std::exp(one.log_likelihood - most);
    const double bias_off = one.hypothesis.bias_dps - priors_.bias_dps;
    const double scale_off = one.hypothesis.scale - priors_.scale;
    sum += weight;
    bias += weight * bias_off;
    scale += weight * scale_off;
    bias2 += weight * square(bias_off);
    scale2 += weight * square(scale_off);
    both += weight * bias_off * scale_off;
  }
  bias /= sum;
  scale /= sum;
  estimate_ = priors_;
  estimate_.bias_dps += bias;
  estimate_.scale += scale;
  // Cells are no finer than two of the last steps.
  const double bias_sigma = std::sqrt(std::max(0.0, bias2 / sum - square(bias)));
  const double scale_sigma = std::sqrt(std::max(0.0, scale2 / sum - square(scale)));
  estimate_.bias_sigma_dps = std::hypot(bias_sigma, 2.0 * step_dps_, searched_bias_sigma_dps);
  const double widest = std::hypot(scale_sigma, 2.0 * scale_step_, searched_scale_sigma);
  estimate_.scale_sigma = std::min(widest, priors_.scale_sigma);
  const double correlated =
      estimate_.scale_sigma / widest;  // or bias and scale could have no such covariance
  estimate_.bias_scale_covariance = correlated * (both / sum - bias * scale);
}

/// By the speed of the halves, within what is uncertain of bias and scale.
bool GyroSearch::is_rate_known() const {
  const double turned_dps = (mosaic_.mean_read_dps() - estimate_.bias_dps) / estimate_.scale;
  const double rate_variance = square(estimate_.bias_sigma_dps) + square(turned_dps * estimate_.scale_sigma) +
                               2.0 * turned_dps * estimate_.bias_scale_covariance;
  return rate_variance < square(known_rate_dps);
}

/// With the best gyro. Each order with latencies of its own, or one would make up for the other.
void GyroSearch::make_orders() {
  Hypothesis hypothesis = best().hypothesis;
  const double reach_s = std::min(latency_reach_sigmas * priors_.latency_sigma_s, latest_s);
  const auto reach = static_cast<int>(reach_s / latency_step_s);
  const double last_row_s = latency_measured_ ? 0.0 : 0.5 * mosaic_.period_s();
  const int later = reach + static_cast<int>(std::ceil(last_row_s / latency_step_s));
  candidates_.clear();
  for (const RowOrder order : all_orders) {
    if (lens_->knows_rows() && order != lens_->rows()) continue;
    hypothesis.order = order;
    for (int step = -reach; step <= later; ++step) {
      hypothesis.latency_s = priors_.latency_s + step * latency_step_s;
      candidates_.push_back({hypothesis});
    }
  }
}

void GyroSearch::estimate_rows() {
  const Candidate& first = best();
  const RowOrder order = first.hypothesis.order;
  FoundRows told{order, std::numeric_limits<double>::infinity()};
  double sum = 0.0, later_s = 0.0, later2 = 0.0;
  for (const Candidate& one : candidates_) {
    const double lead = first.log_likelihood - one.log_likelihood;
    if (one.hypothesis.order != order) {
      told.margin = std::min(told.margin, lead);
      continue;
    }
    const double later = one.hypothesis.latency_s - priors_.latency_s;
    sum += std::exp(-lead);
    later_s += std::exp(-lead) * later;
    later2 += std::exp(-lead) * square(later);
  }
  later_s /= sum;
  if (told.margin < FoundRows::least_margin) return;
  const bool is_latency_told = later2 / sum - square(later_s) < square(latency_step_s);
  if (is_latency_told) estimate_.latency_s += later_s;
  if (!lens_->knows_rows() && told.margin > rows_.margin) rows_ = told;
}

/// What was named before stands until two searches in a row name the same other gyro.
void GyroSearch::confirm() {
  const bool is_confirmed =
      !found_ || is_same_gyro(estimate_, *found_) || (rival_ && is_same_gyro(estimate_, *rival_));
  is_confirmed ? found_ = estimate_ : rival_ = estimate_;
  if (is_confirmed) rival_.reset();
}

}  // namespace thermorig::odometer
