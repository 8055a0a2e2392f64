// SPDX-License-Identifier: MIT
#include "alignment.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

/// Sums over pixels of halves side by side, by what is summed.
template <std::size_t kinds>
using Sums = std::array<std::array<float, side_by_side>, kinds>;

/// Each sum goes from the first pixel to the last, and every addition waits for the one before it: many sums
/// side by side take no longer than one. `sum` is what they begin with.
template <std::size_t kinds>
Sums<kinds> add_up(const std::array<std::array<HalfPixels, side_by_side>, kinds>& values, Sums<kinds> sum) {
  for (std::size_t i = 0; i < half_pixels; ++i)
    for (std::size_t kind = 0; kind < kinds; ++kind)
      for (std::size_t j = 0; j < side_by_side; ++j) sum[kind][j] += values[kind][j][i];
  return sum;
}

std::array<float, side_by_side> each(float value) {
  std::array<float, side_by_side> all{};
  all.fill(value);
  return all;
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
      misfit_(views.size(), 0.0) {}

double Alignment::uncertainty(Parameter parameter) const {
  return std::sqrt(covariance_[parameter][parameter]);
}

void Alignment::correct() {
  if (!std::exchange(are_readings_old_, false)) return;
  readings_.resize(views_.size());
  for (std::size_t k = 0; k < views_.size(); ++k)
    readings_[k] = {pixels_.values(views_[k], half_offset_c_[k]), pixels_.weights(views_[k])};
}

void Alignment::make_map(const Parameters& parameters) {
  correct();
  angles_.look_from(parameters[offset_s]);
  map_.clear();
  for (std::size_t k = 0; k < views_.size(); k += stride_) {
    places_[k] = map_.place(angles_.angle_deg(k, parameters), layout_.pitch_deg, layout_.mirrored);
    map_.add(places_[k], views_[k].half.parity, readings_[k].value, readings_[k].weight);
  }
  map_.finish();
}

double Alignment::variance(const Parameters& parameters) {
  make_map(parameters);
  double square_sum = 0.0;
  double weight_sum = 0.0;
  std::array<std::array<HalfPixels, side_by_side>, 2> values{};  // squares, weights
  PanoramaMap::Expected expected;
  for (std::size_t k = 0; k < views_.size(); k += side_by_side * stride_) {
    std::size_t count = 0;
    for (std::size_t j = k; j < views_.size() && count < side_by_side; j += stride_, ++count) {
      map_.expect_means(places_[j], views_[j].half.parity, expected);
      for (std::size_t i = 0; i < half_pixels; ++i) {
        const float residual = readings_[j].value[i] - expected.mean[i];
        const float weight = readings_[j].weight[i] * expected.known[i];
        values[0][count][i] = weight * residual * residual;
        values[1][count][i] = weight;
      }
    }
    const auto [square, weight] = add_up<2>(values, {});
    for (std::size_t j = 0; j < count; ++j) {
      square_sum += static_cast<double>(square[j]);
      weight_sum += static_cast<double>(weight[j]);
    }
  }
  reading_count_ = std::max(1.0, weight_sum - map_.freedom());
  return square_sum / reading_count_;
}

void Alignment::learn_from(const Alignment& other) {
  pixels_ = other.pixels_;
  half_offset_c_ = other.half_offset_c_;
  are_readings_old_ = true;
}

std::vector<double> Alignment::misfit_at(const Parameters& parameters) {
  make_map(parameters);
  std::vector<double> misfit;
  misfit.reserve(views_.size());
  for_each_comparison([&](const Comparison& comparison, std::size_t) {
    float square = 0.0F;
    float weight = least_weight;
    for (std::size_t i = 0; i < half_pixels; ++i) {
      square += comparison.weight[i] * comparison.residual[i] * comparison.residual[i];
      weight += comparison.weight[i];
    }
    misfit.push_back(static_cast<double>(square / weight));
  });
  return misfit;
}

Parameters Alignment::search_offset() {
  Parameters best = prior_.mean;
  double sharpest = variance(best);
  const int steps = static_cast<int>(largest_offset_s / offset_step_s);
  for (int i = -steps; i <= steps; ++i) {
    Parameters tried = prior_.mean;
    tried[offset_s] = i * offset_step_s;
    const double left = variance(tried);
    if (left >= sharpest) continue;
    sharpest = left;
    best = tried;
  }
  return best;
}

double Alignment::spread() const {
  double square = 0.0;
  double weight = 1e-9;
  for (std::size_t k = 0; k < views_.size(); ++k) {
    const HalfPixels values = pixels_.values(views_[k], half_offset_c_[k]);
    const HalfPixels weights = pixels_.weights(views_[k]);
    double sum = 0.0;
    double sum_of_squares = 0.0;
    double sum_of_weights = 1e-9;
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const auto value = static_cast<double>(values[i]);
      sum_of_weights += static_cast<double>(weights[i]);
      sum += static_cast<double>(weights[i]) * value;
      sum_of_squares += static_cast<double>(weights[i]) * value * value;
    }
    square += sum_of_squares - sum * sum / sum_of_weights;
    weight += sum_of_weights;
  }
  return square / weight;
}

double Alignment::middle_row() const {
  double weights = 1e-9, rows = 0.0;
  for_each_comparison([&](const Comparison& comparison, std::size_t k) {
    const double speed = views_[k].half.rate_dps * views_[k].half.rate_dps;
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const float steepness = comparison.weight[i] * comparison.slope[i] * comparison.slope[i];
      const double weight = speed * static_cast<double>(steepness);
      weights += weight;
      rows += weight * static_cast<double>(row_of(i / half_rows, i % half_rows, views_[k].half.parity));
    }
  });
  return rows / weights;
}

/// Halves from `first` on against the panorama, as many as there are; what the pixels of each have in common
/// is taken out.
Alignment::Comparisons Alignment::compare(std::size_t first) const {
  Comparisons group;
  group.count = std::min(side_by_side, views_.size() - first);
  std::array<std::array<HalfPixels, side_by_side>, 3> values{};  // weights, weighted residuals and slopes
  PanoramaMap::Expected expected;
  for (std::size_t j = 0; j < group.count; ++j) {
    const Reading& reading = readings_[first + j];
    Comparison& comparison = group.of[j];
    map_.expect(places_[first + j], views_[first + j].half.parity, expected);
    comparison.slope = expected.slope;
    for (std::size_t i = 0; i < half_pixels; ++i) {
      comparison.residual[i] = reading.value[i] - expected.mean[i];
      comparison.weight[i] = reading.weight[i] * expected.known[i];
      values[0][j][i] = comparison.weight[i];
      values[1][j][i] = comparison.weight[i] * comparison.residual[i];
      values[2][j][i] = comparison.weight[i] * comparison.slope[i];
    }
  }
  const auto [weight, residual, slope] = add_up<3>(values, {each(least_weight), each(0.0F), each(0.0F)});
  for (std::size_t j = 0; j < group.count; ++j) {
    Comparison& comparison = group.of[j];
    comparison.common = residual[j] / weight[j];
    const float common_slope = slope[j] / weight[j];
    for (std::size_t i = 0; i < half_pixels; ++i) {
      comparison.residual[i] -= comparison.common;
      comparison.slope[i] -= common_slope;
    }
  }
  return group;
}

void Alignment::add_views(const Comparisons& group, std::size_t first, Totals& totals) {
  std::array<std::array<HalfPixels, side_by_side>, 4> values{};
  for (std::size_t j = 0; j < group.count; ++j) {
    const Comparison& comparison = group.of[j];
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const float weighted = comparison.weight[i] * comparison.residual[i];
      values[0][j][i] = comparison.weight[i];
      values[1][j][i] = weighted * comparison.residual[i];
      values[2][j][i] = comparison.weight[i] * comparison.slope[i] * comparison.slope[i];
      values[3][j][i] = weighted * comparison.slope[i];
    }
  }
  const auto [weight, square, steepness, lean] =
      add_up<4>(values, {each(least_weight), each(0.0F), each(0.0F), each(0.0F)});
  for (std::size_t j = 0; j < group.count; ++j) {
    const std::size_t index = first + j;
    misfit_[index] = static_cast<double>(square[j] / weight[j]);
    totals.square_sum += static_cast<double>(square[j]);
    totals.weight_sum += static_cast<double>(weight[j]);
    totals.lean[index] = static_cast<double>(lean[j]);
    const Parameters& change = totals.change[index] = angles_.change(index, parameters_);
    add_product(totals.curvature, static_cast<double>(steepness[j]), change, change);
    for (std::size_t p = 0; p < parameter_count; ++p) totals.gradient[p] += change[p] * totals.lean[index];
  }
}

Alignment::Totals Alignment::compare_all() {
  Totals totals;
  totals.change.resize(views_.size());
  totals.lean.resize(views_.size());
  totals.push.resize(map_.size());
  for (std::size_t first = 0; first < views_.size(); first += side_by_side) {
    const Comparisons group = compare(first);
    add_views(group, first, totals);
    for (std::size_t j = 0; j < group.count; ++j) {
      half_offset_c_[first + j] += group.of[j].common;
      add_push(group.of[j], first + j, totals);
      totals.pixels[views_[first + j].half.parity].add(group.of[j].residual, group.of[j].weight);
    }
  }
  are_readings_old_ = true;
  eliminate_map(totals);
  return totals;
}

/// What a change of the parameters would do to the panorama itself.
void Alignment::add_push(const Comparison& comparison, std::size_t index, Totals& totals) const {
  const PanoramaMap::Place& place = places_[index];
  std::array<float, parameter_count> change{};
  for (std::size_t p = 0; p < parameter_count; ++p) change[p] = static_cast<float>(totals.change[index][p]);
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const unsigned parity = views_[index].half.parity;
    const std::size_t left = PanoramaMap::cell(place.left[column], column, parity);
    const std::size_t right = PanoramaMap::cell(place.right[column], column, parity);
    for (std::size_t k = 0; k < half_rows; ++k) {
      const float push = comparison.weight[column * half_rows + k] * comparison.slope[column * half_rows + k];
      for (std::size_t p = 0; p < parameter_count; ++p) {
        totals.push[left + k][p] += (1.0F - place.part[column]) * push * change[p];
        totals.push[right + k][p] += place.part[column] * push * change[p];
      }
    }
  }
}

/// The panorama follows the halves: only what moves a half against the others in its cells is information.
void Alignment::eliminate_map(Totals& totals) const {
  for (std::size_t i = 0; i < totals.push.size(); ++i) {
    if (map_.weight()[i] <= 0.0F) continue;
    Parameters push{};
    for (std::size_t p = 0; p < parameter_count; ++p) push[p] = static_cast<double>(totals.push[i][p]);
    add_product(totals.curvature, -1.0 / static_cast<double>(map_.weight()[i]), push, push);
  }
}

/// A reading is worth less than it weighs, since the panorama is made of readings too.
void Alignment::learn_noise(const Totals& totals) {
  const double weight = std::max(1.0, totals.weight_sum);
  noise_variance_ = totals.square_sum / std::max(0.1 * weight, weight - map_.freedom());
}

void Alignment::learn_trust() {
  correct();
  const double limit = outlier_sigma * outlier_sigma * noise_variance_;
  for_each_comparison([&](const Comparison& comparison, std::size_t k) {
    HalfView& view = views_[k];
    const HalfPixels& weight = pixels_.pixel_weights(view.half.parity);
    for (std::size_t i = 0; i < half_pixels; ++i) {
      if (view.trust[i] == 0.0F) continue;
      const float square = comparison.residual[i] * comparison.residual[i] * weight[i];
      view.trust[i] = static_cast<double>(square) > limit ? distrusted : 1.0F;
    }
  });
  are_readings_old_ = true;
}

Matrix Alignment::with_prior(const Matrix& information) const {
  Matrix sum = information;
  for (std::size_t p = 0; p < parameter_count; ++p)
    sum[p][p] += 1.0 / (prior_.uncertainty[p] * prior_.uncertainty[p]);
  return sum;
}

double Alignment::mean_square_shift(const Totals& totals, const Parameters& change) const {
  double square = 0.0;
  for (const Parameters& angle : totals.change) {
    double shift_deg = 0.0;
    for (std::size_t p = 0; p < parameter_count; ++p) shift_deg += angle[p] * change[p];
    square += shift_deg * shift_deg;
  }
  return square / static_cast<double>(totals.change.size());
}

/// One step of Gauss-Newton. True when it was too small to matter to what is asked: other parameters may
/// still creep along where panorama and pixels can make up for them.
bool Alignment::step(const Totals& totals, Parameter asked) {
  Parameters gradient{};
  for (std::size_t p = 0; p < parameter_count; ++p)
    gradient[p] = totals.gradient[p] / noise_variance_ +
                  (prior_.mean[p] - parameters_[p]) / (prior_.uncertainty[p] * prior_.uncertainty[p]);
  const Matrix covariance = inverse(with_prior(scaled(totals.curvature, 1.0 / noise_variance_)));
  const Parameters change = product(covariance, gradient);
  const double shift_deg = std::sqrt(mean_square_shift(totals, change));
  if (!std::isfinite(shift_deg)) return true;  // nothing to go by
  const double share = std::min(1.0, longest_step_pixels * layout_.pitch_deg / std::max(shift_deg, 1e-12));
  for (std::size_t p = 0; p < parameter_count; ++p) parameters_[p] += share * change[p];
  parameters_[scale] = std::clamp(parameters_[scale], 0.5 * prior_.mean[scale], 2.0 * prior_.mean[scale]);
  return std::abs(change[asked]) < settled_share * std::sqrt(covariance[asked][asked]);
}

void Alignment::refine(const Parameters& start, Parameter asked) {
  parameters_ = start;
  for (int round = 0; round < most_rounds; ++round) {
    make_map(parameters_);
    const Totals totals = compare_all();
    learn_noise(totals);
    pixels_.learn(totals.pixels);
    are_readings_old_ = true;
    if (round % rounds_of_trust == 0) learn_trust();
    if (step(totals, asked) && round + 1 >= fewest_rounds) break;
  }
  make_map(parameters_);
  judge(compare_all());
}

}  // namespace thermorig::motion
