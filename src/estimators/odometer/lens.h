// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "thermorig/core/profile.h"
#include "thermorig/core/surroundings/half_frame.h"
#include "thermorig/estimators/odometer/map.h"

namespace thermorig::odometer {

/// Where each pixel looks, and when its row is exposed, as a profile has it.
class Lens {
 public:
  explicit Lens(const CameraProfile& camera);

  double pitch_deg() const { return pitch_deg_; }
  double direction() const { return direction_; }  // of growing columns: 1 or -1

  /// A column's azimuth about the camera's axis: of all of its pixels, where they are not the same, the mean.
  double bearing_deg(std::size_t column) const { return columns_deg_[column]; }

  /// Columns stand upright and even, rows lie level.
  bool is_plain() const { return is_plain_; }
  /// Of a pixel, whether they do or not.
  double bearing_deg(std::size_t column, std::size_t row) const {
    return double{bearings_deg_[column * frame_rows + row]};
  }
  /// Which row of the map it shows, whole or not: its own in the middle of a level camera's frame.
  double map_row(std::size_t column, std::size_t row) const {
    return double{map_rows_[column * frame_rows + row]};
  }

  /// Whether it was measured that rows are exposed one after the other.
  bool knows_rows() const { return knows_rows_; }
  RowOrder rows() const { return rows_; }
  /// How much later than the middle rows a row is exposed, in refresh periods, if that is their order.
  double row_delay_periods(RowOrder order, std::size_t row) const {
    if (order == RowOrder::at_once) return 0.0;
    const double later = spread_ * (static_cast<double>(row) / (frame_rows - 1) - 0.5);
    return order == RowOrder::first_to_last ? later : -later;
  }

 private:
  void look(const CameraProfile& camera);
  void look_by_columns();

  double pitch_deg_, direction_;
  bool is_plain_, knows_rows_;
  RowOrder rows_ = RowOrder::at_once;
  double spread_ = 1.0;  // of the rows' exposures, in refresh periods
  std::array<double, frame_columns> columns_deg_{};
  std::array<float, frame_pixels> bearings_deg_{}, map_rows_{};  // column after column, rows from the top
};

/// All that look through one lens share it: it is six kilobytes.
using SharedLens = std::shared_ptr<const Lens>;

}  // namespace thermorig::odometer
