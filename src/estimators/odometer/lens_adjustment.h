// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/surroundings/half_frame.h"

namespace thermorig::odometer {

/// What a lens is described by, beside its nominal width: numbers of CameraProfile, of pitch_scale less 1.
enum LensValue : std::uint8_t { lens_pitch, lens_distortion, lens_tilt, lens_roll, lens_rows };
inline constexpr std::size_t lens_values = 5;
using LensValues = std::array<double, lens_values>;

CameraProfile camera_with(CameraProfile camera, const LensValues& values);

/// A half-frame, where it is thought to look, and how fast the rig turned.
struct SweptHalf {
  const HalfFrame* half = nullptr;
  double heading_deg = 0.0;
  double rate_dps = 0.0;
  double turned_deg = 0.0;  // since the half before, by the gyro
  bool follows = false;     // the half before at a speed that stayed as it was
};

/// Bundle adjustment: one rigid panorama, a heading of its own for each half, and the lens, so that each
/// place of the panorama shows the same to all pixels that look there. Gauss-Newton; the panorama is
/// eliminated, with straight lines between its cells. The gyro only keeps halves together that see nothing.
class LensAdjustment {
 public:
  /// `trust`: of the likelihood, for halves share the errors of one map.
  LensAdjustment(std::vector<SweptHalf> halves, const CameraProfile& camera, const LensValues& values,
                 double trust);

  void run();

  const LensValues& values() const { return values_; }
  /// One standard deviation, from the spread among blocks of the recording and what is known beforehand.
  double uncertainty(LensValue value) const { return sigma_[value]; }

  static constexpr LensValues prior{0.03, 0.05, 5.0, 5.0, 0.7};  // one standard deviation

 private:
  static constexpr auto own = static_cast<Eigen::Index>(lens_values);
  using Vector = Eigen::Matrix<float, lens_values, 1>;
  struct Look {  // of a pixel at the panorama
    std::uint32_t cell = 0;
    float beside_deg = 0.0F, beside_rows = 0.0F;  // of the cell's middle
    float residual_c = 0.0F;
    float weight = 0.0F;  // 0: not compared
  };
  struct Cell {
    float temp_c = 0.0F, slope = 0.0F, row_slope = 0.0F, weight = 0.0F;  // K a deg, K a row
  };
  struct Directions {  // of the pixels of one half-frame
    HalfPixels azimuth_deg{}, map_row{};
    std::array<HalfPixels, lens_values> azimuth_by{}, map_row_by{};  // change with a value of the lens
  };
  struct Equations {  // of a step: the headings of all halves, then the lens
    Eigen::MatrixXd curvature;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd lens_gradient;  // what each half says of the lens: (lens, halves)

    Eigen::Index headings() const { return lens_gradient.cols(); }
  };
  struct InCell {
    std::uint32_t half;
    float weight;
  };
  struct Shares {  // of each cell of the panorama
    std::vector<std::vector<InCell>> seen;
    std::vector<Vector> by_lens;
  };
  void aim();
  void place_looks();
  void make_map();
  void compare();
  void learn_offsets();
  double step();
  void add_looks(Equations& equations, Shares& shares) const;
  void eliminate_panorama(const Shares& shares, Equations& equations) const;
  void add_priors(Equations& equations) const;
  void learn_uncertainties(const Eigen::MatrixXd& said, const Eigen::MatrixXd& covariance);
  double move(const Eigen::VectorXd& lens_step, const Eigen::VectorXd& heading_step);
  double scale() const { return trust_ / mean_square_; }  // of the likelihood
  float reading_c(std::size_t half, std::size_t i) const;
  Vector slopes(std::size_t half, std::size_t i, const Look& look) const;
  double row_part(std::size_t i, unsigned parity) const;

  std::vector<SweptHalf> halves_;
  CameraProfile camera_;
  LensValues values_;
  double trust_;
  std::array<Directions, 2> directions_;
  std::vector<Look> looks_;  // half after half
  std::vector<Cell> cells_;  // row after row
  std::vector<float> common_c_;
  std::array<HalfPixels, 2> offset_c_{};
  LensValues sigma_ = prior;
  double mean_square_ = 1.0;  // K^2, of pixels that were compared
};

}  // namespace thermorig::odometer
