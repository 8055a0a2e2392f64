// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "alignment.h"
#include "circle_search.h"
#include "heading_filter.h"
#include "panorama.h"
#include "pixel_model.h"
#include "thermorig/core/surroundings/half_frame.h"
#include "thermorig/core/surroundings/turn_path.h"

namespace thermorig::odometer {

/// What came of a half-frame.
struct HalfResult {
  bool is_used = false;        // the filter took it
  bool is_judged = false;      // it could be registered against the map
  bool is_flat = false;        // surroundings without any structure fit it better than the map does
  bool is_other_view = false;  // and does not fit them either: it shows something else
  double nis = 0.0;            // its innovation squared, over the variance that was expected
  double innovation_deg = 0.0, sigma_deg = 0.0;  // and what was expected of it
  double misfit = 0.0;   // squares of its pixels, divided by what was expected of them
  double left_k2 = 0.0;  // mean square of what its pixels differ from the map by
  double rate_dps = 0.0;
  int work = 0;                    // what it cost: as many looks at the map, column by column
  Alignment::Explained explained;  // by a map that was loaded
};

/// Heading filter and panorama together. Each half-frame: advance() is the time update, then add() registers
/// it against the panorama, updates the filter by the heading that was found, and writes the panorama.
class Tracker {
 public:
  static constexpr double least_bias_sigma_dps = 0.1;  // that a pass begins with

  Tracker(const Priors& priors, const SharedLens& lens);

  /// Forgets everything. `things_move`: people, say, through all that it sees.
  void restart(const Priors& priors, RowOrder rows = RowOrder::at_once, bool things_move = false);
  RowOrder rows() const { return rows_; }
  /// What another pass through the same halves may begin with: `priors` but for what this one learnt.
  Priors learnt(const Priors& priors) const;

  /// The camera's noise is what another one has learnt. After restart().
  void expect_noise_of(const Tracker& other) { pixels_.expect_noise(other.pixels_.noise_k2()); }

  /// Parts of the surroundings were never seen.
  bool has_gap() const { return filter_.has_gap(); }
  /// The map, until it closes, is an open one: its degrees are the lens's. Then what is written
  /// again is off as the half is at that time, and no longer as the one that first saw it was.
  void expect_open_map() { is_open_ = true; }
  /// From now on: people, say, besides the rig.
  void expect_traffic();

  /// Everything but a map that was made before.
  void restart(const Priors& priors, const Map& map);
  void keep(Map& map) const;
  /// From now on nobody asks how much of the half-frames that map explains.
  void trust_map() { is_on_trial_ = false; }
  /// The map is made: from now on halves confirm it.
  void end_learning() { is_learning_ = false; }

  /// Heading forward to a time, by the gyro's path.
  void advance(const TurnPath& path, double now_s);

  /// A half whose exposure has ended by then.
  /// Not `is_trusted`: where it looks may be another place, and nothing is written there.
  HalfResult add(const HalfFrame& half, const TurnPath& path, bool is_trusted = true);

  /// Where the half may look in the map, without learning anything of it. `turned_deg`: since the half
  /// before.
  void locate(const HalfFrame& half, const TurnPath& path, CircleSearch& search);
  /// What the search found, of the newest half: the nearest of the headings that it may be.
  void settle(const CircleSearch::Found& found);
  double located_deg() const { return located_deg_; }  // of the newest half, as the gyro has it

  /// The bias may have stepped, and the latency be wrong, by so much (one standard deviation each).
  void widen(double bias_dps, double latency_s) { filter_.widen(square(bias_dps), square(latency_s)); }
  double rate_dps() const { return rate_dps_; }      // of the newest half
  double in_map_deg() const { return in_map_deg_; }  // where the newest half that was used looks in the map

  const HeadingFilter& filter() const { return filter_; }
  double now_s() const { return now_s_; }
  bool has_begun() const { return has_begun_; }

  /// The map as an image, in degrees Celsius.
  std::vector<float> map_image_c() const;

  /// One standard deviation of the heading against the map that is in view: with the newest half, and what
  /// the gyro may have walked since.
  double sigma_in_map_deg() const {
    const double since_deg2 = square(filter_.sigma(HeadingFilter::heading)) - heading_deg2_;
    return std::sqrt(square(half_sigma_deg_) + std::max(0.0, since_deg2));
  }

 private:
  static constexpr double least_scale_sigma = 0.002, least_latency_sigma_s = 0.003;
  struct Exposed {  // a half, and where it should look
    ExposedTurn turn;
    HalfPixels temp_c;
    double azimuth_deg = 0.0, rate_dps = 0.0, half_width_deg = 0.0;
    RowSweeps rows;  // of a camera that exposes them one after the other
  };
  Exposed expose(const HalfFrame& half, const TurnPath& path);
  HalfResult judge(const HalfFrame& half, const Exposed& exposed);
  void keep_sigma(double sigma_deg);
  int work_of(int comparisons) const;
  std::array<double, HeadingFilter::nodes> written_shares(const Alignment::Comparison& comparison,
                                                          const HalfPixels& variance,
                                                          double azimuth_deg) const;
  void expose_rows(const HalfFrame& half, const TurnPath& path, Exposed& exposed) const;
  void level(const HalfFrame& half, Exposed& exposed) const;
  bool do_rows_look_apart() const { return rows_ != RowOrder::at_once || !lens_->is_plain(); }
  View view_of(const HalfFrame& half, const Exposed& exposed) const;
  void begin_nodes(double azimuth_deg, const Exposed& exposed, const HeadingFilter::Vector& shown);
  void write(const View& view, double azimuth_deg, double sigma_deg, float common_c);

  SharedLens lens_;
  RowOrder rows_ = RowOrder::at_once;
  bool things_move_ = false;
  HeadingFilter filter_;
  Panorama panorama_;
  PixelModel pixels_;
  double now_s_ = 0.0, now_deg_ = 0.0, now_unseen_deg2_ = 0.0;
  bool has_begun_ = false;
  bool is_on_trial_ = false;  // the map
  bool is_learning_ = false;  // it is being made
  bool is_open_ = false;      // it may not close
  float reference_c_ = 0.0F;  // temperatures are kept as differences from it
  int halves_ = 0;
  double half_sigma_deg_ = 0.0;  // of the heading against the map, with the newest half
  double heading_deg2_ = 0.0;    // the heading's own variance then
  double rate_dps_ = 0.0;
  double in_map_deg_ = 0.0;
  double located_deg_ = 0.0;  // where the newest half looks, that is searched for,
  ExposedTurn located_turn_;  // and what the gyro turned by in it
  float common_c_ = 0.0F;     // of the newest half
  std::array<double, HeadingFilter::nodes> rewritten_{};  // shares of an open map, by the newest half
  struct Written {
    Panorama::Column shown, variance;
  };
  std::array<Written, frame_columns> written_{};  // of the newest half
};

}  // namespace thermorig::odometer
