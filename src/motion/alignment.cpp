// SPDX-License-Identifier: MIT
#include "alignment.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thermorig::motion {
namespace {

constexpr int most_rounds = 20;
constexpr int fewest_rounds = 4;             // pixels' offsets and the panorama settle meanwhile
constexpr double settled_share = 0.05;       // of a standard deviation: smaller steps change nothing
constexpr double longest_step_pixels = 1.5;  // beyond, the slope says nothing about the panorama

constexpr double bin_per_smear = 0.35;
constexpr double bin_time_s = 0.05;  // several times the lag of the pixels
constexpr double widest_bin_pixels = 6.0;
constexpr double outlier_sigma = 5.0;
constexpr float distrusted = 1e-6F;
constexpr double frozen_pixel_variance = 1e-4;  // K2: no living pixel is so quiet
constexpr float noisy_pixel = 9.0F;             // times the median variance: left out
constexpr float quiet_pixel = 0.25F;
constexpr double block_s = 4.0;  // longer than the errors of one sweep and the next go together
constexpr double least_contrast = 0.02;
constexpr double fastest_shift_s = 0.4;  // room in the map for angles that the search tries

float median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Span {
  double lowest_deg = 0.0;
  double length_deg = 0.0;
};

/// Of raw angles, with room for the field of view and for other parameters.
Span span_of(std::span<const HalfView> views, const AngleTrack& track, const Prior& prior, double pitch_deg) {
  double low = std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::lowest();
  double fastest_dps = 0.0;
  for (const HalfView& view : views) {
    const double middle_s = 0.5 * (view.half.begin_s + view.half.end_s);
    const double angle_deg =
        track.over(view.half.begin_s, view.half.end_s).angle_deg - prior.mean[bias_dps] * middle_s;
    low = std::min(low, angle_deg);
    high = std::max(high, angle_deg);
    fastest_dps = std::max(fastest_dps, std::abs(view.half.rate_dps));
  }
  const double room_deg =
      0.5 * frame_columns * pitch_deg + fastest_shift_s * fastest_dps + 0.1 * (high - low) + 10.0;
  return {0.5 * (low - high) - room_deg, high - low + 2.0 * room_deg};
}

/// The surroundings as halves see them are smeared over the angle that the rig turns during an exposure:
/// finer bins would hold little but noise. And what passes a pixel in a few of its time constants is delayed
/// by less than its lag, so finer bins would see the camera a little too early.
double bin_of(std::span<const HalfView> views, double pitch_deg) {
  std::vector<float> bins_deg;
  for (const HalfView& view : views) {
    const double exposure_s = view.half.end_s - view.half.begin_s;
    bins_deg.push_back(
        static_cast<float>(std::abs(view.half.rate_dps) * std::max(bin_time_s, bin_per_smear * exposure_s)));
  }
  if (bins_deg.empty()) return pitch_deg;
  return std::clamp(static_cast<double>(median(bins_deg)), pitch_deg, widest_bin_pixels * pitch_deg);
}

}  // namespace

/// What one look at all halves adds up to.
struct Alignment::Totals {
  explicit Totals(std::size_t views, std::size_t cells) : change(views), lean(views), push(cells) {}

  Parameters gradient{};
  Matrix curvature{};
  std::vector<Parameters> change;                        // of each view's angle with the parameters
  std::vector<double> lean;                              // sum of slope times residual of each view
  std::vector<std::array<float, parameter_count>> push;  // how the panorama's cells move with the parameters
  double square_sum = 0.0;                               // of weighted residuals
  double weight_sum = 0.0;
  std::array<HalfPixels, 2> pixel_sum{};
  std::array<HalfPixels, 2> pixel_square{};
  std::array<HalfPixels, 2> pixel_weight{};
};

Alignment::Alignment(std::span<HalfView> views, const AngleTrack& track, const Layout& layout,
                     const Prior& prior)
    : views_(views),
      track_(track),
      layout_(layout),
      prior_(prior),
      map_(layout.pitch_deg, layout.closed, 0.0, 1.0),
      half_offset_(views.size(), 0.0F),
      misfit_(views.size(), 0.0) {
  const Span span = span_of(views, track, prior, layout.pitch_deg);
  map_ = PanoramaMap(bin_of(views, layout.pitch_deg), layout.closed, span.lowest_deg, span.length_deg);
  double low_s = std::numeric_limits<double>::max();
  double high_s = std::numeric_limits<double>::lowest();
  double low_deg = low_s;
  double high_deg = high_s;
  for (const HalfView& view : views) {
    const double middle_s = 0.5 * (view.half.begin_s + view.half.end_s);
    const double angle_deg =
        track.over(view.half.begin_s, view.half.end_s).angle_deg - prior.mean[bias_dps] * middle_s;
    low_s = std::min(low_s, middle_s);
    high_s = std::max(high_s, middle_s);
    low_deg = std::min(low_deg, angle_deg);
    high_deg = std::max(high_deg, angle_deg);
  }
  middle_s_ = 0.5 * (low_s + high_s);
  middle_deg_ = 0.5 * (low_deg + high_deg) + prior.mean[bias_dps] * middle_s_;
  remove_smooth_offsets();
}

double Alignment::angle_deg(const HalfView& view, const Parameters& parameters) const {
  const double begin_s = view.half.begin_s - parameters[offset_s];
  const double end_s = view.half.end_s - parameters[offset_s];
  const double since_s = 0.5 * (begin_s + end_s) - middle_s_;
  const double drifted_deg = (parameters[bias_dps] + 0.5 * parameters[drift_dps_per_s] * since_s) * since_s;
  return (track_.over(begin_s, end_s).angle_deg - middle_deg_ - drifted_deg) / parameters[scale];
}

/// How the angle changes with each parameter, around the present ones.
Parameters Alignment::angle_change(const HalfView& view) const {
  const double begin_s = view.half.begin_s - parameters_[offset_s];
  const double end_s = view.half.end_s - parameters_[offset_s];
  const double since_s = 0.5 * (begin_s + end_s) - middle_s_;
  const double gain = 1.0 / parameters_[scale];
  return {-(track_.over(begin_s, end_s).rate_dps - parameters_[bias_dps]) * gain, -since_s * gain,
          -0.5 * since_s * since_s * gain, -angle_deg(view, parameters_) * gain};
}

/// A first idea of each pixel's own offset: how its mean over all angles differs from its neighbours'. Their
/// smooth part is the surroundings, which the angles average only in part.
void Alignment::remove_smooth_offsets() {
  std::array<std::array<double, half_pixels>, 2> sum{};
  std::array<std::array<double, half_pixels>, 2> square{};
  std::array<std::array<double, half_pixels>, 2> count{};
  for (const HalfView& view : views_)
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const unsigned parity = view.half.parity;
      const double temp_c = static_cast<double>(view.temp_c[i]);
      sum[parity][i] += static_cast<double>(view.trust[i]) * temp_c;
      square[parity][i] += static_cast<double>(view.trust[i]) * temp_c * temp_c;
      count[parity][i] += static_cast<double>(view.trust[i]);
    }
  std::array<float, frame_pixels> mean{};
  for (unsigned parity = 0; parity < 2; ++parity)
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const double n = std::max(1.0, count[parity][i]);
      const double mean_c = sum[parity][i] / n;
      const bool alive =
          count[parity][i] > 1.0 && square[parity][i] / n - mean_c * mean_c > frozen_pixel_variance;
      pixel_weight_[parity][i] = alive ? 1.0F : 0.0F;
      const std::size_t column = i / half_rows;
      mean[row_of(column, i % half_rows, parity) * frame_columns + column] =
          alive ? static_cast<float>(mean_c) : std::numeric_limits<float>::quiet_NaN();
    }
  constexpr std::ptrdiff_t reach = 2;
  std::vector<float> around;
  for (unsigned parity = 0; parity < 2; ++parity)
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const auto column = static_cast<std::ptrdiff_t>(i / half_rows);
      const auto row = static_cast<std::ptrdiff_t>(row_of(i / half_rows, i % half_rows, parity));
      around.clear();
      for (std::ptrdiff_t y = row - reach; y <= row + reach; ++y)
        for (std::ptrdiff_t x = column - reach; x <= column + reach; ++x) {
          if (y < 0 || x < 0 || y >= std::ptrdiff_t{frame_rows} || x >= std::ptrdiff_t{frame_columns})
            continue;
          const float value = mean[static_cast<std::size_t>(y) * frame_columns + static_cast<std::size_t>(x)];
          if (!std::isnan(value)) around.push_back(value);
        }
      const float own =
          mean[static_cast<std::size_t>(row) * frame_columns + static_cast<std::size_t>(column)];
      pixel_offset_[parity][i] = around.empty() || std::isnan(own) ? 0.0F : own - median(around);
    }
}

HalfPixels Alignment::values_of(std::size_t index) const {
  const HalfView& view = views_[index];
  const HalfPixels& offset = pixel_offset_[view.half.parity];
  HalfPixels values;
  for (std::size_t i = 0; i < half_pixels; ++i) values[i] = view.temp_c[i] - offset[i] - half_offset_[index];
  return values;
}

HalfPixels Alignment::weights_of(const HalfView& view) const {
  const HalfPixels& weight = pixel_weight_[view.half.parity];
  HalfPixels weights;
  for (std::size_t i = 0; i < half_pixels; ++i) weights[i] = weight[i] * view.trust[i];
  return weights;
}

void Alignment::make_map(const Parameters& parameters) {
  places_.resize(views_.size());
  for (std::size_t k = 0; k < views_.size(); ++k)
    places_[k] = map_.place(angle_deg(views_[k], parameters), layout_.pitch_deg, layout_.mirrored);
  fill_map();
}

void Alignment::fill_map() {
  map_.clear();
  for (std::size_t k = 0; k < views_.size(); ++k)
    map_.add(places_[k], views_[k].half.parity, values_of(k), weights_of(views_[k]));
  map_.finish();
}

double Alignment::variance(const Parameters& parameters) {
  make_map(parameters);
  double square_sum = 0.0;
  double weight_sum = 0.0;
  PanoramaMap::Expected expected;
  for (std::size_t k = 0; k < views_.size(); ++k) {
    map_.expect(places_[k], views_[k].half.parity, expected);
    const HalfPixels values = values_of(k);
    const HalfPixels weights = weights_of(views_[k]);
    float square = 0.0F;
    float weight = 0.0F;
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const float residual = values[i] - expected.mean[i];
      square += weights[i] * expected.known[i] * residual * residual;
      weight += weights[i] * expected.known[i];
    }
    square_sum += static_cast<double>(square);
    weight_sum += static_cast<double>(weight);
  }
  return square_sum / std::max(1.0, weight_sum - map_.freedom());
}

double Alignment::spread() const {
  double square = 0.0;
  double weight = 1e-9;
  for (std::size_t k = 0; k < views_.size(); ++k) {
    const HalfPixels values = values_of(k);
    const HalfPixels weights = weights_of(views_[k]);
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

/// One half against the panorama; what its pixels have in common is taken out.
Alignment::Comparison Alignment::compare(std::size_t index) const {
  const HalfView& view = views_[index];
  Comparison comparison{values_of(index), {}, weights_of(view), 0.0F};
  PanoramaMap::Expected expected;
  map_.expect(places_[index], view.half.parity, expected);
  comparison.slope = expected.slope;
  float weight_sum = 1e-9F;
  float residual_sum = 0.0F;
  float slope_sum = 0.0F;
  for (std::size_t i = 0; i < half_pixels; ++i) {
    comparison.residual[i] -= expected.mean[i];
    comparison.weight[i] *= expected.known[i];
    weight_sum += comparison.weight[i];
    residual_sum += comparison.weight[i] * comparison.residual[i];
    slope_sum += comparison.weight[i] * comparison.slope[i];
  }
  comparison.common = residual_sum / weight_sum;
  for (std::size_t i = 0; i < half_pixels; ++i) {
    comparison.residual[i] -= comparison.common;
    comparison.slope[i] -= slope_sum / weight_sum;
  }
  return comparison;
}

void Alignment::add_pixels(const Comparison& comparison, unsigned parity, Totals& totals) const {
  for (std::size_t i = 0; i < half_pixels; ++i) {
    const float weighted = comparison.weight[i] * comparison.residual[i];
    totals.pixel_sum[parity][i] += weighted;
    totals.pixel_square[parity][i] += weighted * comparison.residual[i];
    totals.pixel_weight[parity][i] += comparison.weight[i];
  }
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

Alignment::Totals Alignment::compare_all() {
  Totals totals(views_.size(), map_.size());
  for (std::size_t k = 0; k < views_.size(); ++k) {
    const Comparison comparison = compare(k);
    double square = 0.0;
    double weight = 1e-9;
    double steepness = 0.0;
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const auto slope = static_cast<double>(comparison.slope[i]);
      const auto weighted = static_cast<double>(comparison.weight[i]);
      const auto residual = static_cast<double>(comparison.residual[i]);
      weight += weighted;
      square += weighted * residual * residual;
      steepness += weighted * slope * slope;
      totals.lean[k] += weighted * slope * residual;
    }
    half_offset_[k] += comparison.common;
    misfit_[k] = square / weight;
    totals.square_sum += square;
    totals.weight_sum += weight;
    totals.change[k] = angle_change(views_[k]);
    add_product(totals.curvature, steepness, totals.change[k], totals.change[k]);
    for (std::size_t p = 0; p < parameter_count; ++p)
      totals.gradient[p] += totals.change[k][p] * totals.lean[k];
    add_pixels(comparison, views_[k].half.parity, totals);
    add_push(comparison, k, totals);
  }
  eliminate_map(totals);
  return totals;
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

/// Offsets, noise and outliers of the pixels, for the next round.
void Alignment::learn_pixels(const Totals& totals) {
  const float freedom = static_cast<float>(1.0 - map_.freedom() / std::max(1.0, totals.weight_sum));
  noise_variance_ =
      totals.square_sum / std::max(1.0, totals.weight_sum) / std::max(0.1, static_cast<double>(freedom));
  std::vector<float> variances;
  for (unsigned parity = 0; parity < 2; ++parity)
    for (std::size_t i = 0; i < half_pixels; ++i)
      if (totals.pixel_weight[parity][i] > 0.0F)
        variances.push_back(totals.pixel_square[parity][i] / totals.pixel_weight[parity][i]);
  if (variances.empty()) return;
  const float typical = std::max(1e-9F, median(variances));
  for (unsigned parity = 0; parity < 2; ++parity)
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const float weight = totals.pixel_weight[parity][i];
      if (weight <= 0.0F) continue;
      pixel_offset_[parity][i] += totals.pixel_sum[parity][i] / weight;
      const float variance = std::max(quiet_pixel, totals.pixel_square[parity][i] / weight / typical);
      pixel_weight_[parity][i] = variance > noisy_pixel ? 0.0F : 1.0F / variance;
    }
}

void Alignment::learn_trust() {
  const double limit = outlier_sigma * outlier_sigma * noise_variance_;
  for (std::size_t k = 0; k < views_.size(); ++k) {
    const Comparison comparison = compare(k);
    HalfView& view = views_[k];
    const HalfPixels& weight = pixel_weight_[view.half.parity];
    for (std::size_t i = 0; i < half_pixels; ++i) {
      if (view.trust[i] == 0.0F) continue;
      const float square = comparison.residual[i] * comparison.residual[i] * weight[i];
      view.trust[i] = static_cast<double>(square) > limit ? distrusted : 1.0F;
    }
  }
}

/// One step of Gauss-Newton. True when it was too small to matter to what is asked: other parameters may
/// still creep along where panorama and pixels can make up for them.
bool Alignment::step(const Totals& totals, Parameter asked) {
  Matrix curvature{};
  Parameters gradient{};
  for (std::size_t p = 0; p < parameter_count; ++p) {
    const double certainty = 1.0 / (prior_.uncertainty[p] * prior_.uncertainty[p]);
    for (std::size_t q = 0; q < parameter_count; ++q)
      curvature[p][q] = totals.curvature[p][q] / noise_variance_;
    curvature[p][p] += certainty;
    gradient[p] = totals.gradient[p] / noise_variance_ + certainty * (prior_.mean[p] - parameters_[p]);
  }
  const Matrix covariance = inverse(curvature);
  const Parameters change = product(covariance, gradient);
  double shift_square = 0.0;
  for (const Parameters& angle : totals.change) {
    double shift_deg = 0.0;
    for (std::size_t p = 0; p < parameter_count; ++p) shift_deg += angle[p] * change[p];
    shift_square += shift_deg * shift_deg / static_cast<double>(totals.change.size());
  }
  const double longest_deg = longest_step_pixels * layout_.pitch_deg;
  const double share = shift_square > longest_deg * longest_deg ? longest_deg / std::sqrt(shift_square) : 1.0;
  for (std::size_t p = 0; p < parameter_count; ++p) parameters_[p] += share * change[p];
  return std::abs(change[asked]) < settled_share * std::sqrt(covariance[asked][asked]);
}

void Alignment::refine(const Parameters& start, Parameter asked) {
  parameters_ = start;
  for (int round = 0; round < most_rounds; ++round) {
    make_map(parameters_);
    const Totals totals = compare_all();
    learn_pixels(totals);
    if (round % 3 == 0) learn_trust();
    const bool is_settled = step(totals, asked);
    if (is_settled && round + 1 >= fewest_rounds) break;
  }
  make_map(parameters_);
  judge(compare_all());
}

/// How each view pulls at the parameters, the panorama's share taken out.
Parameters Alignment::pull(std::size_t index, const Totals& totals) const {
  const Comparison comparison = compare(index);
  const PanoramaMap::Place& place = places_[index];
  Parameters pull{};
  for (std::size_t p = 0; p < parameter_count; ++p) pull[p] = totals.change[index][p] * totals.lean[index];
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const unsigned parity = views_[index].half.parity;
    const std::size_t left = PanoramaMap::cell(place.left[column], column, parity);
    const std::size_t right = PanoramaMap::cell(place.right[column], column, parity);
    for (std::size_t k = 0; k < half_rows; ++k) {
      const std::size_t i = column * half_rows + k;
      const float weighted = comparison.weight[i] * comparison.residual[i];
      if (weighted == 0.0F) continue;
      const float to_left = (1.0F - place.part[column]) * weighted / std::max(1e-3F, map_.weight()[left + k]);
      const float to_right = place.part[column] * weighted / std::max(1e-3F, map_.weight()[right + k]);
      for (std::size_t p = 0; p < parameter_count; ++p)
        pull[p] -=
            static_cast<double>(to_left * totals.push[left + k][p] + to_right * totals.push[right + k][p]);
    }
  }
  return pull;
}

/// Sandwich: blocks of the recording pull independently; their spread, through the inverse curvature, is the
/// parameters' covariance. Noise makes the panorama's slopes look steeper than the surroundings are, and the
/// curvature with them: that share is taken out.
void Alignment::judge(const Totals& totals) {
  const double steepness = map_.slope_squared();
  const double noise = map_.slope_noise(noise_variance_);
  contrast_ = steepness > 0.0 ? std::max(0.0, 1.0 - noise / steepness) : 0.0;
  Matrix spread{};
  Matrix curvature{};
  Parameters block{};
  double blocks = 0.0;
  for (std::size_t k = 0; k < views_.size(); ++k) {
    const Parameters one = pull(k, totals);
    for (std::size_t p = 0; p < parameter_count; ++p) block[p] += one[p] / noise_variance_;
    const auto block_of = [this](std::size_t i) { return std::floor(views_[i].half.begin_s / block_s); };
    if (k + 1 < views_.size() && block_of(k) == block_of(k + 1)) continue;
    add_product(spread, 1.0, block, block);
    block = {};
    blocks += 1.0;
  }
  const double correction = blocks / std::max(1.0, blocks - 2.0);
  for (std::size_t p = 0; p < parameter_count; ++p) {
    for (std::size_t q = 0; q < parameter_count; ++q) {
      spread[p][q] *= correction;
      curvature[p][q] = std::max(least_contrast, contrast_) * totals.curvature[p][q] / noise_variance_;
    }
    const double certainty = 1.0 / (prior_.uncertainty[p] * prior_.uncertainty[p]);
    spread[p][p] += certainty;
    curvature[p][p] += certainty;
  }
  const Matrix inverted = inverse(curvature);
  covariance_ = product(product(inverted, spread), inverted);
}

}  // namespace thermorig::motion
