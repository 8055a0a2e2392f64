// SPDX-License-Identifier: MIT
#include "lens_adjustment.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lens.h"
#include "thermorig/estimators/odometer/map.h"

namespace thermorig::odometer {

namespace {

constexpr std::size_t adjusted_bins = Map::bins;
constexpr double adjusted_bin_deg = whole_turn_deg / adjusted_bins;
constexpr LensValues difference{0.002, 0.005, 0.2, 0.2, 0.1};
constexpr LensValues longest_step{0.02, 0.05, 3.0, 3.0, 0.4};
constexpr LensValues farthest{0.09, 0.19, 14.0, 14.0, 1.0};  // within what a profile allows
constexpr int most_rounds = 25, fewest_rounds = 6;
constexpr double settled = 0.02;          // of a standard deviation
constexpr float beside_map_rows = 0.5F;   // what looks further above or below shows what no cell has
constexpr float fewest_looks = 6.0F;      // at a cell
constexpr long slope_reach = 2;           // cells to either side
constexpr float far_off = 3.0F;           // standard deviations: counts less
constexpr double longest_turn_deg = 1.0;  // of a half in one step
constexpr double increment_sigma_deg = 0.2;
constexpr double heading_sigma_deg = 5.0;  // of what a half begins with
constexpr std::size_t block_halves = 40;   // 5 s: beyond it errors of the map are others

}  // namespace

CameraProfile camera_with(CameraProfile camera, const LensValues& values) {
  camera.pitch_scale = 1.0 + values[lens_pitch];
  camera.distortion = values[lens_distortion];
  camera.tilt_deg = values[lens_tilt];
  camera.roll_deg = values[lens_roll];
  camera.row_spread = values[lens_rows];
  return camera;
}

LensAdjustment::LensAdjustment(std::vector<SweptHalf> halves, const CameraProfile& camera,
                               const LensValues& values, double trust)
    : halves_(std::move(halves)),
      camera_(camera),
      values_(values),
      trust_(trust),
      looks_(halves_.size() * half_pixels),
      cells_(adjusted_bins * frame_rows) {
  for (const SweptHalf& one : halves_) common_c_.push_back(mean_of(one.half->temp_c));
}

/// Row of the frame of a pixel, from -1/2 for the first one to 1/2.
double LensAdjustment::row_part(std::size_t i, unsigned parity) const {
  const std::size_t row = row_of(i / half_rows, i % half_rows, parity);
  return static_cast<double>(row) / (frame_rows - 1) - 0.5;
}

void LensAdjustment::aim() {
  const auto fill = [&](const Lens& lens, unsigned parity, HalfPixels& azimuth_deg, HalfPixels& map_row) {
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const std::size_t column = i / half_rows, row = row_of(column, i % half_rows, parity);
      azimuth_deg[i] = static_cast<float>(lens.bearing_deg(column, row));
      map_row[i] = static_cast<float>(lens.map_row(column, row));
    }
  };
  for (const unsigned parity : {0U, 1U}) {
    Directions& all = directions_[parity];
    fill(Lens(camera_with(camera_, values_)), parity, all.azimuth_deg, all.map_row);
    for (std::size_t value = 0; value < lens_rows; ++value) {
      LensValues more = values_;
      more[value] += difference[value];
      HalfPixels azimuth_deg, map_row;
      fill(Lens(camera_with(camera_, more)), parity, azimuth_deg, map_row);
      for (std::size_t i = 0; i < half_pixels; ++i) {
        const auto by = static_cast<float>(1.0 / difference[value]);
        all.azimuth_by[value][i] = by * (azimuth_deg[i] - all.azimuth_deg[i]);
        all.map_row_by[value][i] = by * (map_row[i] - all.map_row[i]);
      }
    }
  }
}

/// Rows that are exposed later look where the rig has turned to.
void LensAdjustment::place_looks() {
  for (std::size_t j = 0; j < halves_.size(); ++j) {
    const SweptHalf& one = halves_[j];
    const Directions& look_to = directions_[one.half->parity];
    const double turned_deg = one.rate_dps * (one.half->end_s - one.half->begin_s);
    for (std::size_t i = 0; i < half_pixels; ++i) {
      Look& look = looks_[j * half_pixels + i];
      const double azimuth_deg = one.heading_deg + double{look_to.azimuth_deg[i]} +
                                 values_[lens_rows] * turned_deg * row_part(i, one.half->parity);
      const double at = share_of_turn(azimuth_deg) * adjusted_bins;
      const auto bin = std::min(adjusted_bins - 1, static_cast<std::size_t>(at));
      const float map_row = std::clamp(look_to.map_row[i], 0.0F, frame_rows - 1.0F);
      const bool is_beside = std::abs(map_row - look_to.map_row[i]) > beside_map_rows;
      const auto row = static_cast<std::size_t>(std::lround(map_row));
      look.cell = static_cast<std::uint32_t>(row * adjusted_bins + bin);
      look.beside_deg = static_cast<float>((at - static_cast<double>(bin) - 0.5) * adjusted_bin_deg);
      look.beside_rows = look_to.map_row[i] - static_cast<float>(row);
      look.weight = is_beside || std::isnan(one.half->temp_c[i]) ? 0.0F : 1.0F;
    }
  }
}

float LensAdjustment::reading_c(std::size_t half, std::size_t i) const {
  const HalfFrame& reading = *halves_[half].half;
  return reading.temp_c[i] - common_c_[half] - offset_c_[reading.parity][i];
}

/// Means of the cells, and slopes between those about them; slopes of the map before straighten what falls
/// beside a cell's middle.
void LensAdjustment::make_map() {
  std::vector<Cell> made(cells_.size());
  for (std::size_t j = 0; j < halves_.size(); ++j)
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const Look& look = looks_[j * half_pixels + i];
      if (look.weight <= 0.0F) continue;
      const Cell& before = cells_[look.cell];
      made[look.cell].temp_c += look.weight * (reading_c(j, i) - before.slope * look.beside_deg -
                                               before.row_slope * look.beside_rows);
      made[look.cell].weight += look.weight;
    }
  for (Cell& cell : made) cell.temp_c = cell.weight >= fewest_looks ? cell.temp_c / cell.weight : 0.0F;
  const auto known = [&](std::size_t row, long bin) -> const Cell* {
    constexpr auto all = static_cast<long>(adjusted_bins);
    const Cell& cell = made[row * adjusted_bins + static_cast<std::size_t>((bin % all + all) % all)];
    return cell.weight >= fewest_looks ? &cell : nullptr;
  };
  const auto slope = [](const Cell* from, const Cell* to, double apart) {
    return from == nullptr || to == nullptr ? 0.0F : (to->temp_c - from->temp_c) / static_cast<float>(apart);
  };
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t bin = 0; bin < adjusted_bins; ++bin) {
      const auto at = static_cast<long>(bin);
      Cell& cell = made[row * adjusted_bins + bin];
      cell.slope = slope(known(row, at - slope_reach), known(row, at + slope_reach),
                         2.0 * slope_reach * adjusted_bin_deg);
      const std::size_t above = row == 0 ? 0 : row - 1, below = std::min(row + 1, frame_rows - 1);
      cell.row_slope = slope(known(above, at), known(below, at), static_cast<double>(below - above));
    }
  cells_ = std::move(made);
}

void LensAdjustment::compare() {
  double sum = 0.0, count = 0.0;
  const auto most_c = far_off * static_cast<float>(std::sqrt(mean_square_));
  for (std::size_t j = 0; j < halves_.size(); ++j)
    for (std::size_t i = 0; i < half_pixels; ++i) {
      Look& look = looks_[j * half_pixels + i];
      const Cell& cell = cells_[look.cell];
      if (look.weight <= 0.0F || cell.weight < fewest_looks) {
        look.weight = 0.0F;
        continue;
      }
      look.residual_c =
          reading_c(j, i) - cell.temp_c - cell.slope * look.beside_deg - cell.row_slope * look.beside_rows;
      const float off_c = std::abs(look.residual_c);
      look.weight = off_c > most_c ? most_c / off_c : 1.0F;
      sum += double{std::min(off_c, most_c) * std::min(off_c, most_c)};
      count += 1.0;
    }
  mean_square_ = count > 0.0 ? sum / count : 1.0;
}

/// What all pixels of a half have in common, and what a pixel shows everywhere.
void LensAdjustment::learn_offsets() {
  std::array<HalfPixels, 2> sum{}, weight{};
  for (std::size_t j = 0; j < halves_.size(); ++j) {
    const unsigned parity = halves_[j].half->parity;
    float of_half = 0.0F, weights = 1e-3F;
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const Look& look = looks_[j * half_pixels + i];
      of_half += look.weight * look.residual_c;
      weights += look.weight;
      sum[parity][i] += look.weight * look.residual_c;
      weight[parity][i] += look.weight;
    }
    common_c_[j] += of_half / weights;
  }
  for (const unsigned parity : {0U, 1U})
    for (std::size_t i = 0; i < half_pixels; ++i)
      offset_c_[parity][i] += sum[parity][i] / std::max(1.0F, weight[parity][i]);
}

/// Of what a pixel should show, by the lens.
LensAdjustment::Vector LensAdjustment::slopes(std::size_t half, std::size_t i, const Look& look) const {
  const SweptHalf& one = halves_[half];
  const Directions& look_to = directions_[one.half->parity];
  const Cell& cell = cells_[look.cell];
  Vector slopes;
  for (std::size_t value = 0; value < lens_rows; ++value)
    slopes[static_cast<Eigen::Index>(value)] =
        cell.slope * look_to.azimuth_by[value][i] + cell.row_slope * look_to.map_row_by[value][i];
  const double turned_deg = one.rate_dps * (one.half->end_s - one.half->begin_s);
  slopes[lens_rows] = cell.slope * static_cast<float>(turned_deg * row_part(i, one.half->parity));
  return slopes;
}

/// What all looks say, the panorama taken as it is; and which halves look at each of its cells.
void LensAdjustment::add_looks(Equations& equations, Shares& shares) const {
  const Eigen::Index count = equations.headings();
  for (Eigen::Index j = 0; j < count; ++j)
    for (std::size_t i = 0; i < half_pixels; ++i) {
      const auto half = static_cast<std::size_t>(j);
      const Look& look = looks_[half * half_pixels + i];
      if (look.weight <= 0.0F) continue;
      const Cell& cell = cells_[look.cell];
      const Vector by_lens = slopes(half, i, look);
      const double weight = scale() * double{look.weight};
      equations.curvature(j, j) += weight * double{cell.slope * cell.slope};
      equations.curvature.block(count, j, own, 1) += weight * double{cell.slope} * by_lens.cast<double>();
      equations.curvature.block(count, count, own, own) +=
          weight * (by_lens * by_lens.transpose()).cast<double>();
      equations.gradient[j] += weight * double{cell.slope * look.residual_c};
      equations.lens_gradient.col(j) += weight * double{look.residual_c} * by_lens.cast<double>();
      shares.by_lens[look.cell] += look.weight * by_lens;
      auto& in_cell = shares.seen[look.cell];
      if (in_cell.empty() || in_cell.back().half != half)
        in_cell.push_back({static_cast<std::uint32_t>(half), 0.0F});
      in_cell.back().weight += look.weight;
    }
}

/// A cell's own temperature is taken out of the equations: what moves all pixels that look there by the same
/// tells nothing.
void LensAdjustment::eliminate_panorama(const Shares& shares, Equations& equations) const {
  const Eigen::Index count = equations.headings();
  Eigen::MatrixXd& curvature = equations.curvature;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    double all = 0.0;
    for (const InCell& one : shares.seen[c]) all += double{one.weight};
    if (all <= 0.0) continue;
    const double slope = double{cells_[c].slope};
    const Eigen::VectorXd sum = shares.by_lens[c].cast<double>();
    curvature.block(count, count, own, own) -= scale() / all * sum * sum.transpose();
    for (const InCell& one : shares.seen[c]) {
      const double push = scale() * slope * double{one.weight} / all;
      curvature.block(count, one.half, own, 1) -= push * sum;
      for (const InCell& other : shares.seen[c]) {
        if (other.half > one.half) break;
        curvature(one.half, other.half) -= push * slope * double{other.weight};
      }
    }
  }
}

/// By the gyro, which only keeps halves together that see nothing, and by what is known of lenses.
void LensAdjustment::add_priors(Equations& equations) const {
  auto& [curvature, gradient, lens_gradient] = equations;
  const Eigen::Index count = equations.headings();
  for (Eigen::Index j = 0; j < count; ++j) {
    curvature(j, j) += 1.0 / square(heading_sigma_deg);
    if (j == 0 || !halves_[static_cast<std::size_t>(j)].follows) continue;
    const SweptHalf &one = halves_[static_cast<std::size_t>(j)],
                    &before = halves_[static_cast<std::size_t>(j - 1)];
    const double off_deg = one.turned_deg - (one.heading_deg - before.heading_deg);
    const double weight = 1.0 / square(increment_sigma_deg);
    curvature(j, j) += weight;
    curvature(j - 1, j - 1) += weight;
    curvature(j, j - 1) -= weight;
    gradient[j] += weight * off_deg;
    gradient[j - 1] -= weight * off_deg;
  }
  gradient.tail(own) = lens_gradient.rowwise().sum();
  for (std::size_t value = 0; value < lens_values; ++value) {
    const auto at = count + static_cast<Eigen::Index>(value);
    curvature(at, at) += 1.0 / square(prior[value]);
    gradient[at] -= values_[value] / square(prior[value]);
  }
}

/// Of the lens alone, by what each block of the recording says of it.
void LensAdjustment::learn_uncertainties(const Eigen::MatrixXd& said, const Eigen::MatrixXd& covariance) {
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(own, own);
  for (Eigen::Index from = 0; from < said.cols(); from += block_halves) {
    const auto length = std::min<Eigen::Index>(block_halves, said.cols() - from);
    const Eigen::VectorXd block = said.middleCols(from, length).rowwise().sum();
    scatter += block * block.transpose();
  }
  for (std::size_t value = 0; value < lens_values; ++value)
    scatter(static_cast<Eigen::Index>(value), static_cast<Eigen::Index>(value)) += 1.0 / square(prior[value]);
  const Eigen::MatrixXd spread = covariance * scatter * covariance;
  for (std::size_t value = 0; value < lens_values; ++value)
    sigma_[value] = std::sqrt(spread(static_cast<Eigen::Index>(value), static_cast<Eigen::Index>(value)));
}

/// Returns the longest step of the lens, in standard deviations.
double LensAdjustment::move(const Eigen::VectorXd& lens_step, const Eigen::VectorXd& heading_step) {
  double longest = 0.0;
  for (std::size_t value = 0; value < lens_values; ++value) {
    const double change =
        std::clamp(lens_step[static_cast<Eigen::Index>(value)], -longest_step[value], longest_step[value]);
    longest = std::max(longest, std::abs(change) / sigma_[value]);
    values_[value] = std::clamp(values_[value] + change, -farthest[value], farthest[value]);
  }
  for (std::size_t j = 0; j < halves_.size(); ++j)
    halves_[j].heading_deg +=
        std::clamp(heading_step[static_cast<Eigen::Index>(j)], -longest_turn_deg, longest_turn_deg);
  return longest;
}

/// Returns the longest step of the lens, in standard deviations.
double LensAdjustment::step() {
  const auto count = static_cast<Eigen::Index>(halves_.size());
  Equations equations{Eigen::MatrixXd::Zero(count + own, count + own), Eigen::VectorXd::Zero(count + own),
                      Eigen::MatrixXd::Zero(own, count)};
  Shares shares{std::vector<std::vector<InCell>>(cells_.size()),
                std::vector<Vector>(cells_.size(), Vector::Zero())};
  add_looks(equations, shares);
  eliminate_panorama(shares, equations);
  add_priors(equations);
  const auto& [curvature, gradient, lens_gradient] = equations;
  const Eigen::LLT<Eigen::MatrixXd> of_headings(curvature.topLeftCorner(count, count));
  const Eigen::MatrixXd across = curvature.bottomLeftCorner(own, count);
  const Eigen::MatrixXd share = of_headings.solve(across.transpose()).transpose();
  const Eigen::MatrixXd covariance =
      (curvature.bottomRightCorner(own, own) - share * across.transpose()).inverse();
  const Eigen::VectorXd lens_step = covariance * (gradient.tail(own) - share * gradient.head(count));
  const Eigen::VectorXd heading_step =
      of_headings.solve(gradient.head(count)) - share.transpose() * lens_step;
  if (!lens_step.allFinite() || !heading_step.allFinite()) {  // no panorama of anything
    sigma_.fill(std::numeric_limits<double>::infinity());
    return 0.0;
  }
  learn_uncertainties(lens_gradient - share * gradient.head(count).asDiagonal(), covariance);
  return move(lens_step, heading_step);
}

void LensAdjustment::run() {
  for (int i = 0; i < most_rounds; ++i) {
    aim();
    place_looks();
    for (int again = 0; again < 2; ++again) {  // slopes come from the map before
      make_map();
      compare();
      learn_offsets();
    }
    make_map();
    compare();
    if (step() < settled && i >= fewest_rounds) break;
  }
}

}  // namespace thermorig::odometer
