// SPDX-License-Identifier: MIT
#include "tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thermorig::odometer {

namespace {

constexpr double variance_share = 1.44;  // halves see the same errors of the map again and again
// While the map is made, they see the very errors with which those just before have written it.
constexpr double learning_share = 5.0;
constexpr double least_sigma_deg = 0.03;
constexpr double change_s = 0.01;        // a sweep that is not even is no box
constexpr double surprising_nis = 4.0;   // above it a half-frame counts less
constexpr double impossible_nis = 30.0;  // above it it is an outlier: not used, and not written
constexpr int first_halves = 4;          // are only written: a map of one half-frame has gaps
constexpr double flat_margin = 0.15;     // squares of a pixel
constexpr double blank_squares = 2.0;    // of a pixel: covered lenses show less
constexpr int settled_halves = 30;
constexpr double pass_widening = 6.0;  // of what the pass before learnt: these are the same halves
constexpr double settled_deg = 0.4;
constexpr int write_comparisons = 10;     // writing a half takes as long as so many comparisons
constexpr int row_work = 2;               // row by row all takes so much longer
const double box_width = std::sqrt(3.0);  // half of it, in standard deviations
constexpr double moving_dps = 8.0;        // above it errors of pixels can be separated from the surroundings

}  // namespace

Tracker::Tracker(const Priors& priors, const SharedLens& lens) : lens_(lens), filter_(priors) {}

void Tracker::advance(const TurnPath& path, double now_s) {
  const TurnPath::Knot now = path.until(now_s);
  if (has_begun_)
    filter_.predict(now.turned_deg - now_deg_, now_s - now_s_,
                    std::max(0.0, now.unseen_deg2 - now_unseen_deg2_));
  has_begun_ = true;
  now_s_ = now_s;
  now_deg_ = now.turned_deg;
  now_unseen_deg2_ = now.unseen_deg2;
}

void Tracker::restart(const Priors& priors, RowOrder rows, bool things_move) {
  rows_ = rows;
  things_move_ = things_move;
  filter_ = HeadingFilter(priors);
  panorama_.clear(things_move);
  pixels_ = PixelModel();
  has_begun_ = false;
  is_on_trial_ = false;
  is_learning_ = true;
  is_open_ = false;
  halves_ = 0;
  half_sigma_deg_ = heading_deg2_ = 0.0;
}

void Tracker::expect_traffic() {
  things_move_ = true;
  panorama_.expect_traffic();
}

void Tracker::restart(const Priors& priors, const Map& map) {
  restart(priors, lens_->knows_rows() ? lens_->rows() : map.rows);
  filter_.load(map);
  panorama_.load(map);
  pixels_.load(map);
  reference_c_ = map.reference_c;
  is_on_trial_ = true;
  is_learning_ = false;
  halves_ = settled_halves;
}

void Tracker::keep(Map& map) const {
  filter_.keep(map);
  panorama_.keep(map);
  pixels_.keep(map);
  map.rows = rows_;
  map.reference_c = reference_c_;
}

Priors Tracker::learnt(const Priors& priors) const {
  const auto sigma = [&](HeadingFilter::Place place, double least) {
    return std::max(least, pass_widening * filter_.sigma(place));
  };
  Priors better = priors;
  better.bias_dps = filter_.bias_dps();
  better.bias_sigma_dps = sigma(HeadingFilter::bias, least_bias_sigma_dps);
  better.scale = filter_.scale_factor();
  better.scale_sigma = sigma(HeadingFilter::scale, least_scale_sigma);
  better.latency_s = filter_.latency_s();
  better.latency_sigma_s = sigma(HeadingFilter::latency, least_latency_sigma_s);
  return better;
}

std::vector<float> Tracker::map_image_c() const {
  if (halves_ == 0) return {};
  std::vector<float> pixels = panorama_.image();
  for (float& one : pixels) one += reference_c_;
  return pixels;
}

Tracker::Exposed Tracker::expose(const HalfFrame& half, const TurnPath& path) {
  const double late_s = filter_.latency_s();
  Exposed exposed{path.over(half.begin_s - late_s, half.end_s - late_s),
                  pixels_.corrected(half),
                  0.0,
                  0.0,
                  0.0,
                  RowSweeps()};
  if (halves_ == 0) reference_c_ = mean_of(exposed.temp_c);
  for (float& one : exposed.temp_c) one -= reference_c_;
  exposed.azimuth_deg = filter_.exposed_deg(exposed.turn, now_s_, now_deg_);
  exposed.rate_dps = rate_dps_ = filter_.mean_rate_dps(exposed.turn);
  exposed.half_width_deg = box_width * filter_.spread_deg(exposed.turn);
  if (do_rows_look_apart()) expose_rows(half, path, exposed);
  return exposed;
}

/// Headings at points through the time in which all rows are exposed, and sums over them: a row's exposure is
/// a part of it.
void Tracker::expose_rows(const HalfFrame& half, const TurnPath& path, Exposed& exposed) const {
  constexpr std::size_t points = 48;  // over two refresh periods: half a one before, half a one behind
  constexpr double exposure = points / 2.0;
  const double step_s = (half.end_s - half.begin_s) / exposure;
  const double first_s = half.begin_s - filter_.latency_s() - (0.5 * exposure - 0.5) * step_s;
  std::array<double, points + 1> turned_deg;
  path.turned(first_s, step_s, turned_deg);
  std::array<double, points + 2> sum_deg{}, sum_deg2{};  // of the points before
  for (std::size_t i = 0; i <= points; ++i) {
    const double later_s = static_cast<double>(i) * step_s;
    const double deg =
        (turned_deg[i] - turned_deg[0] - filter_.bias_dps() * later_s) / filter_.scale_factor();
    sum_deg[i + 1] = sum_deg[i] + deg;
    sum_deg2[i + 1] = sum_deg2[i] + deg * deg;
  }
  const auto mean = [&](const std::array<double, points + 2>& sums, double from) {
    const auto until = [&](double at) {
      const auto i = static_cast<std::size_t>(at);
      return std::lerp(sums[i], sums[i + 1], at - static_cast<double>(i));
    };
    return (until(from + exposure) - until(from)) / exposure;
  };
  const double middle_deg = mean(sum_deg, 0.5 * exposure);
  for (std::size_t row = 0; row < frame_rows; ++row) {
    const double from = exposure * (0.5 + lens_->row_delay_periods(rows_, row));
    const double mean_deg = mean(sum_deg, from);
    exposed.rows.shift_deg[row] = static_cast<float>(mean_deg - middle_deg);
    exposed.rows.half_width_deg[row] =
        static_cast<float>(box_width * std::sqrt(std::max(0.0, mean(sum_deg2, from) - square(mean_deg))));
  }
}

View Tracker::view_of(const HalfFrame& half, const Exposed& exposed) const {
  return {.temp_c = &exposed.temp_c,
          .variance = &pixels_.variance(half.parity),
          .parity = half.parity,
          .half_width_deg = exposed.half_width_deg,
          .rows = do_rows_look_apart() ? &exposed.rows : nullptr};
}

void Tracker::begin_nodes(double azimuth_deg, const Exposed& exposed, const HeadingFilter::Vector& shown) {
  double edge_deg = (0.5 * frame_columns + 1.0) * lens_->pitch_deg() + exposed.half_width_deg;
  if (do_rows_look_apart())
    edge_deg += std::max(std::abs(double{exposed.rows.shift_deg.front()}),
                         std::abs(double{exposed.rows.shift_deg.back()}));
  filter_.begin_nodes(azimuth_deg - edge_deg, azimuth_deg + edge_deg, shown);
}

HalfResult Tracker::add(const HalfFrame& half, const TurnPath& path, bool is_trusted) {
  Exposed exposed = expose(half, path);
  if (!lens_->is_plain() && halves_ >= first_halves) level(half, exposed);
  HalfResult result{.rate_dps = exposed.rate_dps, .work = work_of(0)};
  common_c_ = 0.0F;
  rewritten_ = {};
  if (halves_++ >= first_halves) {
    result = judge(half, exposed);
    if (!is_trusted || (result.is_judged && !result.is_used)) return result;
  }
  const double shown_deg = filter_.exposed_deg(exposed.turn, now_s_, now_deg_);
  const HeadingFilter::Vector shown = filter_.jacobian(exposed.turn, now_s_, now_deg_);
  begin_nodes(shown_deg, exposed, shown);
  in_map_deg_ = shown_deg - filter_.map_offset_deg(shown_deg);
  write(view_of(half, exposed), shown_deg, half_sigma_deg_, common_c_);
  filter_.rewrite(rewritten_, shown);
  return result;
}

/// How much of the map about each node is written anew by a half: as much as the map is less sure than it.
std::array<double, HeadingFilter::nodes> Tracker::written_shares(const Alignment::Comparison& comparison,
                                                                 const HalfPixels& variance,
                                                                 double azimuth_deg) const {
  std::array<double, HeadingFilter::nodes> shares{};
  const double covered = lens_->pitch_deg() / HeadingFilter::node_deg;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    float sum = 0.0F, count = 0.0F;
    for (std::size_t i = column * half_rows; i < (column + 1) * half_rows; ++i) {
      if (std::isnan(comparison.residual[i])) continue;
      sum += comparison.map_variance[i] / (comparison.map_variance[i] + variance[i]);
      count += 1.0F;
    }
    if (count > 0.0F)
      HeadingFilter::add_shares(azimuth_deg + lens_->bearing_deg(column), covered * double{sum / count},
                                shares);
  }
  for (double& share : shares) share = std::min(share, 1.0);
  return shares;
}

/// What each pixel would show had it looked along its own row of the map.
void Tracker::level(const HalfFrame& half, Exposed& exposed) const {
  const Alignment alignment(panorama_, filter_, *lens_);
  const HalfPixels beside = alignment.beside_row(view_of(half, exposed), exposed.azimuth_deg);
  for (std::size_t i = 0; i < half_pixels; ++i) exposed.temp_c[i] -= beside[i];
}

int Tracker::work_of(int comparisons) const {
  return (comparisons + write_comparisons) * (do_rows_look_apart() ? row_work : 1);
}

/// Of the heading against the map, with the newest half; from here on it grows.
void Tracker::keep_sigma(double sigma_deg) {
  half_sigma_deg_ = sigma_deg;
  heading_deg2_ = square(filter_.sigma(HeadingFilter::heading));
}

/// Registers a half-frame against the map: the measurement update.
HalfResult Tracker::judge(const HalfFrame& half, const Exposed& exposed) {
  const auto& [turn, temp_c, azimuth_deg, rate_dps, half_width_deg, rows] = exposed;
  HalfResult result{.rate_dps = rate_dps};
  std::array<double, HeadingFilter::nodes> ahead{};
  HeadingFilter::add_shares(azimuth_deg, 1.0, ahead);
  const double prior_deg2 = filter_.variance(filter_.jacobian(turn, now_s_, now_deg_, ahead));
  keep_sigma(std::sqrt(prior_deg2));
  const Alignment alignment(panorama_, filter_, *lens_);
  View view = view_of(half, exposed);
  view.trust_deg2 = prior_deg2;
  view.is_strict = halves_ > settled_halves && prior_deg2 < square(settled_deg);
  const Alignment::Found found = alignment.find(view, azimuth_deg, std::sqrt(prior_deg2));
  const Alignment::Comparison& comparison = found.comparison;
  common_c_ = comparison.common_c;
  result.work = work_of(found.comparisons);
  if (!found.is_found) return result;
  if (is_on_trial_) result.explained = alignment.explained(view, found.azimuth_deg);
  const HeadingFilter::Vector row = filter_.jacobian(turn, now_s_, now_deg_, comparison.about);
  double noise_deg2 = variance_share * comparison.variance_deg2() + square(least_sigma_deg) +
                      square(change_s * turn.change_dps) + square(half.time_sigma_s * rate_dps);
  if (things_move_) noise_deg2 *= std::max(1.0, comparison.cost);  // what fits badly counts less
  const double expected_deg2 = filter_.variance(row) + noise_deg2;
  result.is_judged = true;
  result.innovation_deg = found.azimuth_deg - azimuth_deg;
  result.sigma_deg = std::sqrt(expected_deg2);
  result.nis = square(result.innovation_deg) / expected_deg2;
  result.misfit = comparison.cost;
  result.left_k2 = comparison.squares_k2;
  result.is_flat = comparison.flat_cost + flat_margin < comparison.cost;
  result.is_other_view = result.is_flat && comparison.flat_cost > blank_squares;
  result.is_used = result.nis <= impossible_nis && !result.is_flat;
  if (!result.is_used) return result;
  if (is_open_ && has_gap()) rewritten_ = written_shares(comparison, *view.variance, azimuth_deg);
  if (is_learning_) noise_deg2 += (learning_share - variance_share) * comparison.variance_deg2();
  if (result.nis > surprising_nis) noise_deg2 += expected_deg2 * (result.nis / surprising_nis - 1.0);
  filter_.update(row, result.innovation_deg, noise_deg2);
  keep_sigma(std::sqrt(filter_.variance(filter_.jacobian(turn, now_s_, now_deg_, comparison.about))));
  if (std::abs(rate_dps) <= moving_dps) return result;
  const auto after = alignment.compare(view, filter_.exposed_deg(turn, now_s_, now_deg_), {});
  pixels_.learn(half.parity, after.residual, after.map_variance);
  if (is_learning_) pixels_.hear_noise(after.residual, after.map_variance);  // for another pass
  common_c_ = after.common_c;
  return result;
}

void Tracker::locate(const HalfFrame& half, const TurnPath& path, CircleSearch& search) {
  const Exposed exposed = expose(half, path);
  search.add(Alignment(panorama_, filter_, *lens_), view_of(half, exposed),
             exposed.azimuth_deg - located_deg_);
  located_deg_ = exposed.azimuth_deg;
  located_turn_ = exposed.turn;
}

void Tracker::settle(const CircleSearch::Found& found) {
  const double off_deg = std::remainder(found.azimuth_deg - located_deg_, whole_turn_deg);
  filter_.find_heading(filter_.jacobian(located_turn_, now_s_, now_deg_), off_deg, found.sigma_deg);
  keep_sigma(found.sigma_deg);
}

void Tracker::write(const View& view, double azimuth_deg, double sigma_deg, float common_c) {
  const Alignment alignment(panorama_, filter_, *lens_);
  const HalfPixels &temp_c = *view.temp_c, &noise = *view.variance;
  const double pitch_bins = lens_->pitch_deg() / Panorama::bin_deg;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const std::size_t before = column >= 2 ? column - 2 : column;
    const std::size_t behind = column + 2 < frame_columns ? column + 2 : column;
    const bool is_edge = before == column || behind == column;
    const auto apart_deg = static_cast<float>(lens_->bearing_deg(behind) - lens_->bearing_deg(before));
    const double swept_deg2 = square(view.half_width_deg) + square(lens_->pitch_deg());
    Panorama::Guess guess;
    Panorama::Column shown, variance;
    for (std::size_t k = 0; k < half_rows; ++k) {
      const std::size_t i = column * half_rows + k;
      shown[k] = temp_c[i] - common_c;
      const float read = (temp_c[behind * half_rows + k] - temp_c[before * half_rows + k]) / apart_deg;
      const float slope = std::isnan(read) ? 0.0F : read;
      variance[k] = noise[i] + static_cast<float>(square(sigma_deg)) * slope * slope;
      guess.temp_c[k] = shown[k];
      guess.slope[k] = slope;
      guess.variance[k] = 2.0F * variance[k] + static_cast<float>(0.3 * swept_deg2) * slope * slope;
    }
    alignment.each_ray(view, azimuth_deg, column, [&](const Panorama::Ray& ray) {
      const double below_bins = is_edge ? std::max(ray.half_width, pitch_bins) : pitch_bins;
      guess.low = ray.middle - below_bins;
      guess.high = ray.middle + below_bins;
      panorama_.seed(ray, guess);
    });
    written_[column] = {shown, variance};
  }
  for (std::size_t column = 0; column < frame_columns; ++column)
    alignment.each_ray(view, azimuth_deg, column, [&](const Panorama::Ray& ray) {
      panorama_.write(ray, written_[column].shown, written_[column].variance);
    });
  panorama_.add_up();
}

}  // namespace thermorig::odometer
