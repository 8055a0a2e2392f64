// SPDX-License-Identifier: MIT
#include "tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thermorig::odometer {

namespace {

constexpr double variance_share = 1.44;  // halves see the same errors of the map again and again
constexpr double least_sigma_deg = 0.03;
constexpr double change_s = 0.01;     // a sweep that is not even is no box
constexpr double surprising = 4.0;    // an innovation squared: counts less
constexpr double impossible = 30.0;   // is not believed, and the map not written
constexpr int first_halves = 4;       // are only written: a map of one chess half has gaps
constexpr double flat_margin = 0.15;  // squares of a pixel
constexpr int settled_halves = 30;
constexpr double settled_deg = 0.4;
constexpr double moving_dps = 8.0;  // from there on errors of pixels are told from surroundings

}  // namespace

Tracker::Tracker(const Priors& priors, const Lens& lens) : lens_(lens), filter_(priors) {}

void Tracker::advance(const GyroPath& path, double now_s) {
  const GyroPath::Knot now = path.until(now_s);
  if (has_begun_)
    filter_.predict(now.turned_deg - now_deg_, now_s - now_s_,
                    std::max(0.0, now.unseen_deg2 - now_unseen_deg2_));
  has_begun_ = true;
  now_s_ = now_s;
  now_deg_ = now.turned_deg;
  now_unseen_deg2_ = now.unseen_deg2;
}

void Tracker::restart(const Priors& priors) {
  filter_ = HeadingFilter(priors);
  panorama_.clear();
  pixels_ = PixelModel();
  has_begun_ = false;
  is_on_trial_ = false;
  halves_ = 0;
  sigma_in_map_deg_ = 0.0;
}

void Tracker::restart(const Priors& priors, const Map& map) {
  restart(priors);
  filter_.load(map);
  panorama_.load(map);
  pixels_.load(map);
  reference_c_ = map.reference_c;
  is_on_trial_ = true;
  halves_ = settled_halves;
}

void Tracker::keep(Map& map) const {
  filter_.keep(map);
  panorama_.keep(map);
  pixels_.keep(map);
  map.reference_c = reference_c_;
}

std::vector<float> Tracker::map_image_c() const {
  if (halves_ == 0) return {};
  std::vector<float> pixels = panorama_.image();
  for (float& one : pixels) one += reference_c_;
  return pixels;
}

Tracker::Exposed Tracker::expose(const HalfReading& half, const GyroPath& path) {
  const double late_s = filter_.latency_s();
  Exposed exposed{path.over(half.begin_s - late_s, half.end_s - late_s), pixels_.corrected(half)};
  if (halves_ == 0) reference_c_ = mean_of(exposed.temp_c);
  for (float& one : exposed.temp_c) one -= reference_c_;
  exposed.azimuth_deg = filter_.exposed_deg(exposed.turn, now_s_, now_deg_);
  exposed.rate_dps = rate_dps_ = filter_.mean_rate_dps(exposed.turn);
  exposed.half_width_deg = std::sqrt(3.0) * filter_.spread_deg(exposed.turn);
  return exposed;
}

void Tracker::begin_nodes(double azimuth_deg, double half_width_deg) {
  const double edge_deg = (0.5 * frame_columns + 1.0) * lens_.pitch_deg + half_width_deg;
  filter_.begin_nodes(azimuth_deg - edge_deg, azimuth_deg + edge_deg);
}

HalfResult Tracker::add(const HalfReading& half, const GyroPath& path) {
  const Exposed exposed = expose(half, path);
  HalfResult result{.rate_dps = exposed.rate_dps};
  common_c_ = 0.0F;
  if (halves_++ >= first_halves) {
    result = judge(half, exposed);
    if (result.is_judged && !result.is_used) return result;
  }
  const double shown_deg = filter_.exposed_deg(exposed.turn, now_s_, now_deg_);
  begin_nodes(shown_deg, exposed.half_width_deg);
  write(half, exposed.temp_c, shown_deg, exposed.half_width_deg, sigma_in_map_deg_, common_c_);
  return result;
}

/// Lays a half against the map, and tells the filter.
HalfResult Tracker::judge(const HalfReading& half, const Exposed& exposed) {
  const auto& [turn, temp_c, azimuth_deg, rate_dps, half_width_deg] = exposed;
  HalfResult result{.rate_dps = rate_dps};
  std::array<double, HeadingFilter::nodes> ahead{};
  HeadingFilter::add_shares(azimuth_deg, 1.0, ahead);
  const double prior_deg2 = filter_.variance(filter_.derivative(turn, now_s_, now_deg_, ahead));
  sigma_in_map_deg_ = std::sqrt(prior_deg2);
  const Alignment alignment(panorama_, filter_, lens_);
  const View view{.temp_c = &temp_c,
                  .variance = &pixels_.variance(half.parity),
                  .parity = half.parity,
                  .half_width_deg = half_width_deg,
                  .trust_deg2 = prior_deg2,
                  .is_strict = halves_ > settled_halves && prior_deg2 < square(settled_deg)};
  const Alignment::Found found = alignment.find(view, azimuth_deg, std::sqrt(prior_deg2));
  const Alignment::Comparison& comparison = found.comparison;
  common_c_ = comparison.common_c;
  result.looks += found.looks;
  if (!found.is_found) return result;
  if (is_on_trial_) result.explained = alignment.explained(view, found.azimuth_deg);
  const HeadingFilter::Row row = filter_.derivative(turn, now_s_, now_deg_, comparison.about);
  double noise_deg2 = variance_share * comparison.variance_deg2() + square(least_sigma_deg) +
                      square(change_s * turn.change_dps) + square(half.time_sigma_s * rate_dps);
  const double expected_deg2 = filter_.variance(row) + noise_deg2;
  result.is_judged = true;
  result.innovation_deg = found.azimuth_deg - azimuth_deg;
  result.sigma_deg = std::sqrt(expected_deg2);
  result.squared = square(result.innovation_deg) / expected_deg2;
  result.misfit = comparison.cost;
  result.is_flat = comparison.flat_cost + flat_margin < comparison.cost;
  result.is_used = result.squared <= impossible && !result.is_flat;
  if (!result.is_used) return result;
  if (result.squared > surprising) noise_deg2 += expected_deg2 * (result.squared / surprising - 1.0);
  filter_.update(row, result.innovation_deg, noise_deg2);
  sigma_in_map_deg_ =
      std::sqrt(filter_.variance(filter_.derivative(turn, now_s_, now_deg_, comparison.about)));
  if (std::abs(rate_dps) <= moving_dps) return result;
  const auto after = alignment.compare(view, filter_.exposed_deg(turn, now_s_, now_deg_), {});
  pixels_.learn(half.parity, after.residual, after.map_variance);
  common_c_ = after.common_c;
  return result;
}

void Tracker::locate(const HalfReading& half, const GyroPath& path, CircleSearch& search) {
  const Exposed exposed = expose(half, path);
  const View view{.temp_c = &exposed.temp_c,
                  .variance = &pixels_.variance(half.parity),
                  .parity = half.parity,
                  .half_width_deg = exposed.half_width_deg};
  search.add(Alignment(panorama_, filter_, lens_), view, exposed.azimuth_deg - located_deg_);
  located_deg_ = exposed.azimuth_deg;
}

double Tracker::settle(const CircleSearch::Found& found) {
  const double off_deg = std::remainder(found.azimuth_deg - located_deg_, whole_turn_deg);
  filter_.set_heading(filter_.heading_deg() + off_deg, found.sigma_deg);
  sigma_in_map_deg_ = found.sigma_deg;
  return off_deg;
}

void Tracker::write(const HalfReading& half, const HalfPixels& temp_c, double azimuth_deg,
                    double half_width_deg, double sigma_deg, float common_c) {
  const Alignment alignment(panorama_, filter_, lens_);
  const HalfPixels& noise = pixels_.variance(half.parity);
  const double pitch_bins = lens_.pitch_deg / Panorama::bin_deg;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const auto place = Panorama::place(alignment.column_azimuth_deg(azimuth_deg, column), half_width_deg,
                                       row_class(column, half.parity));
    const std::size_t before = column >= 2 ? column - 2 : column;
    const std::size_t behind = column + 2 < frame_columns ? column + 2 : column;
    const auto apart_deg = static_cast<float>(lens_.bearing_deg(behind) - lens_.bearing_deg(before));
    const double below_bins =
        before == column || behind == column ? std::max(place.half_width, pitch_bins) : pitch_bins;
    Panorama::Guess guess{.low = place.middle - below_bins, .high = place.middle + below_bins};
    Panorama::Column shown, variance;
    for (std::size_t k = 0; k < half_rows; ++k) {
      const std::size_t i = column * half_rows + k;
      shown[k] = temp_c[i] - common_c;
      const float read = (temp_c[behind * half_rows + k] - temp_c[before * half_rows + k]) / apart_deg;
      const float slope = std::isnan(read) ? 0.0F : read;
      const double swept_deg2 = square(half_width_deg) + square(lens_.pitch_deg);
      variance[k] = noise[i] + static_cast<float>(square(sigma_deg)) * slope * slope;
      guess.temp_c[k] = shown[k];
      guess.slope[k] = slope;
      guess.variance[k] = 2.0F * variance[k] + static_cast<float>(0.3 * swept_deg2) * slope * slope;
    }
    panorama_.seed(place, guess);
    written_[column] = {place, shown, variance};
  }
  for (const auto& one : written_) panorama_.write(one.place, one.temp_c, one.variance);
  panorama_.add_up();
}

}  // namespace thermorig::odometer
