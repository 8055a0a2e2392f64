// SPDX-License-Identifier: MIT
#include "ping_epochs.h"

#include <array>
#include <cstdio>
#include <utility>

namespace thermorig::timing {
namespace {

// So many messages that agree with each other outvote the clock so far.
constexpr int agreeing_for_epoch = 3;

// More than the wire times of a ping and its answer at any baud rate in use: a wrong baud rate cannot shift
// bounds further.
constexpr double baud_error_s = 0.005;

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
  std::snprintf(ppm.data(), ppm.size(), "%g", link.wander_ppm);
  const std::string baud = link.baud == 0 ? "" : "a baud rate other than " + std::to_string(link.baud) + ", ";
  return "bounds contradict each other by " + duration_text(missed_s) + ": " + baud +
         "a clock that wanders by more than " + ppm.data() +
         " ppm within a minute, or a host whose time stood still";
}

PingEpochs::PingEpochs(const PortProfile& link) : link_(link), wander_(wander_of(link)) {}

void PingEpochs::feed(const PingBound& bound) {
  if (!current_) {
    epochs_.push_back({bound.not_after, ""});
    first_bounds_.push_back(fed_);
    current_.emplace(bound, wander_);
    ++fed_;
    return;
  }
  const PingFate fate = current_->fate(bound);
  if (fate == PingFate::faster_than_wire) return impossible(bound);
  doubted_ = fate != PingFate::fits;
  if (doubted_)
    doubt(bound, fate);
  else
    trust(bound);
  ++fed_;
}

void PingEpochs::trust(const PingBound& bound) {
  current_->take(bound);
  if (bound.two_sided) impossible_ = 0;
  // A message alone never contradicts a clock that lost time: only an exchange speaks against that.
  if (rival_ && (bound.two_sided || rival_->fate != PingFate::too_late)) rival_.reset();
}

void PingEpochs::doubt(const PingBound& bound, PingFate fate) {
  if (rival_ && rival_->bounds.fate(bound) == PingFate::fits) {
    rival_->bounds.take(bound);
    if (++rival_->agreeing >= agreeing_for_epoch) begin_epoch(std::move(*rival_));
    return;
  }
  rival_.emplace(Rival{PingBounds(bound, wander_), fate, fed_, bound.not_after, reason(bound, fate)});
}

void PingEpochs::begin_epoch(Rival&& rival) {
  epochs_.push_back({rival.begin, std::move(rival.reason)});
  first_bounds_.push_back(rival.first);
  current_.emplace(std::move(rival.bounds));
  rival_.reset();
  doubted_ = false;
}

/// The answer was back before its wire time allows. Its arrival still is a bound, if a weak one.
void PingEpochs::impossible(PingBound bound) {
  if (++impossible_ == agreeing_for_epoch)
    begin_epoch({PingBounds({.send_us = bound.send_us, .not_after = bound.not_after}, wander_),
                 PingFate::faster_than_wire, fed_, bound.not_after,
                 "answers to pings come back faster than the wire allows: the baud rate is not " +
                     std::to_string(link_.baud)});
  else
    doubted_ = true;
  ++fed_;
}

std::string PingEpochs::reason(const PingBound& bound, PingFate fate) const {
  if (fate == PingFate::went_back)
    return "the micro-controller was reset: its time ran back from " +
           duration_text(1e-6 * static_cast<double>(current_->newest_us())) + " to " +
           duration_text(1e-6 * static_cast<double>(bound.send_us));
  const double missed_s = current_->missed_by_s(bound);
  if (missed_s < baud_error_s) return contradiction_reason(missed_s, link_);
  if (fate == PingFate::too_early)
    return "the host was suspended: the micro-controller's clock gained " + duration_text(missed_s) +
           " on the host's";
  return "the micro-controller's clock lost " + duration_text(missed_s) +
         ": it stood still, or was reset and its time set forward";
}

}  // namespace thermorig::timing
