// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <span>
#include <vector>

#include "angle_track.h"
#include "half_view.h"
#include "normal_equations.h"
#include "panorama_map.h"

namespace thermorig::motion {

/// How the halves are to be laid side by side.
struct Layout {
  double pitch_deg = 55.0 / 32.0;  // between columns
  bool mirrored = true;
  bool closed =
      false;  // a whole turn leads back to the same surroundings; else every angle is a place of its own
};

/// What is known of the parameters beforehand.
struct Prior {
  Parameters mean{0.0, 0.0, 0.0, 1.0};
  Parameters uncertainty{};
};

/// Lays halves into one panorama and finds the parameters with which it is sharpest: Gauss-Newton on the
/// variance within the cells. The panorama itself, each pixel's own offset and each half's are nuisances: the
/// panorama is eliminated exactly (variable projection), offsets are re-estimated in every round.
class Alignment {
 public:
  /// `views` must outlive the alignment; their trust is adapted to how well readings fit.
  Alignment(std::span<HalfView> views, const AngleTrack& track, const Layout& layout, const Prior& prior);

  /// Variance within the cells if the parameters were these: what a search over a grid compares.
  double variance(const Parameters& parameters);

  /// From there to the sharpest panorama near by, until the parameter that is asked for has settled.
  void refine(const Parameters& start, Parameter asked);

  const Parameters& parameters() const { return parameters_; }
  /// Covariance of the parameters, from the spread among blocks of the recording.
  const Matrix& covariance() const { return covariance_; }
  /// Share of the slopes in the panorama that is not noise: near 0 before a blind wall.
  double contrast() const { return contrast_; }
  /// Residual variance of each view, with the panorama, in K2.
  const std::vector<double>& misfit() const { return misfit_; }
  /// What it would be on average without a panorama: variance within a half.
  double spread() const;

 private:
  struct Totals;
  struct Comparison {  // of a half with the panorama
    HalfPixels residual;
    HalfPixels slope;
    HalfPixels weight;
    float common;  // to all its residuals
  };
  double angle_deg(const HalfView& view, const Parameters& parameters) const;
  Parameters angle_change(const HalfView& view) const;
  void remove_smooth_offsets();
  void make_map(const Parameters& parameters);
  void fill_map();
  Comparison compare(std::size_t index) const;
  Totals compare_all();
  void add_pixels(const Comparison& comparison, unsigned parity, Totals& totals) const;
  void add_push(const Comparison& comparison, std::size_t index, Totals& totals) const;
  void eliminate_map(Totals& totals) const;
  void learn_pixels(const Totals& totals);
  void learn_trust();
  Parameters pull(std::size_t index, const Totals& totals) const;
  bool step(const Totals& totals, Parameter asked);
  void judge(const Totals& totals);
  HalfPixels values_of(std::size_t view) const;
  HalfPixels weights_of(const HalfView& view) const;

  std::span<HalfView> views_;
  const AngleTrack& track_;
  Layout layout_;
  Prior prior_;
  double middle_s_ = 0.0;
  double middle_deg_ = 0.0;
  PanoramaMap map_;
  std::vector<PanoramaMap::Place> places_;
  std::array<HalfPixels, 2> pixel_offset_{};  // of each parity
  std::array<HalfPixels, 2> pixel_weight_{};  // 1 for a pixel of average noise
  std::vector<float> half_offset_;            // common to a half
  double noise_variance_ = 1.0;
  Parameters parameters_{};
  Matrix covariance_{};
  double contrast_ = 0.0;
  std::vector<double> misfit_;
};

}  // namespace thermorig::motion
