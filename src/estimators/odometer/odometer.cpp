// SPDX-License-Identifier: MIT
#include "thermorig/estimators/odometer/odometer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "circle_search.h"
#include "gyro_noise.h"
#include "heading_trust.h"
#include "innovations.h"
#include "start.h"
#include "thermorig/core/auto_zero.h"
#include "thermorig/core/gyro_delay.h"
#include "thermorig/core/surroundings/turn_path.h"
#include "tracker.h"

namespace thermorig::odometer {

namespace {

constexpr HostDuration clock_begins_anew = std::chrono::seconds(1);
constexpr HostDuration longest_repeat = std::chrono::milliseconds(300);  // of one reading, bit by bit
constexpr double longest_unfit_s = 30.0;  // then the map is wrong, unless pixels fit it:
constexpr double most_misfit = 1.5;       // 1.1 where times alone jump, 3.4 where walls have changed
constexpr int covered_halves = 4;         // in a row
constexpr double doubted_sigmas = 2.0;    // a heading that is off what the gyro says by more is doubted
constexpr double good_after_s = 5.0;      // everything fits for so long: then a heading is good
constexpr double stepped_bias_dps = 0.3, doubtful_latency = 0.1;  // a share of what nobody expects
constexpr double turning_dps = 5.0, longest_gyro_gap_s = 0.25, longest_camera_gap_s = 1.0;
constexpr double longest_by_gyro_s = 3.0;  // a start that ended later has yet to prove its heading
constexpr double lost_deg = 3.0;           // a heading that is known less well is searched for
constexpr double give_up_s = 40.0;         // of a search, while the rig turns: then the map is wrong
// Until a map of before has shown it: three seconds may name a bias that is far off, and a camera may be
// later than any data sheet says.
constexpr double bias_sigma_in_map_dps = 6.0, latency_sigma_in_map_s = 0.03;
constexpr int most_counted = 480;          // halves: a minute
constexpr double most_other_views = 0.6;   // share of them: then the surroundings are others
constexpr double usual_other_views = 0.1;  // above it the surroundings may be others
const double anywhere_deg = whole_turn_deg / std::sqrt(12.0);  // one standard deviation of any direction
constexpr double saturated_dps = 15.0;  // what a reading at the end of its range may be off
constexpr double sample_noise_dps = 0.15;

/// What profiles say of both sensors, before anything was measured.
Priors priors_of(const GyroProfile& gyro, const CameraProfile& camera) {
  Priors priors;
  priors.bias_dps = gyro.bias_dps;
  priors.bias_sigma_dps = gyro.later_bias_sigma_dps();
  priors.scale = gyro.scale;
  priors.scale_sigma = std::max(0.002, gyro.scale_uncertainty);
  priors.latency_sigma_s =
      std::hypot(0.002, gyro.link.latency_uncertainty_s, camera.link.latency_uncertainty_s);
  return priors;
}

}  // namespace

struct Odometer::Parts {
  Parts(const GyroProfile& gyro, const CameraProfile& camera, std::shared_ptr<const Map> given)
      : map(std::move(given)),
        map_use(map ? MapUse::searching : MapUse::none),
        gyro_period_s(1.0 / gyro.output_rate_hz),
        gyro_time_sigma_s(time_uncertainty_s(gyro)),
        noise(gyro.axis),
        priors(priors_of(gyro, camera)),
        map_lens(camera),
        lens_share(camera.pitch_scale_uncertainty),
        lens(std::make_shared<const Lens>(camera)),
        front(priors, lens),
        start(priors, lens, !camera.link.latency_measured_utc.empty(), front, path) {}

  /// `starting`: Start makes a map; `running`: half-frames are registered against it; `locating`: the heading
  /// is lost, or not known yet in a map that was loaded, and searched for on the whole circle.
  enum class Phase : std::uint8_t { starting, running, locating };

  Report add(const TimedFrame& frame, std::span<const TimedGyro> gyro);
  void add_gyro(const TimedGyro& sample);
  void add_half(const HalfFrame& half, double now_s);
  void start_anywhere(const HalfFrame& half, double now_s);
  void start_in_map(const HalfFrame& half, double now_s);
  const NisBounds& nis_bounds() const { return odometer::nis_bounds(start.things_move()); }
  void run(const HalfFrame& half);
  void locate(const HalfFrame& half, double now_s);
  void follow_mean_innovation(const HalfResult& result, double now_s);
  void count_innovation(const HalfResult& result);
  void watch_for_cover(const HalfResult& result, bool is_on_trial);
  bool is_covered() const { return covered >= covered_halves; }
  void watch_for_traffic();
  bool is_map_right() const;
  void begin_search(double now_s);
  void begin_anew();
  void begin_in_map(double now_s);
  void check_map(const HalfResult& result, double now_s);
  void prove_map();
  void keep_good_heading(const HalfResult& result, double now_s);
  std::optional<CircleSearch::Found> by_gyro() const;
  bool does_gyro_differ() const;
  bool is_map_given_up(const HalfFrame& half);
  Report report(const TimedFrame& frame, double now_s) const;
  EstimateReason reason(double now_s) const;
  Priors known_of_gyro() const;
  struct MapDegree {
    double length = 1.0, sigma = 0.0;  // in true degrees
  };
  MapDegree map_degree(const Priors& gyro) const;
  GyroHeading heading_of_front() const {
    return {path.until(front.now_s()), front.filter(), front.sigma_in_map_deg()};
  }
  void forget_clock();

  bool is_gyro_frozen() const { return repeated.lasts(longest_repeat) && !repeated.is_zero(); }
  bool has_heading() const { return phase != Phase::starting || start.has_caught_up(); }

  std::shared_ptr<const Map> map;  // that was made before
  MapUse map_use;
  MapCheck map_check;
  bool has_place = false;        // in it; the gyro has yet to prove itself
  double sought_in_map_s = 0.0;  // while the rig turned
  double gyro_period_s, gyro_time_sigma_s;
  GyroNoise noise;
  Priors priors;
  Priors sought_with = priors;  // in the map of before
  Map::Lens map_lens;
  FoundRows rows;     // by the last start that ended
  double lens_share;  // one standard deviation: of all angles that rest on the lens alone
  SharedLens lens;
  TurnPath path;
  RepeatedReading repeated;
  Tracker front;  // its estimate is reported
  Start start;
  CircleSearch circle;

  std::optional<HostTime> origin;  // of the seconds
  HostTime last_sample{};
  double saturated_s = 0.0;
  double last_gyro_s = 0.0, last_half_s = 0.0;
  Phase phase = Phase::starting;
  double locating_since_s = 0.0;
  double origin_sigma_deg = 0.0;                 // of where the map begins, against the first one
  std::optional<GyroHeading> last_good;          // none: the gyro was away since, or there was no map yet
  double good_since_s = 0.0, last_used_s = 0.0;  // by half
  double mean_nis = 1.0;
  int covered = 0;  // halves in a row
  double other_views =
      0.0;  // a running mean: the share of halves that fit neither the map nor a covered lens
  HeadingTrust trust;
  std::optional<double> unfit_since_s;  // innovations are larger than they should be
  bool gyro_was_away = false;
  MeanInnovation mean_innovation;
  double mean_misfit = 1.0;     // of the pixels of a minute's halves
  InnovationCount innovations;  // since the start, or since the heading was another
  HalfResult newest;            // of the halves that were judged
  bool has_seen = false;        // a half
  bool stands_in = false;       // the newest frame, for one of a camera that is missing
};

Odometer::Odometer(const GyroProfile& gyro, const CameraProfile& camera, std::shared_ptr<const Map> map)
    : parts_(std::make_unique<Parts>(gyro, camera, std::move(map))) {}
Odometer::~Odometer() = default;
Odometer::Odometer(Odometer&&) noexcept = default;
Odometer& Odometer::operator=(Odometer&&) noexcept = default;

Report Odometer::add(const TimedFrame& frame, std::span<const TimedGyro> gyro) {
  return parts_->add(frame, gyro);
}

std::vector<float> Odometer::map_image_c() const {
  return parts_->front.map_image_c();
}

std::optional<Map> Odometer::map() const {
  const bool is_made = parts_->phase != Parts::Phase::starting;
  if (!is_made || parts_->map_use == MapUse::searching || parts_->unfit_since_s) return std::nullopt;
  Map map;
  map.lens = parts_->map_lens;
  parts_->front.keep(map);
  return map;
}

MapUse Odometer::map_use() const {
  return parts_->map_use;
}

const FoundRows& Odometer::rows() const {
  return parts_->rows;
}

/// A sample at the end of its range says less the longer that lasts, and one that is missing nothing.
void Odometer::Parts::add_gyro(const TimedGyro& sample) {
  const HostTime time = sample.stamp.time;
  const double read_dps = double{sample.rate_dps};
  if (!is_rate(sample.rate_dps)) return;
  if (!origin) origin = last_sample = time - std::chrono::milliseconds(1);
  if (time <= last_sample) {
    if (last_sample - time >= clock_begins_anew) forget_clock();
    return;
  }
  repeated.add(sample.reading, time);
  const double step_s = path.has_begun() ? to_s(time - last_sample) : 0.0;
  last_sample = time;
  const double unseen = unseen_deg(lost_s(step_s, gyro_period_s));
  noise.add(sample, step_s);
  double unseen_deg2 =
      unseen * unseen + std::max(0.0, noise.walk_deg2() - square(HeadingFilter::walk_deg)) * step_s;
  saturated_s = sample.reading.saturated ? saturated_s + step_s : 0.0;
  unseen_deg2 += 2.0 * saturated_dps * saturated_dps * saturated_s * step_s;
  if (lost_s(step_s, gyro_period_s) > longest_gyro_gap_s) gyro_was_away = true;
  // One that sets itself to zero at rest has taken its bias off, with the first such sample.
  const bool is_zeroed = repeated.is_zero();
  if (is_gyro_frozen()) gyro_was_away = true;
  last_gyro_s = to_s(time - *origin);
  path.add(last_gyro_s, is_zeroed ? front.filter().bias_dps() : read_dps, unseen_deg2);
}

Report Odometer::Parts::add(const TimedFrame& frame, std::span<const TimedGyro> gyro) {
  for (const TimedGyro& sample : gyro) add_gyro(sample);
  if (!origin || !path.has_begun())
    return {.state = EstimateState::not_trusted, .reason = EstimateReason::no_gyro};
  const double now_s = to_s(frame.exposure_end - *origin);
  if (has_heading() && now_s > front.now_s()) front.advance(path, now_s);
  stands_in = frame.stands_in;
  if (phase == Phase::running && gyro_was_away && !repeated.lasts(longest_repeat)) begin_search(now_s);
  for (const unsigned parity : frame.halves_by_time()) {
    const auto half = half_of(frame, parity, *origin);
    if (half && half->begin_s > path.begin_s()) add_half(*half, now_s);
  }
  return report(frame, now_s);
}

void Odometer::Parts::add_half(const HalfFrame& half, double now_s) {
  last_half_s = now_s;
  has_seen = true;
  switch (phase) {
    case Phase::starting:
      map_use == MapUse::searching ? start_in_map(half, now_s) : start_anywhere(half, now_s);
      break;
    case Phase::running:
      run(half);
      break;
    case Phase::locating:
      locate(half, now_s);
      break;
  }
}

void Odometer::Parts::start_anywhere(const HalfFrame& half, double now_s) {
  switch (start.add(half, now_s)) {
    case Start::Outcome::goes_on:
      break;
    case Start::Outcome::failed:
      gyro_was_away = false;
      break;
    case Start::Outcome::over:
      phase = Phase::running;
      rows = {front.rows(), start.row_margin()};
      origin_sigma_deg = std::hypot(origin_sigma_deg, start.origin_sigma_deg());
      front.end_learning();
      mean_nis = start.mean_nis();
      if (start.by_gyro_s(now_s) <= longest_by_gyro_s)
        trust.begin(front.rate_dps());
      else
        trust.begin_unproven(front.rate_dps(), false);
      good_since_s = now_s;
      last_good = heading_of_front();
      mean_innovation.begin(front.rate_dps());
      innovations = InnovationCount();
      break;
  }
}

void Odometer::Parts::start_in_map(const HalfFrame& half, double now_s) {
  const auto better = start.find_gyro(half, now_s);
  if (!better) return;
  sought_with = *better;
  sought_with.bias_sigma_dps = std::max(sought_with.bias_sigma_dps, bias_sigma_in_map_dps);
  sought_with.latency_sigma_s = std::max(sought_with.latency_sigma_s, latency_sigma_in_map_s);
  begin_in_map(now_s);
}

/// The bias is known well enough to look for the camera in the map of before.
void Odometer::Parts::begin_in_map(double now_s) {
  front.restart(sought_with, *map);
  front.advance(path, now_s);
  gyro_was_away = true;  // whatever is found, nothing was expected
  map_check.begin();
  has_place = false;
  begin_search(now_s);
}

/// A place was found in the map of before. Is it of these surroundings? At one speed a bias, a scale and a
/// latency explain each other: then halves have to fit at another speed too.
void Odometer::Parts::check_map(const HalfResult& result, double now_s) {
  if (has_place) return prove_map();
  map_check.add(result, front.filter().heading_deg());
  switch (map_check.verdict()) {
    case MapCheck::Verdict::open:
      break;
    case MapCheck::Verdict::same:
      sought_with.bias_dps = front.filter().bias_dps();  // by what the map says of how it turned
      sought_in_map_s = 0.0;
      has_place = true;
      front.trust_map();
      trust.begin_in_map(front.rate_dps());
      break;
    case MapCheck::Verdict::other:
      begin_in_map(now_s);
      break;
  }
}

void Odometer::Parts::prove_map() {
  if (!trust.is_trusted() || mean_nis > nis_bounds().settled) return;
  map_use = MapUse::found;
  innovations = InnovationCount();
}

/// What the camera shows was sought in the map of before for long enough. A rig at rest may wait.
bool Odometer::Parts::is_map_given_up(const HalfFrame& half) {
  if (std::abs(front.rate_dps()) > turning_dps) sought_in_map_s += half.end_s - half.begin_s;
  return sought_in_map_s > give_up_s;
}

void Odometer::Parts::run(const HalfFrame& half) {
  if (is_gyro_frozen()) return;
  const bool is_on_trial = map_use == MapUse::searching;
  const HalfResult result = front.add(half, path, trust.is_trusted() && !is_on_trial);
  if (is_on_trial && !has_place && is_map_given_up(half)) return begin_anew();
  if (!result.is_judged) return;
  newest = result;
  watch_for_cover(result, is_on_trial);
  if (!result.is_flat) count_innovation(result);
  trust.add(result);
  if (is_on_trial) check_map(result, half.end_s);
  if (phase != Phase::running) return;
  if (result.is_used && !is_on_trial) follow_mean_innovation(result, half.end_s);
  mean_misfit += (result.misfit - mean_misfit) / most_counted;
  if (mean_nis > nis_bounds().unfit && !unfit_since_s) unfit_since_s = half.end_s;
  if (mean_nis < nis_bounds().fits && unfit_since_s) {
    unfit_since_s.reset();
    watch_for_traffic();
  }
  keep_good_heading(result, half.end_s);
  const bool is_unfit = unfit_since_s && half.end_s - *unfit_since_s > longest_unfit_s;
  if ((is_unfit && !is_map_right()) || other_views > most_other_views) {
    begin_anew();
    return;
  }
  const bool is_lost = mean_nis > nis_bounds().lost || front.sigma_in_map_deg() > lost_deg;
  if (!is_lost || is_covered()) return;
  map_use == MapUse::searching ? begin_in_map(half.end_s) : begin_search(half.end_s);
}

/// In another place of a map that is on trial a flat picture may fit better too, but it does not fit. Other
/// walls look like a cover now and then, and fit for a moment after it: that has to prove itself.
void Odometer::Parts::watch_for_cover(const HalfResult& result, bool is_on_trial) {
  const bool was_covered = is_covered();
  covered = result.is_flat && !(is_on_trial && result.is_other_view) ? covered + 1 : 0;
  other_views += ((result.is_other_view ? 1.0 : 0.0) - other_views) / most_counted;
  if (was_covered && !is_covered() && !is_on_trial && other_views > usual_other_views)
    trust.begin_unproven(front.rate_dps(), does_gyro_differ());
}

/// It was there since a heading was good, and has the rig elsewhere.
bool Odometer::Parts::does_gyro_differ() const {
  const auto expected = by_gyro();
  return expected && std::abs(expected->sigmas_to(front.filter().heading_deg())) > doubted_sigmas;
}

/// What a search found must first prove itself, at more than one speed; and what the gyro alone has carried
/// past images that say nothing, past a covered lens say, is no better known than before them.
void Odometer::Parts::keep_good_heading(const HalfResult& result, double now_s) {
  if (!result.is_used) return;
  const bool was_alone = now_s - last_used_s > longest_camera_gap_s;
  last_used_s = now_s;
  if (was_alone || !trust.is_trusted() || unfit_since_s || mean_nis > nis_bounds().fits) good_since_s = now_s;
  if (now_s - good_since_s > good_after_s && trust.has_changed_speed()) last_good = heading_of_front();
}

/// The heading, if the gyro was there since one was good.
std::optional<CircleSearch::Found> Odometer::Parts::by_gyro() const {
  if (!last_good) return std::nullopt;
  const TurnPath::Knot now = path.until(front.now_s());
  return CircleSearch::Found{last_good->deg(now), last_good->sigma_deg(now)};
}

void Odometer::Parts::count_innovation(const HalfResult& result) {
  learn_nis(result, mean_nis, nis_bounds().most);
  if (innovations.judged() >= most_counted) innovations.forget_half();
  innovations.add(result);
}

/// Halves fit again, after some that did not, where the heading was right all the time. A start can be over
/// before anyone comes.
void Odometer::Parts::watch_for_traffic() {
  if (start.things_move() || map_use == MapUse::searching) return;
  if (innovations.shows_traffic_after_start()) start.expect_traffic();
}

/// Halves have not been where they were expected for long, and yet their pixels fit the map, and the gyro has
/// the rig where most of them have it: their times jump, say, and another map would fit no better.
bool Odometer::Parts::is_map_right() const {
  return last_good && !does_gyro_differ() && mean_misfit < most_misfit && !innovations.is_false_map();
}

/// Innovations to one side: the bias is another, or, if all had fitted at another speed, an odd latency.
/// Where things move the rig may only turn with a person: that is said, and nothing written meanwhile.
void Odometer::Parts::follow_mean_innovation(const HalfResult& result, double now_s) {
  mean_innovation.add(result);
  if (!mean_innovation.is_one_sided(start.things_move())) return;
  const double odd_latency_s = front.filter().latency_s() - priors.latency_s;
  const bool is_late =
      trust.is_trusted() && !unfit_since_s && mean_innovation.came_with_other_speed(result.rate_dps);
  if (start.things_move())
    trust.doubt_one_sided();
  else
    front.widen(stepped_bias_dps, is_late ? doubtful_latency * odd_latency_s : 0.0);
  good_since_s = now_s;
  mean_innovation.forget();
}

void Odometer::Parts::begin_search(double now_s) {
  if (gyro_was_away) last_good.reset();
  gyro_was_away = false;
  circle.begin();
  locating_since_s = now_s;
  phase = Phase::locating;
}

void Odometer::Parts::locate(const HalfFrame& half, double now_s) {
  front.locate(half, path, circle);
  auto expected = by_gyro();  // where the newest half looks, which may have ended before now
  if (expected) expected->azimuth_deg += front.located_deg() - front.filter().heading_deg();
  if (const auto found = circle.found(expected)) {
    front.settle(*found);
    const bool gyro_differs = expected && std::abs(expected->sigmas_to(found->azimuth_deg)) > doubted_sigmas;
    trust.begin_unproven(front.rate_dps(), gyro_differs);
    mean_nis = 1.0;
    mean_innovation.begin(front.rate_dps());
    unfit_since_s.reset();
    phase = Phase::running;
    if (!last_good || gyro_differs)
      innovations = InnovationCount();
    else
      watch_for_traffic();
  } else if (map_use == MapUse::searching ? is_map_given_up(half) : now_s - locating_since_s > give_up_s) {
    begin_anew();
  }
}

void Odometer::Parts::forget_clock() {
  begin_anew();
  start.forget();
  last_good.reset();
  origin_sigma_deg = 0.0;
  path.clear();
  repeated = RepeatedReading();
  origin.reset();
  front.restart(priors);
}

void Odometer::Parts::begin_anew() {
  const bool is_in_doubt = map_use == MapUse::searching;
  if (is_in_doubt || map_use == MapUse::found) map_use = MapUse::other;
  if (is_in_doubt)
    last_good.reset();
  else if (phase != Phase::starting && !last_good)
    last_good = heading_of_front();
  if (const auto expected = by_gyro()) {
    const MapDegree degree = map_degree(known_of_gyro());
    const double begun_deg = front.filter().begun_deg();
    origin_sigma_deg = std::hypot(origin_sigma_deg, degree.sigma * (expected->azimuth_deg - begun_deg));
    last_good = last_good->stretched(degree.length, begun_deg);
  } else {
    origin_sigma_deg = 0.0;  // the heading has another origin from here on
  }
  start.begin(last_good);
  mean_nis = mean_misfit = 1.0;
  covered = 0;
  other_views = 0.0;
  trust = HeadingTrust();
  unfit_since_s.reset();
  gyro_was_away = false;
  phase = Phase::starting;
}

EstimateReason Odometer::Parts::reason(double now_s) const {
  if (now_s - last_gyro_s > longest_gyro_gap_s) return EstimateReason::no_gyro;
  if (stands_in || !has_seen || now_s - last_half_s > longest_camera_gap_s) return EstimateReason::no_image;
  if (is_gyro_frozen()) return EstimateReason::gyro_frozen;
  if (map_use == MapUse::searching)
    return EstimateReason::none;  // another place is found, where another view fits
  return is_covered() || unfit_since_s ? EstimateReason::view_differs : EstimateReason::none;
}

/// Bias, scale and latency. A map on trial may have the camera look where it does not, and then teaches the
/// filter another gyro: meanwhile what was known before it stands.
Priors Odometer::Parts::known_of_gyro() const {
  if (map_use == MapUse::searching) return sought_with;
  const HeadingFilter& filter = front.filter();
  Priors known = priors;
  known.bias_dps = filter.bias_dps();
  known.bias_sigma_dps = filter.sigma(HeadingFilter::bias);
  known.scale = filter.scale_factor();
  known.scale_sigma = filter.sigma(HeadingFilter::scale);
  known.latency_s = filter.latency_s();
  return known;
}

/// Until a map has closed its degrees are as long as the lens makes them, which may be off, and the
/// gyro's scale was learnt in the same degrees: what the profile says of the one is weighed against what it
/// says of the other.
Odometer::Parts::MapDegree Odometer::Parts::map_degree(const Priors& gyro) const {
  if (!front.has_gap() || !(lens_share > 0.0)) return {};
  const double by_gyro2 = (square(priors.scale_sigma) + square(gyro.scale_sigma)) / square(priors.scale);
  const double weight = square(lens_share) / (square(lens_share) + by_gyro2);
  return {1.0 + weight * (gyro.scale / priors.scale - 1.0), std::sqrt(weight * by_gyro2)};
}

Report Odometer::Parts::report(const TimedFrame& frame, double now_s) const {
  const HeadingFilter& filter = front.filter();
  Report report;
  report.reason = reason(now_s);
  if (report.reason != EstimateReason::none)
    report.state = EstimateState::not_trusted;
  else if (map_use == MapUse::searching || phase == Phase::locating ||
           (phase == Phase::running && !trust.is_trusted()))
    report.state = EstimateState::relocalising;
  else
    report.state = phase == Phase::running ? EstimateState::good : EstimateState::starting;
  Priors gyro = known_of_gyro();
  const MapDegree degree = map_degree(gyro);
  gyro.scale /= degree.length;
  report.bias_dps = gyro.bias_dps;
  report.scale = gyro.scale;
  report.latency_s = gyro.latency_s;
  report.mean_nis = phase == Phase::starting ? start.mean_nis() : mean_nis;
  if (newest.is_judged) {
    report.innovation_deg = newest.innovation_deg;
    report.innovation_sigma_deg = newest.sigma_deg;
  }
  report.rows = rows.order;
  report.row_margin = rows.margin;
  const double since_begun_deg = filter.heading_deg() - filter.begun_deg();
  if (has_heading()) report.heading_deg = filter.begun_deg() + degree.length * since_begun_deg;
  const double begin_s = to_s(frame.exposure_begin - *origin), length_s = now_s - begin_s;
  if (!(length_s > 0.0)) return report;
  const ExposedTurn turn = path.over(begin_s, now_s);
  const double samples = std::max(1.0, length_s / gyro_period_s);
  report.rate_dps = (turn.mean_read_dps() - gyro.bias_dps) / gyro.scale;
  report.rate_sigma_dps =
      std::hypot(std::hypot(gyro.bias_sigma_dps, sample_noise_dps / std::sqrt(samples)) / gyro.scale,
                 std::hypot(gyro.scale_sigma, degree.sigma) * report.rate_dps,
                 gyro_time_sigma_s * (turn.last_dps - turn.first_dps) / length_s);
  if (!has_heading()) return report;
  // No image shows how late the gyro is: what it says of now, it says of then.
  report.heading_sigma_deg = std::hypot(front.sigma_in_map_deg(), gyro_time_sigma_s * report.rate_dps,
                                        std::hypot(origin_sigma_deg, degree.sigma * since_begun_deg));
  // Halves that do not fit may drag the heading: then it is no surer than the gyro is, from a good one on.
  const bool is_doubted =
      report.reason == EstimateReason::view_differs || report.state == EstimateState::relocalising;
  const auto expected = is_doubted ? by_gyro() : std::nullopt;
  if (expected)
    report.heading_sigma_deg = std::hypot(report.heading_sigma_deg, expected->sigma_deg,
                                          filter.heading_deg() - expected->azimuth_deg);
  if (map_use == MapUse::searching) report.heading_sigma_deg = anywhere_deg;
  return report;
}

}  // namespace thermorig::odometer
