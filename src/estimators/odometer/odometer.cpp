// SPDX-License-Identifier: MIT
#include "thermorig/estimators/odometer/odometer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "bias_evidence.h"
#include "bias_search.h"
#include "circle_search.h"
#include "gyro_heading.h"
#include "gyro_noise.h"
#include "gyro_path.h"
#include "gyro_watch.h"
#include "half_store.h"
#include "heading_trust.h"
#include "innovation_lean.h"
#include "map_check.h"
#include "pass_count.h"
#include "plausibility.h"
#include "row_contest.h"
#include "thermorig/core/gyro_delay.h"
#include "thermorig/estimators/odometer/unseen_turn.h"
#include "tracker.h"

namespace thermorig::odometer {

namespace {

constexpr HostDuration clock_begins_anew = std::chrono::seconds(1);
constexpr std::size_t search_every = 4;     // halves, while the bias is searched for
constexpr std::size_t latest_search = 160;  // then the search begins anew
constexpr int looks_a_step = 110;           // at the map, when halves are gone through again: a dozen halves
constexpr int row_looks_a_step = 60;        // the same row by row, which costs more
constexpr double second_pass_s = 25.0;      // after the first half
constexpr std::size_t second_pass_halves = 200, least_of_start = 72;
constexpr double bias_widening = 3.0;  // of what the search states
constexpr int most_passes = 6;         // through the halves of the start
constexpr double settled_latency_s = 0.001, settled_scale = 0.001;
constexpr double doubtful_nis = 1.6, hopeless_nis = 4.0;  // of the order of rows that won, and of others
constexpr double known_bias_dps = 1.0;
constexpr int passes_by_evidence = 3, passes_to_tell = 2;  // the first one may begin with a wrong bias

constexpr double longest_unfit_s = 30.0;                   // then the map is wrong
constexpr int covered_halves = 4;                          // in a row
constexpr double doubted_deg = 2.0, doubted_sigmas = 4.0;  // a jump by more is doubted
constexpr double sound_s = 5.0;  // everything fits for so long: then a heading is sound
constexpr double stepped_bias_dps = 0.3, doubtful_latency = 0.1;  // a share of what nobody expects
constexpr double turning_dps = 5.0, longest_gyro_gap_s = 0.25, longest_camera_gap_s = 1.0;
constexpr double lost_deg = 3.0;        // a heading that is known less well is searched for
constexpr double give_up_s = 40.0;      // of a search, while the rig turns: then the map is wrong
constexpr double saturated_dps = 15.0;  // what a reading at the end of its range may be off
constexpr double sample_noise_dps = 0.15;

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
        lens(std::make_shared<const Lens>(camera)),
        front(priors, lens),
        back(priors, lens),
        bias_search(priors, lens),
        bias_evidence(priors),
        contest(priors, lens, !camera.link.latency_measured_utc.empty()),
        is_contested(!lens->knows_rows()) {}

  enum class Phase : std::uint8_t { searching, first_pass, learning, second_pass, running, locating };

  Report add(const TimedFrame& frame, std::span<const TimedGyro> gyro);
  void add_gyro(const TimedGyro& sample);
  void add_half(const HalfReading& half, double now_s);
  void search_bias();
  bool is_evidence_due() const;
  bool gather_evidence();
  void begin_first_pass(const Priors& better);
  bool begin_by_evidence();
  void fail_start();
  void go_through(Tracker& tracker);
  bool is_start_over(double now_s) const;
  void begin_pass(int number);
  void take_over(double now_s);
  void begin_run(double now_s);
  bool has_settled(double bias_dps, double scale, double latency_s) const;
  bool is_plausible() const { return odometer::is_plausible(front.filter(), priors, things_move); }
  /// Not asked while the order of rows is open: the wrong one does not fit either.
  bool is_false_map() const { return !is_contested && pass_count.is_false_map(); }
  void restart_pass(int number);
  void store_half(const HalfReading& half, double now_s);
  HalfResult add_newest(const HalfReading& half);
  bool may_choose_rows() const { return !is_contested || contest.may_end(store, is_asked_again); }
  bool choose_rows();
  /// Others may have begun with a wrong bias; then the winner hardly fits, or an odd latency makes up for it.
  bool is_order_doubtful() const {
    const bool is_late = front.rows() == RowOrder::at_once && !has_usual_latency(front.filter(), priors) &&
                         row_margin < FoundRows::least_margin;
    return !lens->knows_rows() && !is_asked_again && !things_move && (is_late || mean_nis > doubtful_nis);
  }
  void ask_rows_again();
  bool is_asking_again() const { return is_contested && is_asked_again; }
  const NisBounds& nis_bounds() const { return things_move ? nis_in_traffic : nis_at_rest; }
  void learn_fit(const HalfResult& result, double& mean) const { learn_nis(result, mean, nis_bounds().most); }
  void learn_again();
  void run(const HalfReading& half);
  void locate(const HalfReading& half, double now_s);
  void follow_lean(const HalfResult& result);
  void begin_search(double now_s);
  void begin_anew();
  void begin_in_map(double now_s);
  void check_map(const HalfResult& result, const HalfReading& half);
  void keep_sound_heading(double now_s);
  std::optional<CircleSearch::Found> by_gyro() const;
  bool is_map_given_up(const HalfReading& half);
  Report report(const TimedFrame& frame, double now_s) const;
  Reason reason(double now_s) const;
  /// Where a new map begins: the heading of before, as the gyro has it with what is known of its bias by now.
  double heading_at(double time_s, double bias_dps) const {
    return sound ? sound->deg(path.until(time_s), bias_dps) : 0.0;
  }
  GyroHeading heading_of_front() const {
    return {path.until(front.now_s()), front.filter(), front.sigma_in_map_deg()};
  }
  void forget_clock();

  /// The front tracker has gone through all halves that came.
  bool is_behind_nothing() const { return phase != Phase::searching && phase != Phase::first_pass; }

  std::shared_ptr<const Map> map;  // that was made before
  MapUse map_use;
  MapCheck map_check;
  double sought_in_map_s = 0.0;  // while the rig turned
  double gyro_period_s, gyro_time_sigma_s;
  GyroNoise noise;
  Priors priors;
  Map::Lens map_lens;
  SharedLens lens;
  GyroPath path;
  GyroWatch watch;
  HalfStore store;
  bool things_move = false;  // beside the rig: a start showed it, or failed
  Tracker front, back;       // the one that is told of, and one that goes through the start again
  BiasSearch bias_search;
  BiasEvidence bias_evidence;
  bool is_by_evidence = false, is_of_later_half = false;  // what the start began with, and went through
  RowContest contest;
  bool is_contested;            // in which order rows are exposed: not where that was measured
  bool is_asked_again = false;  // with a gyro that is known: once a start
  double row_margin = 0.0;
  CircleSearch circle;

  std::optional<HostTime> origin;  // of the seconds
  HostTime last_sample{};
  double saturated_s = 0.0;
  double last_gyro_s = 0.0, last_half_s = 0.0;
  Phase phase = Phase::searching;
  std::size_t gone_through = 0;  // halves of the store
  Priors begun_with;             // of the pass
  int pass = 0;                  // through them
  double pass_nis = 1.0;         // mean_nis of the tracker that goes through them
  PassCount pass_count;
  RefusedScale refused_scale;
  double locating_since_s = 0.0;
  std::optional<GyroHeading> sound;  // none: the gyro was away since, or there was no map yet
  double sound_since_s = 0.0;
  double mean_nis = 1.0;
  int covered = 0;  // halves in a row
  HeadingTrust trust;
  std::optional<double> unfit_since_s;  // innovations are larger than they should be
  bool gyro_was_away = false;
  double expected_sigma_deg = 0.0;  // of the heading before the search
  InnovationLean lean;
  HalfResult newest;       // of the halves that were judged
  bool has_seen = false;   // a half
  bool stands_in = false;  // the newest frame, for one of a camera that is missing
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
  using Phase = Parts::Phase;
  const bool is_made = parts_->phase == Phase::running || parts_->phase == Phase::locating;
  if (!is_made || parts_->map_use == MapUse::searching || parts_->unfit_since_s) return std::nullopt;
  Map map;
  map.lens = parts_->map_lens;
  parts_->front.keep(map);
  return map;
}

MapUse Odometer::map_use() const {
  return parts_->map_use;
}

/// A sample at the end of its range says less the longer that lasts, and one that is missing nothing.
void Odometer::Parts::add_gyro(const TimedGyro& sample) {
  const HostTime time = sample.stamp.time;
  const double read_dps = double{sample.rate_dps};
  if (!(std::abs(read_dps) < largest_rate_dps)) return;
  if (!origin) origin = last_sample = time - std::chrono::milliseconds(1);
  if (time <= last_sample) {
    if (last_sample - time >= clock_begins_anew) forget_clock();
    return;
  }
  watch.add(sample);
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
  const bool is_zeroed = watch.is_zero();
  if (watch.is_frozen() && !is_zeroed) gyro_was_away = true;
  last_gyro_s = to_s(time - *origin);
  path.add(last_gyro_s, is_zeroed ? front.filter().bias_dps() : read_dps, unseen_deg2);
}

Report Odometer::Parts::add(const TimedFrame& frame, std::span<const TimedGyro> gyro) {
  for (const TimedGyro& sample : gyro) add_gyro(sample);
  if (!origin || !path.has_begun()) return {.state = State::not_trusted, .reason = Reason::no_gyro};
  const double now_s = to_s(frame.exposure_end - *origin);
  if (is_behind_nothing() && now_s > front.now_s()) front.advance(path, now_s);
  stands_in = frame.stands_in;
  if (phase == Phase::running && gyro_was_away && !watch.is_frozen()) begin_search(now_s);
  const unsigned first = frame.half[0].end <= frame.half[1].end ? 0U : 1U;
  for (const unsigned parity : {first, first ^ 1U}) {
    const auto half = half_of(frame, parity, *origin);
    if (half && half->begin_s > path.begin_s()) add_half(*half, now_s);
  }
  return report(frame, now_s);
}

void Odometer::Parts::add_half(const HalfReading& half, double now_s) {
  last_half_s = now_s;
  has_seen = true;
  switch (phase) {
    case Phase::searching:
      store_half(half, now_s);
      search_bias();
      break;
    case Phase::first_pass:
      store_half(half, now_s);
      if (gather_evidence()) break;
      go_through(front);
      if (gone_through < store.count()) break;
      mean_nis = pass_nis;
      phase = Phase::learning;
      break;
    case Phase::learning:
      store_half(half, now_s);
      gather_evidence();
      learn_fit(add_newest(half), mean_nis);
      if (is_start_over(now_s) && may_choose_rows()) {
        const bool was_settled = is_asking_again() && mean_nis < nis_bounds().unfit;
        if (!choose_rows() && was_settled)
          begin_run(now_s);
        else
          begin_pass(pass + 1);
      } else if (mean_nis > nis_bounds().lost && !is_asking_again()) {
        learn_again();
      }
      break;
    case Phase::second_pass:
      store_half(half, now_s);
      add_newest(half);
      if (gather_evidence()) break;
      go_through(back);
      if (gone_through == store.count()) take_over(now_s);
      break;
    case Phase::running:
      run(half);
      break;
    case Phase::locating:
      locate(half, now_s);
      break;
  }
}

/// What comes while the start is learnt; until it is known in which order rows are exposed, all orders learn.
void Odometer::Parts::store_half(const HalfReading& half, double now_s) {
  store.add(half, now_s);
  const bool is_searching = phase == Phase::searching && store.count() % search_every == 0;
  if (is_contested) contest.add(store, path, bias_search, is_searching || is_evidence_due());
}

HalfResult Odometer::Parts::add_newest(const HalfReading& half) {
  const HalfResult result = front.add(half, path);
  if (!lens->knows_rows() && !store.is_full()) contest.note(front.rows(), store.count() - 1, result);
  return result;
}

/// Ends the contest. True if the front tracker is another one than before, of another order.
bool Odometer::Parts::choose_rows() {
  if (!is_contested) return false;
  is_contested = false;
  const FoundRows verdict = contest.verdict();
  row_margin = verdict.margin;
  if (verdict.order == front.rows()) return false;
  mean_nis = contest.swap(verdict.order, front);
  return true;
}

/// All orders learn once more, with what is known of the gyro by now.
void Odometer::Parts::ask_rows_again() {
  is_contested = is_asked_again = true;
  contest.begin_again(front.rows(), front.learnt(priors), hopeless_nis, store);
  pass = 0;
  phase = Phase::learning;
}

void Odometer::Parts::search_bias() {
  if (store.count() > latest_search) {
    store.clear();
    contest.begin();
  }
  if (store.count() % search_every != 0 || store.count() < BiasSearch::halves) return;
  const BiasSearch::Curve curve = bias_search.measure(store, path, lens->rows(), things_move);
  if (is_evidence_due()) bias_evidence.add(curve);
  if (begin_by_evidence()) return;
  const auto found = bias_search.named(curve);
  if (!found) return;
  Priors better = priors;
  better.bias_dps = found->bias_dps;
  better.bias_sigma_dps = bias_widening * found->sigma_dps;
  better.heading_deg = heading_at(store.at(0).now_s, found->bias_dps);
  if (map_use == MapUse::searching) {
    begun_with = better;
    begin_in_map(store.at(store.count() - 1).now_s);
    return;
  }
  begin_first_pass(better);
}

void Odometer::Parts::begin_first_pass(const Priors& better) {
  front.restart(better, lens->rows(), things_move);
  restart_pass(0);
  phase = Phase::first_pass;
}

/// Halves that no other search has added. In whichever order rows are exposed: at a steady speed that only
/// shears what is seen.
bool Odometer::Parts::is_evidence_due() const {
  return map_use != MapUse::searching && !store.is_full() && store.count() % BiasSearch::halves == 0;
}

/// While a start goes on, searches go on: it may have begun with a wrong bias. True if this step searched.
bool Odometer::Parts::gather_evidence() {
  if (!is_evidence_due()) return false;
  bias_evidence.add(bias_search.measure(store, path, lens->rows(), things_move));
  return true;
}

/// Through all halves of the start, once a start. False: it was done, or evidence does not tell.
bool Odometer::Parts::begin_by_evidence() {
  const auto& found = bias_evidence.found();
  if (!found || is_by_evidence) return false;
  is_by_evidence = true;
  Priors better = *found;
  better.heading_deg = heading_at(store.at(0).now_s, found->bias_dps);
  mean_nis = 1.0;
  is_contested = !lens->knows_rows();
  is_asked_again = false;
  if (is_contested) contest.begin_again(lens->rows(), better, lost_nis, store);
  begin_first_pass(better);
  return true;
}

/// The bias is known well enough to look for the camera in the map of before.
void Odometer::Parts::begin_in_map(double now_s) {
  front.restart(begun_with, *map);
  front.advance(path, now_s);
  gyro_was_away = true;  // whatever is found, nothing was expected
  map_check.begin();
  begin_search(now_s);
}

/// A place was found in the map of before. Is it of these surroundings?
void Odometer::Parts::check_map(const HalfResult& result, const HalfReading& half) {
  map_check.add(result, front.filter().heading_deg());
  switch (map_check.verdict()) {
    case MapCheck::Verdict::open:
      break;
    case MapCheck::Verdict::same:
      // A few seconds tell less than a whole pass of the start.
      if (has_settled(2.0 * Tracker::least_bias_sigma_dps, Tracker::least_scale_sigma,
                      Tracker::least_latency_sigma_s)) {
        map_use = MapUse::found;
        front.trust_map();
        return;
      }
      begun_with = front.learnt(priors);
      sought_in_map_s = 0.0;
      begin_in_map(half.end_s);
      break;
    case MapCheck::Verdict::other:
      begin_in_map(half.end_s);
      break;
  }
  if (is_map_given_up(half)) begin_anew();
}

/// What the camera shows was sought in the map of before for long enough. A rig at rest may wait.
bool Odometer::Parts::is_map_given_up(const HalfReading& half) {
  if (std::abs(front.rate_dps()) > turning_dps) sought_in_map_s += half.end_s - half.begin_s;
  return sought_in_map_s > give_up_s;
}

bool Odometer::Parts::is_start_over(double now_s) const {
  return store.count() >= second_pass_halves || now_s - store.at(0).now_s > second_pass_s;
}

/// Through the halves of the start again, from what was learnt of the sensors meanwhile.
void Odometer::Parts::begin_pass(int number) {
  begun_with = front.learnt(priors);
  begun_with.heading_deg = heading_at(store.at(0).now_s, begun_with.bias_dps);
  back.restart(begun_with, front.rows(), things_move);
  restart_pass(number);
  phase = Phase::second_pass;
}

void Odometer::Parts::restart_pass(int number) {
  pass = number;
  pass_nis = 1.0;
  pass_count = PassCount();
  gone_through = 0;
}

/// The pass ended with what it began with, but for so much: another one would make the same map.
bool Odometer::Parts::has_settled(double bias_dps, double scale, double latency_s) const {
  const HeadingFilter& filter = front.filter();
  return mean_nis < nis_bounds().settled && std::abs(filter.bias_dps() - begun_with.bias_dps) < bias_dps &&
         std::abs(filter.scale_factor() - begun_with.scale) < scale &&
         std::abs(filter.latency_s() - begun_with.latency_s) < latency_s;
}

void Odometer::Parts::go_through(Tracker& tracker) {
  const int most_looks = tracker.rows() == RowOrder::at_once ? looks_a_step : row_looks_a_step;
  for (int looks = 0; looks < most_looks && gone_through < store.count(); ++gone_through) {
    const auto& [half, came_s] = store.at(gone_through);
    if (!tracker.has_begun() || came_s > tracker.now_s()) tracker.advance(path, came_s);
    const HalfResult result = tracker.add(half, path);
    if (!lens->knows_rows()) contest.note(tracker.rows(), gone_through, result);
    looks += result.looks;
    learn_fit(result, pass_nis);
    pass_count.add(result);
  }
}

/// The back tracker has gone through all halves that came.
void Odometer::Parts::take_over(double now_s) {
  std::swap(front, back);
  if (now_s > front.now_s()) front.advance(path, now_s);  // the store was full before
  mean_nis = pass_nis;
  const bool is_over = is_start_over(now_s) && may_choose_rows();
  if (is_over && choose_rows()) {
    begin_pass(pass + 1);
    return;
  }
  // That it fits where things may move says little.
  if (is_over && pass >= most_passes && mean_nis > nis_at_rest.fits && begin_by_evidence()) return;
  const bool is_settled = has_settled(Tracker::least_bias_sigma_dps, settled_scale, settled_latency_s) ||
                          (pass >= most_passes && mean_nis < nis_bounds().fits);
  const bool must_learn = mean_nis > nis_bounds().lost || (is_over && !is_settled);
  const bool is_made = is_over && !must_learn;
  const bool is_false = is_false_map() && (is_made || pass >= passes_to_tell);
  // Before faint walls only those halves tell anything that what moves is in: the map is one of it.
  const bool is_hardly_seen = things_move && pass_count.is_hardly_judged(store.count());
  const double scale = front.filter().scale_factor();
  const bool is_gyro_believed = is_plausible() || refused_scale.is_confirmed(scale, store.at(0).now_s);
  if (is_made && !is_false && !is_gyro_believed) refused_scale.refuse(scale, now_s);
  if (is_false || (is_made && (!is_gyro_believed || is_hardly_seen)))
    fail_start();
  else if (must_learn)
    learn_again();
  else if (is_over && is_order_doubtful())
    ask_rows_again();
  else if (is_over)
    begin_run(now_s);
  else
    phase = Phase::learning;
}

void Odometer::Parts::begin_run(double now_s) {
  phase = Phase::running;
  trust.begin(front.rate_dps());
  sound_since_s = now_s;
  sound = heading_of_front();
  lean.begin(front.rate_dps());
}

/// While the start is learnt, what does not fit means that the map was begun with a wrong bias: by now it is
/// known better. One that began by evidence had the right one, and its map is false.
void Odometer::Parts::learn_again() {
  const bool is_hopeless = is_by_evidence && pass >= passes_by_evidence && mean_nis > nis_bounds().unfit;
  if (!is_hopeless && pass < most_passes && front.filter().sigma(HeadingFilter::bias) < known_bias_dps) {
    begin_pass(pass + 1);
  } else if (is_contested && contest.another_may_fit()) {
    phase = Phase::learning;  // another order of rows may fit: it goes on until it has learnt enough
  } else if (begin_by_evidence()) {
    return;
  } else if (!things_move && pass_count.shows_traffic() && is_plausible() &&
             has_usual_latency(front.filter(), priors)) {
    things_move = true;  // what was learnt is not wrong for that
    begin_pass(1);
  } else {
    fail_start();
  }
}

/// The same halves again, if searches by now say more than the start began with; then the later half of them:
/// false maps are often begun at a high speed, and the rig has turned slower since.
void Odometer::Parts::fail_start() {
  if (is_by_evidence && !is_of_later_half && store.count() >= 2 * least_of_start) {
    store.forget_oldest(store.count() / 2);
    is_of_later_half = true;
    is_by_evidence = false;
  }
  if (!begin_by_evidence()) begin_anew();
}

void Odometer::Parts::run(const HalfReading& half) {
  if (watch.is_frozen() && !watch.is_zero()) return;
  const HalfResult result = front.add(half, path, trust.is_trusted() || map_use == MapUse::searching);
  if (map_use == MapUse::searching) {
    check_map(result, half);
    if (phase != Phase::running) return;
  }
  if (!result.is_judged) return;
  newest = result;
  covered = result.is_flat ? covered + 1 : 0;
  if (!result.is_flat) learn_fit(result, mean_nis);
  trust.add(result);
  if (result.is_used) follow_lean(result);
  if (mean_nis > nis_bounds().unfit && !unfit_since_s) unfit_since_s = half.end_s;
  if (mean_nis < nis_bounds().fits) unfit_since_s.reset();
  keep_sound_heading(half.end_s);
  if (unfit_since_s && half.end_s - *unfit_since_s > longest_unfit_s) {
    begin_anew();
    return;
  }
  const bool is_lost = mean_nis > nis_bounds().lost || front.sigma_in_map_deg() > lost_deg;
  if (!is_lost || covered >= covered_halves) return;
  map_use == MapUse::searching ? begin_in_map(half.end_s) : begin_search(half.end_s);
}

/// What a search found must first prove itself, at more than one speed.
void Odometer::Parts::keep_sound_heading(double now_s) {
  if (!trust.is_trusted() || unfit_since_s || mean_nis > nis_bounds().fits) sound_since_s = now_s;
  if (now_s - sound_since_s > sound_s && trust.has_changed_speed()) sound = heading_of_front();
}

/// Where the newest half of a search looks, if the gyro was there since the heading was sound.
std::optional<CircleSearch::Found> Odometer::Parts::by_gyro() const {
  if (!sound) return std::nullopt;
  const GyroPath::Knot now = path.until(front.now_s());
  const double off_deg = sound->deg(now) - front.filter().heading_deg();
  return CircleSearch::Found{front.located_deg() + off_deg, sound->sigma_deg(now)};
}

/// Innovations that lean: the bias is another, or, if all had fitted at another speed, an odd latency.
/// Where things move the rig may only turn with a person: that is said, and nothing written meanwhile.
void Odometer::Parts::follow_lean(const HalfResult& result) {
  lean.add(result);
  if (!lean.is_much(things_move)) return;
  const double odd_latency_s = front.filter().latency_s() - priors.latency_s;
  const bool is_late = trust.is_trusted() && !unfit_since_s && lean.came_with_other_speed(result.rate_dps);
  if (things_move)
    trust.doubt_lean();
  else
    front.widen(stepped_bias_dps, is_late ? doubtful_latency * odd_latency_s : 0.0);
  lean.forget();
}

void Odometer::Parts::begin_search(double now_s) {
  if (gyro_was_away) sound.reset();
  expected_sigma_deg = front.sigma_in_map_deg();
  gyro_was_away = false;
  circle.begin();
  locating_since_s = now_s;
  phase = Phase::locating;
}

void Odometer::Parts::locate(const HalfReading& half, double now_s) {
  front.locate(half, path, circle);
  if (const auto found = circle.found(by_gyro())) {
    const double jump_deg = front.settle(*found);
    const bool gyro_differs = sound && std::abs(jump_deg) > doubted_deg + doubted_sigmas * expected_sigma_deg;
    trust.begin_after_search(front.rate_dps(), gyro_differs);
    mean_nis = 1.0;
    lean.begin(front.rate_dps());
    unfit_since_s.reset();
    phase = Phase::running;
  } else if (map_use == MapUse::searching ? is_map_given_up(half) : now_s - locating_since_s > give_up_s) {
    begin_anew();
  }
}

void Odometer::Parts::forget_clock() {
  begin_anew();
  bias_evidence.clear();
  refused_scale = RefusedScale();
  sound.reset();
  path.clear();
  watch = GyroWatch();
  origin.reset();
  front.restart(priors);
}

void Odometer::Parts::begin_anew() {
  const bool is_in_doubt = map_use == MapUse::searching;
  if (is_in_doubt || map_use == MapUse::found) map_use = MapUse::other;
  const bool has_tracked = phase == Phase::running || phase == Phase::locating;
  if (!has_tracked) things_move = true;
  if (is_in_doubt)
    sound.reset();
  else if (has_tracked && !sound)
    sound = heading_of_front();
  if (has_tracked) bias_evidence.clear();
  is_by_evidence = is_of_later_half = false;
  store.clear();
  contest.begin();
  is_contested = !lens->knows_rows();
  is_asked_again = false;
  mean_nis = 1.0;
  covered = 0;
  trust = HeadingTrust();
  unfit_since_s.reset();
  gyro_was_away = false;
  phase = Phase::searching;
}

Reason Odometer::Parts::reason(double now_s) const {
  if (now_s - last_gyro_s > longest_gyro_gap_s) return Reason::no_gyro;
  if (stands_in || !has_seen || now_s - last_half_s > longest_camera_gap_s) return Reason::no_camera;
  if (watch.is_frozen() && !watch.is_zero()) return Reason::gyro_frozen;
  if (covered >= covered_halves || unfit_since_s) return Reason::view_differs;
  return Reason::none;
}

Report Odometer::Parts::report(const TimedFrame& frame, double now_s) const {
  const HeadingFilter& filter = front.filter();
  Report report;
  report.reason = reason(now_s);
  if (report.reason != Reason::none)
    report.state = State::not_trusted;
  else if (map_use == MapUse::searching || phase == Phase::locating ||
           (phase == Phase::running && !trust.is_trusted()))
    report.state = State::relocalising;
  else
    report.state = phase == Phase::running ? State::tracking : State::starting;
  report.bias_dps = filter.bias_dps();
  report.scale = filter.scale_factor();
  report.latency_s = filter.latency_s();
  report.mean_nis = mean_nis;
  if (newest.is_judged) {
    report.innovation_deg = newest.innovation_deg;
    report.innovation_sigma_deg = newest.sigma_deg;
  }
  report.rows = front.rows();
  report.row_margin = row_margin;
  if (is_behind_nothing()) report.heading_deg = filter.heading_deg();
  if (is_behind_nothing()) report.origin_sigma_deg = filter.sigma(HeadingFilter::heading);
  const double begin_s = to_s(frame.exposure_begin - *origin), length_s = now_s - begin_s;
  if (!(length_s > 0.0)) return report;
  const ExposedTurn turn = path.over(begin_s, now_s);
  const double samples = std::max(1.0, length_s / gyro_period_s);
  report.rate_dps = filter.mean_rate_dps(turn);
  report.rate_sigma_dps =
      std::hypot(std::hypot(filter.sigma(HeadingFilter::bias), sample_noise_dps / std::sqrt(samples)) /
                     filter.scale_factor(),
                 filter.sigma(HeadingFilter::scale) * report.rate_dps,
                 gyro_time_sigma_s * (turn.last_dps - turn.first_dps) / length_s);
  // No image tells how late the gyro is: what it says of now, it says of then.
  if (is_behind_nothing())
    report.heading_sigma_deg = std::hypot(front.sigma_in_map_deg(), gyro_time_sigma_s * report.rate_dps);
  return report;
}

}  // namespace thermorig::odometer
