// SPDX-License-Identifier: MIT
#include "parabola.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

namespace thermorig::fit {

namespace {
constexpr int most_pivots = 200;
constexpr double tolerance_s = 1e-10;  // below any clock's tick
constexpr double touching_s = 1e-7;    // an inequality that the curve obeys as an equation

using Vector = std::array<double, 3>;

double dot(const Vector& u, const Vector& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}
Vector cross(const Vector& u, const Vector& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

/// row . (a, b, c) <= limit
struct Row {
  Vector row;
  double limit = 0.0;
};

/// Three rows that hold the curve from above, and with which weights they make up the objective.
struct Basis {
  std::array<Row, 3> rows;
  Vector weights;

  /// Columns of the inverse of the matrix of rows.
  std::array<Vector, 3> inverse() const {
    const Vector c0 = cross(rows[1].row, rows[2].row);
    const double scale = 1.0 / dot(rows[0].row, c0);
    std::array<Vector, 3> columns{c0, cross(rows[2].row, rows[0].row), cross(rows[0].row, rows[1].row)};
    for (Vector& column : columns)
      for (double& value : column) value *= scale;
    return columns;
  }
};

class HighestParabola {
 public:
  HighestParabola(std::span<const Ceiling> ceilings, double middle, double half_width, const Moments& moments,
                  const ParabolaLimits& limits)
      : ceilings_(ceilings),
        middle_(middle),
        half_width_(half_width),
        objective_{1.0, moments.first / half_width, moments.second / (half_width * half_width)},
        slope_(limits.slope * half_width),
        curvature_(limits.curvature * half_width * half_width) {}

  Parabola solve() {
    begin();
    Vector curve = vertex();
    for (int pivot = 0; pivot < most_pivots; ++pivot) {
      const Row worst = most_violated(curve);
      if (excess(worst, curve) <= tolerance_s || !enter(worst)) break;
      curve = vertex();
    }
    curve[0] -= std::max(0.0, excess(most_violated(curve), curve));  // no pivot left: lower it
    return {middle_, curve[0], curve[1] / half_width_, curve[2] / (half_width_ * half_width_)};
  }

 private:
  static double excess(const Row& row, const Vector& curve) { return dot(row.row, curve) - row.limit; }

  Row row_of(const Ceiling& ceiling) const {
    const double x = (ceiling.x - middle_) / half_width_;
    return {{1.0, x, x * x}, ceiling.y};
  }

  /// One ceiling and the two limits toward which the objective pulls from it: dual feasible.
  void begin() {
    const Row first = row_of(ceilings_[ceilings_.size() / 2]);
    const double b = objective_[1] - first.row[1];
    const double c = objective_[2] - first.row[2];
    basis_.rows = {first, limit_row(1, b < 0 ? -1.0 : 1.0), limit_row(2, c < 0 ? -1.0 : 1.0)};
    basis_.weights = {1.0, std::abs(b), std::abs(c)};
  }

  Row limit_row(std::size_t unknown, double sign) const {
    Row row{{}, unknown == 1 ? slope_ : curvature_};
    row.row[unknown] = sign;
    return row;
  }

  Vector vertex() const {
    const auto columns = basis_.inverse();
    Vector curve{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) curve[i] += columns[j][i] * basis_.rows[j].limit;
    return curve;
  }

  Row most_violated(const Vector& curve) const {
    std::size_t worst = 0;
    double worst_s = -1e300;
    for (std::size_t k = 0; k < ceilings_.size(); ++k) {
      const double x = (ceilings_[k].x - middle_) / half_width_;
      const double excess_s = curve[0] + (curve[1] + curve[2] * x) * x - ceilings_[k].y;
      if (excess_s > worst_s) worst_s = excess_s, worst = k;
    }
    Row row = row_of(ceilings_[worst]);
    for (const std::size_t unknown : {std::size_t{1}, std::size_t{2}}) {
      const Row limit = limit_row(unknown, curve[unknown] < 0 ? -1.0 : 1.0);
      if (excess(limit, curve) > excess(row, curve)) row = limit;
    }
    return row;
  }

  /// Takes `row` into the basis for the one whose weight runs out first; false: nothing is left to give.
  bool enter(const Row& row) {
    const auto columns = basis_.inverse();
    Vector share{};  // row = sum of share * rows
    for (std::size_t j = 0; j < 3; ++j) share[j] = dot(row.row, columns[j]);
    std::size_t leaves = 3;
    double least = 0.0;
    for (std::size_t j = 0; j < 3; ++j) {
      if (share[j] <= 1e-12) continue;
      const double ratio = basis_.weights[j] / share[j];
      if (leaves == 3 || ratio < least) least = ratio, leaves = j;
    }
    if (leaves == 3) return false;
    for (std::size_t j = 0; j < 3; ++j)
      basis_.weights[j] = std::max(0.0, basis_.weights[j] - least * share[j]);
    basis_.rows[leaves] = row;
    basis_.weights[leaves] = least;
    return true;
  }

  std::span<const Ceiling> ceilings_;
  double middle_;
  double half_width_;
  Vector objective_;
  double slope_;  // limits in scaled units
  double curvature_;
  Basis basis_{};
};
}  // namespace

Parabola highest_below(std::span<const Ceiling> ceilings, double middle, double half_width,
                       const Moments& moments, const ParabolaLimits& limits) {
  assert(!ceilings.empty() && half_width > 0.0);
  return HighestParabola(ceilings, middle, half_width, moments, limits).solve();
}

double rise_without_holding(std::span<const Ceiling> ceilings, const Parabola& highest, double x,
                            double half_width, const Moments& moments, const ParabolaLimits& limits) {
  std::vector<double> holding_x;
  for (const Ceiling& ceiling : ceilings)
    if (ceiling.y - highest.at(ceiling.x) < touching_s) holding_x.push_back(ceiling.x);
  std::vector<Ceiling> rest;
  for (const Ceiling& ceiling : ceilings)
    if (std::find(holding_x.begin(), holding_x.end(), ceiling.x) == holding_x.end()) rest.push_back(ceiling);
  if (rest.empty()) return 0.0;
  const Parabola higher = highest_below(rest, highest.middle, half_width, moments, limits);
  return std::max(0.0, higher.at(x) - highest.at(x));
}

}  // namespace thermorig::fit
