// SPDX-License-Identifier: MIT
#include <algorithm>
#include <limits>
#include <utility>

#include "ping_epochs.h"
#include "ping_hull.h"
#include "ping_report.h"

namespace thermorig::timing {
namespace {

/// Everything that belongs to one epoch.
struct EpochData {
  ClockEpoch epoch;
  std::vector<PingBound> bounds;
  std::vector<std::size_t> asked;  // indices into mcu_us
};

/// Both kinds of messages in the order in which they arrived. The micro-controller's time decides between
/// those that arrived together.
std::vector<PingBound> in_order(std::span<const PingExchange> exchanges, std::span<const SentStamp> sent,
                                std::vector<std::size_t>& place_of_sent) {
  std::vector<PingBound> bounds;
  bounds.reserve(exchanges.size() + sent.size());
  std::size_t next = 0;
  for (const SentStamp& stamp : sent) {
    for (; next < exchanges.size() && exchanges[next].not_after <= stamp.not_after; ++next)
      if (exchanges[next].send_us >= exchanges[next].receive_us) bounds.push_back(two_sided(exchanges[next]));
    place_of_sent.push_back(bounds.size());
    bounds.push_back(one_sided(stamp));
  }
  for (; next < exchanges.size(); ++next)
    if (exchanges[next].send_us >= exchanges[next].receive_us) bounds.push_back(two_sided(exchanges[next]));
  return bounds;
}

/// Bounds by epoch, those that fit no clock left out; `epoch_of` says of each bound to which it belongs.
std::vector<EpochData> split(const std::vector<PingBound>& bounds, const PortProfile& link,
                             std::vector<std::size_t>& epoch_of) {
  PingEpochs follower(link);
  std::vector<char> doubted;
  for (const PingBound& bound : bounds) {
    follower.feed(bound);
    doubted.push_back(follower.doubted());
  }
  std::vector<EpochData> epochs;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    while (epochs.size() < follower.epochs().size() && follower.first_bounds()[epochs.size()] <= i)
      epochs.push_back({.epoch = follower.epochs()[epochs.size()]});
    epoch_of.push_back(epochs.size() - 1);
    if (!doubted[i]) epochs.back().bounds.push_back(bounds[i]);
  }
  return epochs;
}

/// Gives each time that is asked for to the epoch in which it was sent: both go through the same steps back.
class EpochFinder {
 public:
  EpochFinder(std::span<const SentStamp> sent, const std::vector<std::size_t>& epoch_of_sent)
      : sent_(sent), epoch_of_sent_(epoch_of_sent) {}

  std::size_t find(std::int64_t mcu_us) {
    if (asked_before_ && stepped_back(*asked_before_, mcu_us)) skip_life();
    asked_before_ = mcu_us;
    while (at_ + 1 < sent_.size() && !stepped_back(sent_[at_].send_us, sent_[at_ + 1].send_us) &&
           sent_[at_ + 1].send_us <= mcu_us)
      ++at_;
    return epoch_of_sent_.empty() ? 0 : epoch_of_sent_[at_];
  }

 private:
  static bool stepped_back(std::int64_t before_us, std::int64_t now_us) {
    return seconds_between(before_us, now_us) < -order_tolerance_s;
  }
  void skip_life() {
    for (std::size_t i = at_ + 1; i < sent_.size(); ++i)
      if (stepped_back(sent_[i - 1].send_us, sent_[i].send_us)) {
        at_ = i;
        return;
      }
  }

  std::span<const SentStamp> sent_;
  const std::vector<std::size_t>& epoch_of_sent_;
  std::size_t at_ = 0;
  std::optional<std::int64_t> asked_before_;
};

struct Asked {
  PingHull::Event event;
  std::size_t index;  // of mcu_us, or `none`
};
constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

std::vector<Asked> events_of(const EpochData& data, std::span<const std::int64_t> mcu_us,
                             const ClockOrigin& origin) {
  std::vector<Asked> events;
  events.reserve(2 * data.bounds.size() + data.asked.size());
  for (const PingBound& bound : data.bounds) {
    if (bound.two_sided)
      events.push_back({{origin.mcu_s(bound.receive_us), lower_bound(bound, origin)}, none});
    events.push_back({{origin.mcu_s(bound.send_us), upper_bound(bound, origin)}, none});
  }
  for (const std::size_t index : data.asked) events.push_back({{origin.mcu_s(mcu_us[index]), {}}, index});
  std::stable_sort(events.begin(), events.end(),
                   [](const Asked& a, const Asked& b) { return a.event.mcu_s < b.event.mcu_s; });
  return events;
}

/// Where nothing bounds the clock from below, the fastest message is taken to be late by the largest constant
/// delay at most.
Range closed(Range offset, double largest_constant_delay_s) {
  if (offset.lo == -unbounded) offset.lo = offset.hi - largest_constant_delay_s;
  return offset;
}

void fit_epoch(const EpochData& data, std::span<const std::int64_t> mcu_us, const PortProfile& link,
               PingFit& fit, PingReport& report) {
  if (data.bounds.empty()) return;
  const ClockOrigin origin{data.bounds.front().not_after, data.bounds.front().send_us};
  const std::vector<Asked> asked = events_of(data, mcu_us, origin);
  std::vector<PingHull::Event> events;
  events.reserve(asked.size());
  for (const Asked& one : asked) events.push_back(one.event);
  const PingHull hull(std::move(events), wander_of(link));
  for (std::size_t i = 0; i < asked.size(); ++i)
    if (asked[i].index != none)
      fit.times[asked[i].index] =
          origin.estimate(asked[i].event.mcu_s, closed(hull.offsets()[i], link.largest_constant_delay_s));
  report.add(data.epoch, hull, origin);
}

}  // namespace

PingFit fit_pings(std::span<const std::int64_t> mcu_us, std::span<const PingExchange> exchanges,
                  std::span<const SentStamp> sent, const PortProfile& link) {
  std::vector<std::size_t> place_of_sent;
  std::vector<std::size_t> epoch_of;
  const std::vector<PingBound> bounds = in_order(exchanges, sent, place_of_sent);
  std::vector<EpochData> epochs = split(bounds, link, epoch_of);
  PingFit fit;
  fit.times.resize(mcu_us.size(), unknown_time());
  PingReport report(link);
  if (epochs.empty()) return fit;
  std::vector<std::size_t> epoch_of_sent;
  for (const std::size_t place : place_of_sent) epoch_of_sent.push_back(epoch_of[place]);
  EpochFinder finder(sent, epoch_of_sent);
  for (std::size_t i = 0; i < mcu_us.size(); ++i) epochs[finder.find(mcu_us[i])].asked.push_back(i);
  for (const EpochData& data : epochs) fit_epoch(data, mcu_us, link, fit, report);
  fit.report = report.finish(mcu_us, fit.times, !exchanges.empty());
  return fit;
}

}  // namespace thermorig::timing
