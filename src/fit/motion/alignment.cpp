// SPDX-License-Identifier: MIT
#include "alignment.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "thermorig/core/statistics.h"

namespace thermorig::motion {
namespace {

constexpr int most_rounds = 20;
constexpr int fewest_rounds = 4;             // pixels' offsets and the panorama settle meanwhile
constexpr int rounds_of_trust = 3;           // outliers are looked for in every third round
constexpr double settled_share = 0.05;       // of a standard deviation: smaller steps change nothing
constexpr double longest_step_pixels = 1.5;  // beyond, the slope says nothing about the panorama
constexpr double bin_per_smear = 0.35;
constexpr double bin_time_s = 0.05;  // several times the lag of the pixels
constexpr double widest_bin_pixels = 6.0;
constexpr double offset_step_s = 0.015;  // 3 deg at 200 deg/s: the sharpest point is not stepped over
constexpr int offset_steps = static_cast<int>(largest_offset_s / offset_step_s);
// Enough to see which of these steps is the sharpest, or next to it.
constexpr std::size_t offset_halves = 150;
constexpr double outlier_sigma = 5.0;
constexpr float distrusted = 1e-6F;
constexpr float least_weight = 1e-9F;
constexpr double fastest_shift_s = 0.4;  // room in the map for angles that the search tries
constexpr double room_share = 0.1;       // and for other scales
constexpr double room_deg = 10.0;        // and for other biases

/// The surroundings as halves see them are smeared over the angle that the rig turns during an exposure:
/// finer bins would hold little but noise. And what passes a pixel in a few of its time constants is delayed
/// by less than its lag, so finer bins would see the camera a little too early.
double bin_of(std::span<const HalfView> views, double pitch_deg, double factor) {
  std::vector<float> bins_deg;
  for (const HalfView& view : views) {
    const double exposure_s = view.half.end_s - view.half.begin_s;
    bins_deg.push_back(
        static_cast<float>(std::abs(view.half.rate_dps) * std::max(bin_time_s, bin_per_smear * exposure_s)));
  }
  if (bins_deg.empty()) return pitch_deg;
  return std::clamp(factor * static_cast<double>(reordering_median(bins_deg)), pitch_deg,
                    widest_bin_pixels * pitch_deg);
}

PanoramaMap empty_map(std::span<const HalfView> views, const Layout& layout, double reach_deg) {
  double fastest_dps = 0.0;
  for (const HalfView& view : views) fastest_dps = std::max(fastest_dps, std::abs(view.half.rate_dps));
  const double half_span_deg = (1.0 + room_share) * reach_deg + 0.5 * frame_columns * layout.pitch_deg +
                               fastest_shift_s * fastest_dps + room_deg;
  return {bin_of(views, layout.pitch_deg, layout.bin_factor), layout.closed, -half_span_deg,
          2.0 * half_span_deg};
}

Eigen::Map<const Eigen::Array<float, half_pixels, 1>> all(const HalfPixels& pixels) {
  return Eigen::Map<const Eigen::Array<float, half_pixels, 1>>(pixels.data());
}

}  // namespace

Alignment::Alignment(std::span<HalfView> views, const AngleTrack& track, const Layout& layout,
                     const Prior& prior)
    : views_(views),
      layout_(layout),
      prior_(prior),
      angles_(views, track, prior),
      pixels_(views),
      map_(empty_map(views, layout, angles_.reach_deg())),
      places_(views.size()),
      half_offset_c_(views.size(), 0.0F),
      readings_(views.size()),
      misfit_(views.size(), 0.0) {
  read();
}

double Alignment::uncertainty(Parameter parameter) const {
  return std::sqrt(covariance_(parameter, parameter));
}

/// Pixels, halves and trust stay as they are through many looks at the readings.
void Alignment::read() {
  for (std::size_t k = 0; k < views_.size(); ++k) pixels_.read(views_[k], half_offset_c_[k], readings_[k]);
}

void Alignment::make_map(const Parameters& parameters) {
  angles_.look_from(parameters[offset_s]);
  map_.clear();
  for (std::size_t k = 0; k < views_.size(); k += stride_) {
    places_[k] = map_.place(angles_.angle_deg(k, parameters), layout_.pitch_deg, layout_.mirrored,
                            views_[k].half.parity);
    map_.add(places_[k], readings_[k].value_c, readings_[k].weight);
  }
  map_.finish();
}

double Alignment::variance(const Parameters& parameters) {
  make_map(parameters);
  double square_sum = 0.0;
  double weight_sum = 0.0;
  for (std::size_t k = 0; k < views_.size(); k += stride_) {
    ColumnPixels squares = ColumnPixels::Zero(), weights = ColumnPixels::Zero();
    for (std::size_t column = 0; column < frame_columns; ++column) {
      const PanoramaMap::Between at = PanoramaMap::between(places_[k], column);
      const ColumnPixels weight = column_of(readings_[k].weight, column) * map_.known(at);
      squares += weight * (column_of(readings_[k].value_c, column) - map_.mean(at)).square();
      weights += weight;
    }
    square_sum += static_cast<double>(squares.sum());
    weight_sum += static_cast<double>(weights.sum());
  }
  reading_count_ = std::max(1.0, weight_sum - map_.parameters());
  return square_sum / reading_count_;
}

void Alignment::lay_out(const Layout& layout) {
  layout_ = layout;
  map_ = empty_map(views_, layout, angles_.reach_deg());
}

std::vector<double> Alignment::misfit_at(const Parameters& parameters) {
  make_map(parameters);
  std::vector<double> misfit;
  misfit.reserve(views_.size());
  for (std::size_t k = 0; k < views_.size(); ++k) {
    const Comparison comparison = compare(k);
    const auto weight = all(comparison.weight);
    const float square = (weight * all(comparison.residual).square()).sum();
    misfit.push_back(static_cast<double>(square / (least_weight + weight.sum())));
  }
  return misfit;
}

Parameters Alignment::sharpest_offset(int from, int to) {
  Parameters best = prior_.mean;
  double sharpest = std::numeric_limits<double>::max();
  for (int i = from; i <= to; ++i) {
    Parameters tried = prior_.mean;
    tried[offset_s] = i * offset_step_s;
    const double left = variance(tried);
    if (left >= sharpest) continue;
    sharpest = left;
    best = tried;
  }
  return best;
}

Parameters Alignment::search_offset() {
  look_at_one_of(std::max<std::size_t>(1, views_.size() / offset_halves));
  const Parameters near = sharpest_offset(-offset_steps, offset_steps);
  look_at_one_of(1);
  const int step = static_cast<int>(std::lround(near[offset_s] / offset_step_s));
  return sharpest_offset(step - 1, step + 1);
}

double Alignment::spread() const {
  using Precise = Eigen::Array<double, half_rows, 1>;
  double square = 0.0;
  double weight = 1e-9;
  for (std::size_t k = 0; k < views_.size(); ++k) {
    double sum = 0.0;
    double sum_of_squares = 0.0;
    double sum_of_weights = 1e-9;
    for (std::size_t column = 0; column < frame_columns; ++column) {
      const Precise values = column_of(readings_[k].value_c, column).cast<double>();
      const Precise weights = column_of(readings_[k].weight, column).cast<double>();
      sum_of_weights += weights.sum();
      sum += (weights * values).sum();
      sum_of_squares += (weights * values.square()).sum();
    }
    square += sum_of_squares - sum * sum / sum_of_weights;
    weight += sum_of_weights;
  }
  return square / weight;
}

double Alignment::middle_row() const {
  double weights = 1e-9, rows = 0.0;
  for (std::size_t k = 0; k < views_.size(); ++k) {
    const Comparison comparison = compare(k);
    const double speed = views_[k].half.rate_dps * views_[k].half.rate_dps;
    for (std::size_t i = 0; i < half_pixels; ++i) {
      if (comparison.weight[i] == 0.0F) continue;
      const float curvature = comparison.weight[i] * comparison.slope[i] * comparison.slope[i];
      const double weight = speed * static_cast<double>(curvature);
      weights += weight;
      rows += weight * static_cast<double>(row_of(i / half_rows, i % half_rows, views_[k].half.parity));
    }
  }
  return rows / weights;
}

/// A half against the panorama; what its pixels have in common is taken out.
Alignment::Comparison Alignment::compare(std::size_t index) const {
  const Readings& readings = readings_[index];
  Comparison comparison;
  ColumnPixels weights = ColumnPixels::Zero(), residuals = weights, slopes = weights;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const PanoramaMap::Between at = PanoramaMap::between(places_[index], column);
    const ColumnPixels residual = column_of(readings.value_c, column) - map_.mean(at);
    const ColumnPixels slope = map_.slope(at);
    const ColumnPixels weight = column_of(readings.weight, column) * map_.known(at);
    column_of(comparison.residual, column) = residual;
    column_of(comparison.slope, column) = slope;
    column_of(comparison.weight, column) = weight;
    weights += weight;
    residuals += weight * residual;
    slopes += weight * slope;
  }
  const float total = least_weight + weights.sum();
  comparison.common = residuals.sum() / total;
  const float common_slope = slopes.sum() / total;
  for (float& residual : comparison.residual) residual -= comparison.common;
  for (float& slope : comparison.slope) slope -= common_slope;
  return comparison;
}

void Alignment::add_view(const Comparison& comparison, std::size_t index, Totals& totals) {
  ColumnPixels weights = ColumnPixels::Zero(), squares = weights, curvature = weights, gradient = weights;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const ColumnPixels weight = column_of(comparison.weight, column);
    const ColumnPixels residual = column_of(comparison.residual, column);
    const ColumnPixels slope = column_of(comparison.slope, column);
    weights += weight;
    squares += weight * residual.square();
    curvature += weight * slope.square();
    gradient += weight * residual * slope;
  }
  const auto square = static_cast<double>(squares.sum());
  const auto weight = static_cast<double>(least_weight + weights.sum());
  misfit_[index] = square / weight;
  totals.square_sum += square;
  totals.weight_sum += weight;
  totals.view_gradient[index] = static_cast<double>(gradient.sum());
  const Parameters& change = totals.change[index] = angles_.change(index, parameters_);
  totals.curvature += static_cast<double>(curvature.sum()) * change * change.transpose();
  totals.gradient += change * totals.view_gradient[index];
}

Alignment::Totals Alignment::compare_all() {
  Totals totals;
  totals.change.resize(views_.size());
  totals.view_gradient.resize(views_.size());
  for (auto& push : totals.push) push.resize(map_.size());
  for (std::size_t k = 0; k < views_.size(); ++k) {
    const Comparison comparison = compare(k);
    add_view(comparison, k, totals);
    add_push(comparison, k, totals);
    half_offset_c_[k] += comparison.common;
    totals.pixels[views_[k].half.parity].add(comparison.residual, comparison.weight);
  }
  eliminate_map(totals);
  return totals;
}

/// What a change of the parameters would do to the panorama itself.
void Alignment::add_push(const Comparison& comparison, std::size_t index, Totals& totals) const {
  std::array<float*, parameter_count> cells;  // looked up once, as in PanoramaMap::add()
  std::array<float, parameter_count> change;
  for (std::size_t p = 0; p < parameter_count; ++p) {
    cells[p] = totals.push[p].data();
    change[p] = static_cast<float>(totals.change[index][p]);
  }
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const auto [left, right, part] = PanoramaMap::between(places_[index], column);
    const ColumnPixels push = column_of(comparison.weight, column) * column_of(comparison.slope, column);
    const ColumnPixels to_right = part * push;
    const ColumnPixels to_left = push - to_right;
    for (std::size_t p = 0; p < parameter_count; ++p) {
      ColumnOf(cells[p] + left) += to_left * change[p];
      ColumnOf(cells[p] + right) += to_right * change[p];
    }
  }
}

/// The panorama follows the halves: only what moves a half against the others in its cells is information.
void Alignment::eliminate_map(Totals& totals) const {
  for (std::size_t i = 0; i < map_.size(); ++i) {
    if (map_.weight()[i] <= 0.0F) continue;
    Parameters push;
    for (std::size_t p = 0; p < parameter_count; ++p) push[p] = static_cast<double>(totals.push[p][i]);
    totals.curvature += -1.0 / static_cast<double>(map_.weight()[i]) * push * push.transpose();
  }
}

/// A reading is worth less than it weighs, since the panorama is made of readings too.
void Alignment::learn_noise(const Totals& totals) {
  const double weight = std::max(1.0, totals.weight_sum);
  noise_variance_ = totals.square_sum / std::max(0.1 * weight, weight - map_.parameters());
}

void Alignment::learn_trust() {
  const double limit = outlier_sigma * outlier_sigma * noise_variance_;
  read();
  for (std::size_t k = 0; k < views_.size(); ++k) {
    const Comparison comparison = compare(k);
    HalfView& view = views_[k];
    const HalfPixels& weight = pixels_.pixel_weights(view.half.parity);
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const float square = comparison.residual[i] * comparison.residual[i] * weight[i];
      const float trust = static_cast<double>(square) > limit ? distrusted : 1.0F;
      view.trust[i] = view.trust[i] == 0.0F ? 0.0F : trust;
    }
  }
}

Matrix Alignment::with_prior(const Matrix& information) const {
  Matrix sum = information;
  sum.diagonal() += prior_.uncertainty.cwiseAbs2().cwiseInverse();
  return sum;
}

double Alignment::mean_square_shift(const Totals& totals, const Parameters& change) const {
  double square = 0.0;
  for (const Parameters& angle : totals.change) {
    const double shift_deg = angle.dot(change);
    square += shift_deg * shift_deg;
  }
  return square / static_cast<double>(totals.change.size());
}

/// One step of Gauss-Newton. True when it was too small to matter to what is asked: other parameters may
/// still creep along where panorama and pixels can make up for them.
bool Alignment::step(const Totals& totals, Parameter asked) {
  const Parameters gradient = totals.gradient / noise_variance_ +
                              (prior_.mean - parameters_).cwiseQuotient(prior_.uncertainty.cwiseAbs2());
  const Matrix covariance = inverse(with_prior(totals.curvature * (1.0 / noise_variance_)));
  const Parameters change = covariance * gradient;
  const double shift_deg = std::sqrt(mean_square_shift(totals, change));
  if (!std::isfinite(shift_deg)) return true;  // nothing to go by
  const double share = std::min(1.0, longest_step_pixels * layout_.pitch_deg / std::max(shift_deg, 1e-12));
  parameters_ += share * change;
  parameters_[scale] = std::clamp(parameters_[scale], 0.5 * prior_.mean[scale], 2.0 * prior_.mean[scale]);
  return std::abs(change[asked]) < settled_share * std::sqrt(covariance(asked, asked));
}

void Alignment::refine(const Parameters& start, Parameter asked) {
  parameters_ = start;
  for (int round = 0; round < most_rounds; ++round) {
    read();
    make_map(parameters_);
    const Totals totals = compare_all();
    learn_noise(totals);
    pixels_.learn(totals.pixels);
    if (round % rounds_of_trust == 0) learn_trust();
    if (step(totals, asked) && round + 1 >= fewest_rounds) break;
  }
  read();
  make_map(parameters_);
  const Totals totals = compare_all();
  read();
  judge(totals);
}

}  // namespace thermorig::motion
