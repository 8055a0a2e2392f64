// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/least_lateness.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "thermorig/core/statistics.h"

namespace thermorig::timing {

namespace {
constexpr double wake_up_s = 100e-6;       // a reader wakes up so much more or less late
constexpr double rise_spread = 2.0;        // of what chance does, per rise
constexpr double slide_spread_s = 0.2e-3;  // between two moments at which a sliding wait is shortest
constexpr std::size_t fewest_cuts = 20;

/// Of evenly spread waits three quarters are within this above the least.
constexpr double spread_share = 0.75;
constexpr double even_spread_s = 0.65e-3;

/// A link on which bytes wait holds nine of ten chunks for longer.
constexpr double short_hold_s = 1.5 * usb_frame_s;
constexpr double short_hold_share = 0.1;

constexpr double fewest_chunks_due = 20.0;
constexpr double fewest_cut_share = 0.1;  // of those that are due if the link cuts anywhere
// An assumption: adaptors without a timer that can be set answer within a few USB frames.
constexpr double longest_wait_s = 0.003;

/// Inequalities of one block between knots.
struct BlockLateness {
  double least_s = std::numeric_limits<double>::infinity();
  std::size_t messages = 0;
};

class Lateness {
 public:
  Lateness(const Reads& reads, double step_s, std::span<const CurveRise> knots, double window_s)
      : reads_(reads), step_s_(step_s), knots_(knots), window_s_(window_s) {
    for (const MessageReads& message : reads.messages) cuts_ += message.cuts;
    by_cuts_ = cuts_ >= fewest_cuts && 50 * cuts_ >= reads.latest.size();
    silence_s_ = by_cuts_ ? 0.0 : longest_silence_s();
  }

  LeastLateness run(std::size_t first_knot) {
    fill_blocks();
    const double covered = covered_share();
    typical_least_s_ = lower_quantile(message_least_s_, 0.5);
    wait_share_ = wait_share();
    mean_rise_s_ = mean_rise(0, knots_.size());
    LeastLateness result{.at_knots_s = {}, .longest_hold_s = silence_s_};
    for (std::size_t knot = first_knot; knot < knots_.size(); ++knot)
      result.at_knots_s.push_back(at(knot, covered));
    return result;
  }

 private:
  /// 0 where the link does not wait for a silence.
  double longest_silence_s() const {
    std::vector<double> wires_s;
    for (const LatestBegin& begin : reads_.latest)
      if (!begin.inside) wires_s.push_back(begin.wire_s);
    const double wire_s = lower_quantile(wires_s, 0.5);
    if (step_s_ <= 0.0 || wire_s <= 0.0) return 0.0;
    const double due = std::min(1.0, wire_s / step_s_) * static_cast<double>(reads_.latest.size());
    if (due < fewest_chunks_due || static_cast<double>(cuts_) > fewest_cut_share * due) return 0.0;
    return std::clamp(step_s_ - wire_s, 0.0, longest_wait_s);
  }

  std::size_t block_of(double x, std::size_t block) const {
    while (block + 1 < knots_.size() && knots_[block + 1].x - x < x - knots_[block].x) ++block;
    return block;
  }

  bool takes_part(const MessageReads& message) const { return !by_cuts_ || message.cuts > 0; }

  /// Applies `use` to each message, its block and the place of its first read.
  template <typename Use>
  void for_each_message(Use use) const {
    std::size_t block = 0;
    std::size_t first = 0;
    for (const MessageReads& message : reads_.messages) {
      block = block_of(reads_.latest[first].device_s - reads_.x0, block);
      use(message, block, first);
      first += message.count;
    }
  }

  /// Least lateness of each block, and of each message; spread of the waits within a message.
  void fill_blocks() {
    blocks_.resize(knots_.size());
    message_least_s_.reserve(reads_.messages.size());
    std::size_t ended = 0;  // messages: they count where the next one begins
    std::size_t last = 0;
    for_each_message([&](const MessageReads& message, std::size_t block, std::size_t first) {
      blocks_[last = block].messages += std::exchange(ended, 0);
      if (!takes_part(message)) return;
      const double least_s = reads_.late_s(first + (by_cuts_ ? message.least_cut : message.least));
      message_least_s_.push_back(least_s);
      blocks_[block].least_s = std::min(blocks_[block].least_s, least_s);
      ended = 1;
      if (by_cuts_ && message.cuts >= 2)
        message_spreads_s_.push_back(reads_.late_s(first + message.upper_cut) - least_s);
    });
    blocks_[last].messages += ended;
  }

  /// Spread of the waits within a block: where a message is not cut more than once.
  std::vector<double> block_spreads_s() const {
    std::vector<double> spreads_s;
    std::vector<double> waits_s;
    std::size_t open = 0;
    const auto end_block = [&] {
      if (waits_s.size() >= 2)
        spreads_s.push_back(upper_quantile(waits_s, spread_share) - blocks_[open].least_s);
      waits_s.clear();
    };
    for_each_message([&](const MessageReads& message, std::size_t block, std::size_t first) {
      if (block != open) end_block();
      open = block;
      for (std::size_t i = first; i < first + message.count; ++i)
        if (!by_cuts_ || reads_.latest[i].inside) waits_s.push_back(reads_.late_s(i));
    });
    end_block();
    return spreads_s;
  }

  /// How much of a USB frame the waits cover, 0 to 1.
  double covered_share() {
    const bool by_message = by_cuts_ && 2 * message_spreads_s_.size() > message_least_s_.size();
    std::vector<double> spreads_s = by_message ? std::move(message_spreads_s_) : block_spreads_s();
    if (spreads_s.empty()) return 1.0;
    return std::clamp((lower_quantile(spreads_s, 0.5) - wake_up_s) / even_spread_s, 0.0, 1.0);
  }

  /// How much of a USB frame slid past within the window around a knot: the least waits of its blocks then
  /// lie evenly between none and all of it. What the messages' own jitter does to them is taken off.
  double slid_share(std::size_t begin, std::size_t end) {
    std::vector<double> least_s;
    double jitter_s = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      if (blocks_[i].messages == 0) continue;
      least_s.push_back(blocks_[i].least_s);
      jitter_s += 2.0 * typical_least_s_ / static_cast<double>(blocks_[i].messages + 1);
    }
    if (least_s.empty()) return 0.0;
    jitter_s /= static_cast<double>(least_s.size());
    return std::clamp(2.0 * (lower_quantile(least_s, 0.5) - jitter_s) / usb_frame_s, 0.0, 1.0);
  }

  double mean_rise(std::size_t begin, std::size_t end) const {
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += knots_[i].rise;
    return sum / static_cast<double>(end - begin);
  }

  /// A link that cuts every millisecond may be one on which no byte waits.
  double wait_share() const {
    if (!by_cuts_) return 1.0;
    std::size_t short_holds = 0;
    for (const MessageReads& message : reads_.messages) short_holds += message.short_holds;
    return static_cast<double>(short_holds) > short_hold_share * static_cast<double>(cuts_ - 1) ? 0.5 : 1.0;
  }

  Estimate at(std::size_t knot, double covered) {
    const double x = knots_[knot].x;
    const auto before = [](const CurveRise& k, double value) { return k.x < value; };
    const auto place = [&](double at_x) {
      return static_cast<std::size_t>(std::lower_bound(knots_.begin(), knots_.end(), at_x, before) -
                                      knots_.begin());
    };
    const std::size_t begin = place(x - 0.5 * window_s_);
    const std::size_t end = std::max(place(x + 0.5 * window_s_), knot + 1);
    const double slid = slid_share(begin, end);
    const double unknown_s = usb_frame_s * std::max(0.0, 1.0 - covered - slid);
    const double near_rise_s =
        mean_rise(std::max(begin, knot - std::min(knot, near)), std::min(end, knot + near + 1));
    // Evenly spread lateness is too high by one rise, one that is spread like the sum of two waits by two.
    const double chance_s = (1.0 + covered) * mean_rise_s_;
    const double expected_s = 0.5 * wait_share_ * unknown_s + chance_s + 0.5 * silence_s_;
    const double spread_s =
        std::hypot(uniform_deviation * unknown_s, rise_spread * std::max(near_rise_s, mean_rise_s_),
                   uniform_deviation * silence_s_);
    return {expected_s, std::hypot(spread_s, wake_up_s, slide_spread_s * slid)};
  }

  static constexpr std::size_t near = 3;  // knots on either side over which a rise is averaged

  const Reads& reads_;
  double step_s_;
  std::span<const CurveRise> knots_;
  double window_s_;
  std::size_t cuts_ = 0;
  bool by_cuts_ = false;  // only chunks that cut a message are looked at
  double silence_s_ = 0.0;
  double typical_least_s_ = 0.0;  // of a message: median
  double wait_share_ = 1.0;
  double mean_rise_s_ = 0.0;
  std::vector<BlockLateness> blocks_;
  std::vector<double> message_least_s_;
  std::vector<double> message_spreads_s_;
};
}  // namespace

MessageReads message_reads(std::span<const LatestBegin> reads) {
  MessageReads message{.count = static_cast<std::uint32_t>(reads.size())};
  std::vector<std::uint32_t> cuts;
  for (std::uint32_t i = 0; i < message.count; ++i) {
    if (reads[i].latest < reads[message.least].latest) message.least = i;
    // Without a baud rate nobody knows what the bytes' own time is: how far cuts lie apart says no wait.
    if (!reads[i].inside || !(reads[i].wire_s > 0.0)) continue;
    cuts.push_back(i);
    if (reads[i].held_s <= short_hold_s) ++message.short_holds;
  }
  message.cuts = static_cast<std::uint32_t>(cuts.size());
  if (cuts.empty()) return message;
  const auto earlier = [&](std::uint32_t a, std::uint32_t b) { return reads[a].latest < reads[b].latest; };
  message.least_cut = *std::min_element(cuts.begin(), cuts.end(), earlier);
  const auto upper = cuts.begin() + static_cast<std::ptrdiff_t>(
                                        std::ceil(spread_share * static_cast<double>(cuts.size() - 1)));
  std::nth_element(cuts.begin(), upper, cuts.end(), earlier);
  message.upper_cut = *upper;
  return message;
}

LeastLateness least_lateness(const Reads& reads, double step_s, std::span<const CurveRise> knots,
                             double window_s, std::size_t first_knot) {
  return Lateness(reads, step_s, knots, window_s).run(first_knot);
}

}  // namespace thermorig::timing
