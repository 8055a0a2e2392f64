// SPDX-License-Identifier: MIT
#include "start.h"

#include <cmath>
#include <utility>

namespace thermorig::odometer {

namespace {

constexpr std::size_t latest_search = 240;  // halves: then the earlier ones are forgotten
constexpr int start_work_a_step = 260;      // when halves are gone through again: one or two dozen of them
constexpr double enough_s = 25.0;           // after the first half
constexpr std::size_t enough_halves = 200, fewest_of_start = 72;
constexpr std::size_t halves_of_rest = 48;  // are kept of a longer one
constexpr double still_deg = 3.0;           // as far as a bias of the first seconds knows it
constexpr double known_bias_dps = 1.0;
constexpr Nearness settled_pass{Tracker::least_bias_sigma_dps, 0.001, 0.001};
constexpr double known_scale = 0.0008;  // one standard deviation: 0.3 degrees a turn
// After the first pass. One that still fits badly after some of them will not fit any more.
constexpr int most_repeats = 6, hopeful_repeats = 3, repeats_to_tell = 2;
// What a part of the map is taken to be off by itself. Without it a map is surer of itself than it is right.
constexpr double map_sigma_deg = 0.4;
constexpr double doubtful_nis = 1.2;  // a start that ends with more must know the scale twice as well

}  // namespace

Start::Start(const Priors& priors, const SharedLens& lens, bool latency_measured, Tracker& front,
             const TurnPath& path)
    : priors_(priors),
      lens_(lens),
      front_(front),
      path_(path),
      back_(priors, lens),
      gyro_search_(priors, lens, latency_measured) {}

void Start::begin(const std::optional<GyroHeading>& before) {
  before_ = before;
  gyro_search_.clear();
  begin_searching();
}

void Start::forget() {
  begin(std::nullopt);
  refused_scale_ = RefusedScale();
}

/// What searches have named before, of other halves, still counts.
void Start::begin_searching() {
  searched_.reset();
  is_of_later_half_ = false;
  store_.clear();
  rested_s_ = 0.0;
  mean_nis_ = 1.0;
  phase_ = Phase::searching;
}

Start::Outcome Start::add(const HalfFrame& half, double now_s) {
  store(half, now_s);
  if (is_due_to_begin()) begin_first_pass(*gyro_search_.found());
  switch (phase_) {
    case Phase::searching:
      forget_early_halves();
      return Outcome::goes_on;
    case Phase::first_pass:
      go_through(front_);
      if (gone_through_ < store_.count()) return Outcome::goes_on;
      mean_nis_ = pass_nis_;
      phase_ = Phase::learning;
      return Outcome::goes_on;
    case Phase::learning:
      learn_fit(front_.add(half, path_), mean_nis_);
      forget_rest();
      return go_on_learning(now_s);
    case Phase::second_pass:
      front_.add(half, path_);
      go_through(back_);
      return gone_through_ < store_.count() ? Outcome::goes_on : take_over(now_s);
  }
  return Outcome::goes_on;
}

/// It was put where the bias that its last pass began with had it, and by now that is known better.
double Start::origin_sigma_deg() const {
  if (!before_) return 0.0;
  const HeadingFilter& filter = front_.filter();
  const TurnPath::Knot begun = path_.until(store_.at(0).now_s);
  const double misplaced_deg =
      before_->deg(begun, begun_with_.bias_dps) - before_->deg(begun, filter.bias_dps());
  return std::hypot(before_->sigma_deg(begun, filter.sigma(HeadingFilter::bias)), misplaced_deg);
}

void Start::store(const HalfFrame& half, double now_s) {
  store_.add(half, now_s);
  if (!store_.is_full()) gyro_search_.add(store_, path_);
}

bool Start::has_halves_enough(double now_s) const {
  return store_.count() >= enough_halves || now_s - store_.at(0).now_s - rested_s_ > enough_s;
}

/// The first of the newest halves that all show one view: a rig at rest.
std::size_t Start::rests_since() const {
  const HeadingFilter& filter = front_.filter();
  const TurnPath::Knot now = path_.until(store_.at(store_.count() - 1).now_s);
  std::size_t first = store_.count() - 1;
  for (; first > 0; --first) {
    const TurnPath::Knot then = path_.until(store_.at(first - 1).now_s);
    const double read_deg = now.turned_deg - then.turned_deg;
    const double by_bias_deg = filter.bias_dps() * (now.time_s - then.time_s);
    if (std::abs(read_deg - by_bias_deg) > still_deg) break;
  }
  return first;
}

/// A rig that does not turn shows its bias and one view: all else is still to come.
void Start::forget_rest() {
  if (store_.count() % halves_of_rest != 0 || store_.is_full()) return;
  const std::size_t first = rests_since(), last = store_.count() - halves_of_rest;
  if (first + halves_of_rest > last) return;
  if (first > 0) rested_s_ += store_.at(last).now_s - store_.at(first).now_s;
  store_.forget(first, last - first);
}

std::optional<Priors> Start::find_gyro(const HalfFrame& half, double now_s) {
  store_.add(half, now_s);
  gyro_search_.add(store_, path_);
  forget_early_halves();
  return gyro_search_.found();
}

/// Those that no search will look at any more.
void Start::forget_early_halves() {
  if (store_.count() == latest_search) store_.forget(0, latest_search - GyroSearch::most_halves);
}

/// Searches name a gyro for the first time, or for the first time its scale as well, or another order of rows
/// than that of the map.
bool Start::is_due_to_begin() const {
  const auto& found = gyro_search_.found();
  if (!found || !searched_) return found.has_value();
  return (is_scale_known(*found) && !is_scale_known(*searched_)) ||
         gyro_search_.rows().order != front_.rows();
}

/// Through all halves that are kept.
void Start::begin_first_pass(const Priors& found) {
  searched_ = found;
  Priors better = found;
  if (!things_move_) better.map_sigma_deg = map_sigma_deg;
  better.heading_deg = heading_at(store_.at(0).now_s, found.bias_dps);
  mean_nis_ = 1.0;
  front_.restart(better, gyro_search_.rows().order, things_move_);
  restart_pass(0);
  phase_ = Phase::first_pass;
}

/// Through the halves again, from what was learnt of the sensors meanwhile.
void Start::begin_pass(int number) {
  begun_with_ = front_.learnt(priors_);
  if (!things_move_) begun_with_.map_sigma_deg = map_sigma_deg;  // or the map follows what moves
  begun_with_.heading_deg = heading_at(store_.at(0).now_s, begun_with_.bias_dps);
  back_.restart(begun_with_, front_.rows(), things_move_);
  if (!things_move_) back_.expect_noise_of(front_);  // what moves looks like noise
  if (front_.has_gap()) back_.expect_open_map();
  restart_pass(number);
  phase_ = Phase::second_pass;
}

void Start::restart_pass(int number) {
  pass_ = number;
  pass_nis_ = 1.0;
  innovations_ = InnovationCount();
  gone_through_ = 0;
}

void Start::go_through(Tracker& tracker) {
  for (int work = 0; work < start_work_a_step && gone_through_ < store_.count(); ++gone_through_) {
    const auto& [half, came_s] = store_.at(gone_through_);
    if (!tracker.has_begun() || came_s > tracker.now_s()) tracker.advance(path_, came_s);
    const HalfResult result = tracker.add(half, path_);
    work += result.work;
    learn_fit(result, pass_nis_);
    innovations_.add(result);
  }
}

/// With each new half, as long as no pass is made.
Start::Outcome Start::go_on_learning(double now_s) {
  if (has_halves_enough(now_s)) {
    begin_pass(pass_ + 1);
    return Outcome::goes_on;
  }
  return mean_nis_ > bounds().lost ? learn_again() : Outcome::goes_on;
}

/// The back tracker has gone through all halves that came.
Start::Outcome Start::take_over(double now_s) {
  std::swap(front_, back_);
  if (now_s > front_.now_s()) front_.advance(path_, now_s);  // the store was full before
  mean_nis_ = pass_nis_;
  const bool is_enough = has_halves_enough(now_s);
  const bool is_settled = has_settled() || (pass_ >= most_repeats && mean_nis_ < bounds().fits);
  const bool must_learn = mean_nis_ > bounds().lost || (is_enough && !is_settled);
  const bool is_made = is_enough && !must_learn;
  if (innovations_.is_false_map() && (is_made || pass_ >= repeats_to_tell)) return fail();
  if (must_learn) return learn_again();
  if (!is_made) {
    phase_ = Phase::learning;
    return Outcome::goes_on;
  }
  const double scale = front_.filter().scale_factor();
  if (!is_plausible() && !does_search_agree() && !refused_scale_.is_confirmed(scale, store_.at(0).now_s)) {
    refused_scale_.refuse(scale, now_s);
    return begin_anew();  // only other halves can confirm it
  }
  // Before faint walls only those halves tell anything that what moves is in: the map is one of it.
  if (things_move_ && innovations_.is_hardly_judged(store_.count())) return fail();
  return Outcome::over;
}

/// Each repeat fits better, unless its map is a false one, or something moves before some halves.
Start::Outcome Start::learn_again() {
  const bool is_known = is_scale_known(*searched_);  // its gyro, from the first pass on
  const bool is_hopeless = is_known && pass_ >= hopeful_repeats && mean_nis_ > bounds().unfit;
  const bool is_traffic = is_known && pass_ > 0 && shows_traffic();
  if (!is_hopeless && !is_traffic && pass_ < most_repeats &&
      front_.filter().sigma(HeadingFilter::bias) < known_bias_dps) {
    begin_pass(pass_ + 1);
  } else if (shows_traffic()) {
    things_move_ = true;  // what was learnt is not wrong for that
    begin_pass(1);
  } else {
    return fail();
  }
  return Outcome::goes_on;
}

/// Before searches have named the scale nothing has failed yet: then all halves will be gone through again.
/// Otherwise the later half of the halves, if there are enough: false maps are often begun at a high speed,
/// and the rig has turned slower since. Then those as where things move. Then new ones.
Start::Outcome Start::fail() {
  if (!is_scale_known(*searched_) && !has_halves_enough(store_.at(store_.count() - 1).now_s)) {
    phase_ = Phase::learning;
    return Outcome::goes_on;
  }
  const bool is_first = !is_of_later_half_ && store_.count() >= 2 * fewest_of_start;
  const bool is_second = is_of_later_half_ && !things_move_;
  if (is_first) {
    store_.forget(0, store_.count() / 2);
    is_of_later_half_ = true;
  } else {
    things_move_ = true;
  }
  if (!is_first && !is_second) return begin_anew();
  begin_first_pass(*gyro_search_.found());
  return Outcome::goes_on;
}

Start::Outcome Start::begin_anew() {
  begin_searching();
  return Outcome::failed;
}

bool Start::shows_traffic() const {
  const bool is_right_order = knows_rows() || has_usual_latency(front_.filter(), priors_);
  return !things_move_ && innovations_.shows_traffic() && is_plausible() && is_right_order;
}

/// By searches, which know nothing of the map, nor of how it closes; and learnt again from there.
bool Start::does_search_agree() const {
  const auto& found = gyro_search_.found();
  return found && found->scale_sigma < same_scale &&
         std::abs(found->scale - front_.filter().scale_factor()) < same_scale;
}

void Start::expect_traffic() {
  things_move_ = true;
  front_.expect_traffic();
}

/// The pass ended with what it began with: another one would make the same map.
bool Start::has_repeated() const {
  return is_near(front_.filter(), begun_with_, settled_pass);
}

/// And that map fits.
bool Start::has_settled() const {
  return has_repeated() && mean_nis_ < bounds().settled && knows_scale();
}

/// Where halves have hardly seen the map close, the scale may be another; where they fit worse than they
/// should, by more than what something that moves would explain, it has to be known twice as well.
bool Start::knows_scale() const {
  const bool fits_badly = !things_move_ && mean_nis_ > doubtful_nis && !shows_traffic();
  return (fits_badly ? 2.0 : 1.0) * front_.filter().sigma(HeadingFilter::scale) < known_scale;
}

}  // namespace thermorig::odometer
