// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/least_lateness.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

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

/// Inequalities of one block between knots.
struct BlockLateness {
  double least_s = std::numeric_limits<double>::infinity();
  std::size_t messages = 0;
};

class Lateness {
 public:
  Lateness(std::span<const LatestBegin> latest, std::span<const double> x, std::span<const double> late_s,
           double step_s, std::span<const SlidingFit::Knot> knots, const SlidingWindow& window)
      : latest_(latest), x_(x), late_s_(late_s), step_s_(step_s), knots_(knots), window_(window) {
    const auto cuts = static_cast<std::size_t>(std::count_if(
        latest.begin(), latest.end(), [](const LatestBegin& l) { return l.inside && l.wire_s > 0.0; }));
    by_cuts_ = cuts >= fewest_cuts && 50 * cuts >= latest.size();
    silence_s_ = by_cuts_ ? 0.0 : silence(cuts);
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
  bool takes_part(std::size_t i) const { return !by_cuts_ || latest_[i].inside; }

  double silence(std::size_t cuts) const {
    std::vector<double> wire_s;
    for (const LatestBegin& begin : latest_)
      if (!begin.inside) wire_s.push_back(begin.wire_s);
    return longest_silence_s({.step_s = step_s_,
                              .message_s = lower_quantile(wire_s, 0.5),
                              .chunks = latest_.size(),
                              .cuts = cuts});
  }

  std::size_t block_of(std::size_t i, std::size_t block) const {
    while (block + 1 < knots_.size() && knots_[block + 1].x - x_[i] < x_[i] - knots_[block].x) ++block;
    return block;
  }

  /// Least lateness of each block, and of each message; spread of the waits within a message, or within a
  /// block where a message is not cut more than once.
  void fill_blocks() {
    blocks_.resize(knots_.size());
    std::vector<double> message_s;
    std::vector<double> block_s;
    std::size_t block = 0;
    message_least_s_.reserve(x_.size());
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (const std::size_t now = block_of(i, block); now != block) {
        end_block(block_s, block);
        block = now;
      }
      if (i == 0 || x_[i] != x_[i - 1]) end_message(message_s, block);
      if (!takes_part(i)) continue;
      message_s.push_back(late_s_[i]);
      block_s.push_back(late_s_[i]);
      blocks_[block].least_s = std::min(blocks_[block].least_s, late_s_[i]);
    }
    end_message(message_s, block);
    end_block(block_s, block);
  }

  void end_message(std::vector<double>& waits_s, std::size_t block) {
    if (waits_s.empty()) return;
    ++blocks_[block].messages;
    const double least_s = *std::min_element(waits_s.begin(), waits_s.end());
    message_least_s_.push_back(least_s);
    if (by_cuts_) add_spread(waits_s, least_s, message_spreads_s_);
    waits_s.clear();
  }

  void end_block(std::vector<double>& waits_s, std::size_t block) {
    add_spread(waits_s, blocks_[block].least_s, block_spreads_s_);
    waits_s.clear();
  }

  static void add_spread(std::vector<double>& waits_s, double least_s, std::vector<double>& spreads_s) {
    if (waits_s.size() >= 2) spreads_s.push_back(upper_quantile(waits_s, spread_share) - least_s);
  }

  /// How much of a USB frame the waits cover, 0 to 1.
  double covered_share() {
    const bool by_message = by_cuts_ && 2 * message_spreads_s_.size() > message_least_s_.size();
    std::vector<double>& spreads_s = by_message ? message_spreads_s_ : block_spreads_s_;
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
    std::vector<double> held_s;
    for (const LatestBegin& begin : latest_)
      if (begin.inside) held_s.push_back(begin.held_s);
    return lower_quantile(held_s, 0.1) > 1.5 * usb_frame_s ? 1.0 : 0.5;
  }

  Estimate at(std::size_t knot, double covered) {
    const double x = knots_[knot].x;
    const auto before = [](const SlidingFit::Knot& k, double value) { return k.x < value; };
    const auto place = [&](double at_x) {
      return static_cast<std::size_t>(std::lower_bound(knots_.begin(), knots_.end(), at_x, before) -
                                      knots_.begin());
    };
    const std::size_t begin = place(x - 0.5 * window_.length_s);
    const std::size_t end = std::max(place(x + 0.5 * window_.length_s), knot + 1);
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

  std::span<const LatestBegin> latest_;
  std::span<const double> x_;
  std::span<const double> late_s_;
  double step_s_;
  std::span<const SlidingFit::Knot> knots_;
  const SlidingWindow& window_;
  bool by_cuts_ = false;  // only chunks that cut a message are looked at
  double silence_s_ = 0.0;
  double typical_least_s_ = 0.0;  // of a message: median
  double wait_share_ = 1.0;
  double mean_rise_s_ = 0.0;
  std::vector<BlockLateness> blocks_;
  std::vector<double> message_least_s_;
  std::vector<double> message_spreads_s_;
  std::vector<double> block_spreads_s_;
};
}  // namespace

LeastLateness least_lateness(std::span<const LatestBegin> latest, std::span<const double> x,
                             std::span<const double> late_s, double step_s,
                             std::span<const SlidingFit::Knot> knots, const SlidingWindow& window,
                             std::size_t first_knot) {
  return Lateness(latest, x, late_s, step_s, knots, window).run(first_knot);
}

namespace {
constexpr double fewest_chunks_due = 20.0;
constexpr double fewest_cut_share = 0.1;  // of those that are due if the link cuts anywhere
// An assumption: adaptors without a timer that can be set answer within a few USB frames.
constexpr double longest_wait_s = 0.003;
}  // namespace

double longest_silence_s(const LineUse& use) {
  if (use.step_s <= 0.0 || use.message_s <= 0.0) return 0.0;
  const double due = std::min(1.0, use.message_s / use.step_s) * static_cast<double>(use.chunks);
  if (due < fewest_chunks_due || static_cast<double>(use.cuts) > fewest_cut_share * due) return 0.0;
  return std::clamp(use.step_s - use.message_s, 0.0, longest_wait_s);
}

}  // namespace thermorig::timing
