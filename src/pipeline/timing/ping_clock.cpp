// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/ping_clock.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace thermorig::timing {
namespace {

// So many messages that agree with each other outvote the clock so far.
constexpr std::size_t agreeing_for_epoch = 3;

// More than the wire times of a ping and its answer at any baud rate in use: a wrong baud rate cannot shift
// bounds further.
constexpr double baud_error_s = 0.005;

constexpr double shortest_suspension_s = 0.5;  // of a host: it stops and starts its devices

constexpr std::size_t most_remembered = 20'000;  // bounds of a minute; ten times what a servo sends
constexpr int most_failed_searches = 50;         // of an epoch: bytes that nobody sent may ask for any number

}  // namespace

std::string duration_text(double seconds) {
  std::array<char, 48> text{};
  if (seconds < 1.0)
    std::snprintf(text.data(), text.size(), "%.2f ms", seconds * 1e3);
  else
    std::snprintf(text.data(), text.size(), "%.1f s", seconds);
  return text.data();
}

std::string contradiction_reason(double missed_s, const PortProfile& link) {
  std::array<char, 32> ppm{};
  std::snprintf(ppm.data(), ppm.size(), "%g", 1e6 * largest_wander);
  const std::string baud = link.baud == 0 ? "" : "a baud rate other than " + std::to_string(link.baud) + ", ";
  return "bounds contradict each other by " + duration_text(missed_s) + ": " + baud +
         "or one of the two clocks jumped, or wanders by more than " + ppm.data() + " ppm within a minute";
}

PingClock::PingClock(const PortProfile& link)
    : link_(link), wander_(std::max(wander_of(link), least_wander)) {}

void PingClock::feed(const PingBound& bound) {
  if (bound.two_sided && bound.send_us < bound.receive_us) return;
  if (!current_) {
    epochs_.push_back({bound.not_after, ""});
    first_bounds_.push_back(fed_);
    current_.emplace(bound, wander_);
    remember(bound);
    follow_surely();
    ++fed_;
    return;
  }
  PingFate fate = current_->fate(bound);
  if (fate == PingFate::faster_than_wire) return impossible(bound);
  if (fate != PingFate::fits && wanders_more(bound, fate)) fate = PingFate::fits;
  doubted_ = fate != PingFate::fits;
  if (doubted_)
    doubt(bound, fate);
  else
    trust(bound);
  ++fed_;
}

/// The clock of the last minute and `bound`, or none where it does not explain them.
std::optional<PingBounds> PingClock::followed(const PingBound& bound, double wander) const {
  PingBounds bounds(recent_.front(), wander);
  for (std::size_t i = 1; i < recent_.size(); ++i) {
    if (bounds.fate(recent_[i]) != PingFate::fits) return std::nullopt;
    bounds.take(recent_[i]);
  }
  const bool is_lost = current_->two_sided() && !bounds.two_sided();
  if (is_lost || bounds.fate(bound) != PingFate::fits) return std::nullopt;
  return bounds;
}

/// Whether a larger wander explains `bound`. If so the clock is followed anew with twice the least that does.
bool PingClock::wanders_more(const PingBound& bound, PingFate fate) {
  if (fate == PingFate::went_back || wander_ >= largest_wander) return false;
  if (failed_searches_ >= most_failed_searches) return false;
  if (current_->missed_by_s(bound) > largest_wander * rate_window_s || !followed(bound, largest_wander)) {
    ++failed_searches_;
    return false;
  }
  double least = wander_;
  while (least < largest_wander && !followed(bound, least)) least *= 2.0;
  wander_ = std::min(2.0 * least, largest_wander);
  std::optional<PingBounds> wider = followed(bound, wander_);
  current_ = wider ? std::move(wider) : followed(bound, largest_wander);
  follow_surely();
  return true;
}

void PingClock::follow_surely() {
  sure_.emplace(recent_.front(), wander_, RateNow::may_differ);
  for (std::size_t i = 1; i < recent_.size(); ++i) sure_->take(recent_[i]);
}

void PingClock::remember(const PingBound& bound) {
  recent_.push_back(bound);
  while (recent_.size() > most_remembered ||
         seconds_between(recent_.front().send_us, bound.send_us) > rate_window_s)
    recent_.pop_front();
}

void PingClock::trust(const PingBound& bound) {
  current_->take(bound);
  sure_->take(bound);
  remember(bound);
  if (bound.two_sided) impossible_ = 0;
  // A message alone never contradicts a clock that lost time: only an exchange speaks against that.
  if (rival_ && (bound.two_sided || rival_->fate != PingFate::too_late)) rival_.reset();
}

void PingClock::doubt(const PingBound& bound, PingFate fate) {
  if (rival_ && rival_->bounds.fate(bound) == PingFate::fits) {
    rival_->bounds.take(bound);
    rival_->taken.push_back(bound);
    if (rival_->taken.size() >= agreeing_for_epoch) begin_epoch(std::move(*rival_));
    return;
  }
  rival_.emplace(
      Rival{PingBounds(bound, wander_), fate, fed_, bound.not_after, reason(bound, fate), {bound}});
}

void PingClock::begin_epoch(Rival&& rival) {
  epochs_.push_back({rival.begin, std::move(rival.reason)});
  first_bounds_.push_back(rival.first);
  current_.emplace(std::move(rival.bounds));
  recent_.clear();
  for (const PingBound& bound : rival.taken) remember(bound);
  follow_surely();
  failed_searches_ = 0;
  rival_.reset();
  doubted_ = false;
}

/// The answer was back before its wire time allows. Its arrival still is a bound, if a weak one.
void PingClock::impossible(PingBound bound) {
  if (++impossible_ == static_cast<int>(agreeing_for_epoch)) {
    const PingBound arrival = sent_at(bound.send_us, bound.not_after);
    begin_epoch({PingBounds(arrival, wander_),
                 PingFate::faster_than_wire,
                 fed_,
                 bound.not_after,
                 "answers to pings come back faster than the wire allows: the baud rate is not " +
                     std::to_string(link_.baud),
                 {arrival}});
  } else
    doubted_ = true;
  ++fed_;
}

std::string PingClock::reason(const PingBound& bound, PingFate fate) const {
  if (fate == PingFate::went_back)
    return "the micro-controller was reset: its time ran back from " +
           duration_text(1e-6 * static_cast<double>(current_->newest_us())) + " to " +
           duration_text(1e-6 * static_cast<double>(bound.send_us));
  const double missed_s = current_->missed_by_s(bound);
  if (missed_s < baud_error_s) return contradiction_reason(missed_s, link_);
  if (fate == PingFate::too_early && missed_s < shortest_suspension_s)
    return "the micro-controller's clock gained " + duration_text(missed_s) +
           " on the host's at once: one of the two jumped";
  if (fate == PingFate::too_early)
    return "the host was suspended: the micro-controller's clock gained " + duration_text(missed_s) +
           " on the host's";
  return "the micro-controller's clock lost " + duration_text(missed_s) +
         ": it stood still, or was reset and its time set forward";
}

namespace {
TimeEstimate estimate(const PingBounds& bounds, std::int64_t mcu_us) {
  const ClockOrigin& origin = bounds.origin();
  return origin.estimate(origin.mcu_s(mcu_us), bounds.at(mcu_us));
}
}  // namespace

std::optional<TimeEstimate> PingClock::at(std::int64_t mcu_us) const {
  if (!current_ || !current_->two_sided()) return std::nullopt;
  return within(estimate(*current_, mcu_us), estimate(*sure_, mcu_us));
}

}  // namespace thermorig::timing
