// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>

#include "heading_filter.h"
#include "lens.h"
#include "panorama.h"
#include "thermorig/core/surroundings/half_frame.h"

namespace thermorig::odometer {

/// Where each row looks and how far it sweeps, if rows are exposed one after the other: rows from the top.
struct RowSweeps {
  std::array<float, frame_rows> shift_deg{};  // against the middle of the frame
  std::array<float, frame_rows> half_width_deg{};
};

/// A half-frame to be registered: what it shows without its pixels' errors, and their noise.
struct View {
  const HalfPixels* temp_c = nullptr;  // NaN: no reading
  const HalfPixels* variance = nullptr;
  unsigned parity = 0;
  double half_width_deg = 0.0;  // of what a pixel sweeps during the exposure
  double trust_deg2 = 0.0;      // variance of the heading beforehand: what it explains is no outlier
  bool is_strict = false;       // what fits badly counts for nothing
  const RowSweeps* rows =
      nullptr;  // of a camera whose rows look apart: exposed one after the other, or not level
};

/// How a slope of the panorama is taken: over so many bins, over one row or three.
struct Slope {
  std::ptrdiff_t reach = 1;
  bool smooth = false;
};

/// Registers half-frames against the panorama: the azimuth at which its pixels fit best, by Gauss-Newton with
/// a robust loss, and how well they fix it.
class Alignment {
 public:
  Alignment(const Panorama& panorama, const HeadingFilter& filter, const Lens& lens)
      : panorama_(panorama), filter_(filter), lens_(lens) {}

  struct Comparison {
    HalfPixels residual{};  // NaN where nothing was compared; what all have in common is removed
    HalfPixels map_variance{};
    float common_c = 0.0F;
    std::array<double, HeadingFilter::nodes> about{};  // whose offset of the map it depends on, shares of 1
    double gradient = 0.0;                             // weighted sum of slope times residual
    double curvature = 0.0;                            // weighted sum of slope squared
    double known = 0.0;       // the same less what noise adds to it: what is known of the heading
    double cost = 0.0;        // weighted squares of a pixel, robust
    double flat_cost = 0.0;   // the same, had the surroundings no structure at all
    double squares_k2 = 0.0;  // mean square of what was left, robust
    double pixels = 0.0;      // that were compared
    double step_deg() const { return known > 0.0 ? gradient / known : 0.0; }
    /// Slopes that may be nothing but noise tell nothing.
    double variance_deg2() const {
      return known > least_known_share * curvature ? curvature / (known * known) : 1e9;
    }
    static constexpr double least_known_share = 0.25;
  };
  Comparison compare(const View& view, double azimuth_deg, const Slope& slope) const;

  struct Found {
    double azimuth_deg = 0.0;
    bool is_found = false;
    int comparisons = 0;  // at the map
    Comparison comparison;
  };
  /// The best azimuth about one that is known to `sigma_deg`.
  Found find(const View& view, double azimuth_deg, double sigma_deg) const;

  /// How badly a half fits there: robust squares of all its pixels. Where nothing is known of the
  /// surroundings, they should be all alike.
  double squares(const View& view, double azimuth_deg) const;

  /// Squares of a half's pixels beyond those of their noise, robust, what each row has in common taken off:
  /// less the map, and as they are.
  struct Explained {
    double left = 0.0, structure = 0.0;
  };
  Explained explained(const View& view, double azimuth_deg) const;

  /// `take` gets the rays along which a column of pixels looks at the map: one of all of them, or if the view
  /// has rows that look elsewhere, one each.
  template <typename Take>
  void each_ray(const View& view, double azimuth_deg, std::size_t column, Take take) const {
    if (view.rows == nullptr)
      return take(Panorama::of_column(map_azimuth_deg(azimuth_deg + lens_.bearing_deg(column)),
                                      view.half_width_deg, row_class(column, view.parity)));
    for (std::size_t row = row_class(column, view.parity); row < frame_rows; row += 2)
      take(ray_in_row(view, azimuth_deg, column, row, row));
  }

  /// What the map shows where each pixel looks, less what it shows there in the pixel's own row: of a camera
  /// that is not level. 0 where it is not known.
  HalfPixels beside_row(const View& view, double azimuth_deg) const;

 private:
  struct Residuals {
    HalfPixels residual, weight;  // 0, both, where nothing is compared
    float weights = 0.0F, sum = 0.0F, flat_sum = 0.0F;
    void take(const View& view, std::size_t column, const Panorama::Predicted& predicted);
  };
  Residuals residuals(const View& view, double azimuth_deg) const;
  struct Fit {
    double cost = 0.0, pixels = 0.0;
  };
  /// As far as Comparison has it, in less than half the time.
  Fit fit(const View& view, double azimuth_deg) const;
  double map_azimuth_deg(double at_deg) const { return at_deg - filter_.map_offset_deg(at_deg); }
  /// Where a pixel of `row` looks, in that row of the map.
  Panorama::Ray ray_in_row(const View& view, double azimuth_deg, std::size_t column, std::size_t row,
                           std::size_t map_row) const {
    const double bearing_deg = lens_.is_plain() ? lens_.bearing_deg(column) : lens_.bearing_deg(column, row);
    return Panorama::of_pixel(map_azimuth_deg(azimuth_deg + double{view.rows->shift_deg[row]} + bearing_deg),
                              double{view.rows->half_width_deg[row]}, map_row);
  }
  double searched(const View& view, double azimuth_deg, double sigma_deg, int& comparisons) const;

  const Panorama& panorama_;
  const HeadingFilter& filter_;
  const Lens& lens_;
};

}  // namespace thermorig::odometer
