// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <span>
#include <vector>

#include "angle_model.h"
#include "half_view.h"
#include "panorama_map.h"
#include "pixel_model.h"

namespace thermorig::motion {

/// How the halves are to be laid side by side.
struct Layout {
  double pitch_deg = 55.0 / 32.0;  // between columns
  bool mirrored = true;
  bool closed = false;  // a whole turn leads back to the same surroundings; else every angle is another place
  double bin_factor = 1.0;  // of the panorama's bins: wider ones see coarse structure alone
};

/// Beyond that offset a camera's halves cannot be told from their neighbours.
inline constexpr double largest_offset_s = 0.30;

/// Lays halves into one panorama and finds the parameters with which it is sharpest: Gauss-Newton on the
/// variance within the cells. The panorama itself, each pixel's own offset and each half's are nuisances: the
/// panorama is eliminated exactly (variable projection), offsets are re-estimated in every round.
class Alignment {
 public:
  /// `views` must outlive the alignment; their trust is adapted to how well readings fit.
  Alignment(std::span<HalfView> views, const AngleTrack& track, const Layout& layout, const Prior& prior);

  /// Variance within the cells if the parameters were these: what a search over a grid compares.
  double variance(const Parameters& parameters);
  /// How many readings of average noise that variance was computed from, less what the panorama took.
  double readings() const { return reading_count_; }

  /// Another distance between columns than the layout's, from now on.
  void set_pitch(double pitch_deg) { layout_.pitch_deg = pitch_deg; }
  /// From now on variance() looks at one half of so many.
  void look_at_one_of(std::size_t stride) { stride_ = stride; }
  /// Lays the same halves out anew, with all that has been learnt about them and their pixels.
  void lay_out(const Layout& layout);
  /// Residual variance of each view with the panorama, were the parameters these; nothing is learnt, and no
  /// outlier left out that was none before.
  std::vector<double> misfit_at(const Parameters& parameters);

  /// The offset at which the panorama is sharpest, on a coarse grid; other parameters as known beforehand.
  /// Most of the grid is searched with a part of the halves.
  Parameters search_offset();

  /// From there to the sharpest panorama near by, until the parameter that is asked for has settled.
  void refine(const Parameters& start, Parameter asked);

  const Parameters& parameters() const { return parameters_; }
  /// One standard deviation, from the spread among blocks of the recording.
  double uncertainty(Parameter parameter) const;
  /// Share of the slopes in the panorama that is not noise: near 0 before a blind wall.
  double contrast() const { return contrast_; }
  /// The row of the frame (from 0 at its top) for which the result stands: where the slopes are that tell.
  double middle_row() const;
  /// Residual variance of each view, with the panorama, in K2.
  const std::vector<double>& misfit() const { return misfit_; }
  /// What it would be on average without a panorama: variance within a half.
  double spread() const;

 private:
  struct Comparison {  // of a half with the panorama
    HalfPixels residual;
    HalfPixels slope;  // K a deg
    HalfPixels weight;
    float common;  // to all its residuals
  };
  struct Totals {  // what one look at all halves adds up to
    Parameters gradient = Parameters::Zero();
    Matrix curvature = Matrix::Zero();
    std::vector<Parameters> change;                        // of each view's angle with the parameters
    std::vector<double> view_gradient;                     // sum of slope times residual of each view
    std::array<PanoramaMap::Cells, parameter_count> push;  // of the panorama's cells by each parameter
    double square_sum = 0.0;                               // of weighted residuals
    double weight_sum = 0.0;
    std::array<PixelModel::Residuals, 2> pixels{};
  };
  void read();
  void make_map(const Parameters& parameters);
  Comparison compare(std::size_t index) const;
  Parameters sharpest_offset(int from, int to);
  Totals compare_all();
  void add_view(const Comparison& comparison, std::size_t index, Totals& totals);
  void add_push(const Comparison& comparison, std::size_t index, Totals& totals) const;
  void eliminate_map(Totals& totals) const;
  void learn_noise(const Totals& totals);
  void learn_trust();
  Matrix with_prior(const Matrix& information) const;
  static Matrix inverse(const Matrix& matrix);
  double mean_square_shift(const Totals& totals, const Parameters& change) const;
  bool step(const Totals& totals, Parameter asked);
  Parameters pull(const Comparison& comparison, std::size_t index, const Totals& totals) const;
  Matrix spread_of_pulls(const Totals& totals) const;
  void judge(const Totals& totals);

  std::span<HalfView> views_;
  Layout layout_;
  Prior prior_;
  AngleModel angles_;
  PixelModel pixels_;
  PanoramaMap map_;
  std::vector<PanoramaMap::Place> places_;
  std::vector<float> half_offset_c_;  // common to a half
  std::vector<Readings> readings_;    // by what is known of pixels and halves
  double noise_variance_ = 1.0;
  Parameters parameters_ = Parameters::Zero();
  Matrix covariance_ = Matrix::Zero();
  double contrast_ = 0.0;
  std::vector<double> misfit_;
  double reading_count_ = 1.0;
  std::size_t stride_ = 1;
};

}  // namespace thermorig::motion
