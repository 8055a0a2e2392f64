// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/estimate.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/statistics.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/timing/least_lateness.h"
#include "thermorig/pipeline/timing/lower_line.h"

namespace thermorig::timing {

/// What the bytes alone prove of a message when it is stamped.
struct MessageProof {
  HostTime latest{};  // its first byte had begun by then
  // Of each read that ended within or at the end of it, device_s and held_s left out; none: it only waited
  // with others.
  std::span<const LatestBegin> reads;
  double lost_before = 0.0;        // messages that fit into the bytes skipped before it; 0 if none were
  std::optional<double> device_s;  // its own time
  bool left_out = false;           // no bytes were skipped: the device itself did not send one
};

/// The clock of a device that sends at a steady rate, from what arrived so far: the highest line below all
/// inequalities of the last seconds, on the count of messages (or the device's own time), less what even the
/// fastest byte is expected to be late by. Lost messages are counted once it is clear that the stream does
/// not catch up.
class LiveClock {
 public:
  /// `nominal_rate_hz` > 0.
  LiveClock(const PortProfile& link, double nominal_rate_hz);

  /// When the message's first byte began, never after its proof. None while too little came, and of a device
  /// that keeps no steady rate. Messages come in order, each once.
  std::optional<HostTime> place(const MessageProof& proof);

  /// How late even the fastest bytes are expected to be: was taken off. Of the last seconds.
  const Estimate& least_lateness_s() const { return least_lateness_s_; }
  /// How long the link may listen before it takes silence for an end; 0 if it does not wait for one.
  double longest_silence_s() const { return longest_silence_s_; }

  /// Messages that it counts as lost so far: falls where the stream catches up after all. Of a device that
  /// sends its own time none are counted.
  double missing() const { return missing_; }

  /// How far the clock may drift between the messages that hold its line up, and a period where a clock that
  /// is slewed may have been taken for a lost message.
  double drift_s() const {
    return 0.5 * drift_ * window_s_ + (last_x_ < doubted_until_x_ ? period_s() : 0.0);
  }

 private:
  struct Block {
    std::size_t points = 0;
    double begin_x = 0.0;
  };
  double count(const MessageProof& proof);
  void restart(double x, double y);
  double late_s(double x, double y) const { return y - line_at(x); }
  double line_at(double x) const { return level_ + slope_ * (x - line_x_); }
  double period_s() const { return std::max(slope_, 1e-3) / rate_hz_; }
  double count_lost(const MessageProof& proof, double x, double y);
  double left_out(const MessageProof& proof, double late_periods) const;
  double recount(const MessageProof& proof, double x, double y);
  double shift(double x, double periods);
  bool watch(double late_s, double x);
  void watch_runs(double late_periods);
  bool is_by_chance() const;
  double rate_doubt_s() const;
  void allow_drift(double drift);
  void look_for_straying(double late_s, double x);
  void add(double x, double y);
  void add_reads(std::span<const LatestBegin> reads, double x);
  void forget_reads(double before_x);
  void close_block(double x);
  void fit(double x);
  void expect_lateness();

  double rate_hz_;
  double largest_constant_delay_s_;
  double drift_ = 0.0;  // of the clock against its mean rate
  double window_s_ = 0.0;
  double block_s_ = 0.0;
  std::optional<HostTime> origin_;
  double counted_ = -1.0;  // messages, lost ones included
  double missing_ = 0.0;   // the lost ones
  double last_device_s_ = 0.0;
  double last_x_ = 0.0;
  double doubted_until_x_ = 0.0;
  double last_y_ = 0.0;  // of the message before
  std::vector<Ceiling> points_;
  std::vector<Block> blocks_;
  std::vector<LatestBegin> reads_;      // of the same time
  std::vector<MessageReads> messages_;  // they share the reads
  std::size_t old_reads_ = 0;           // the first ones are older than the window
  std::size_t old_messages_ = 0;
  double sent_s_ = 0.0;  // on the device's clock: the newest read's last byte
  Estimate least_lateness_s_;
  double longest_silence_s_ = 0.0;
  std::size_t open_begin_ = 0;  // first point of the open block
  double open_x_ = 0.0;
  double first_x_ = 0.0;  // since the last restart
  bool fitted_ = false;
  bool rate_known_ = false;
  double slope_ = 1.0;
  double mean_slope_ = 1.0;
  double level_ = 0.0;
  double line_x_ = 0.0;
  double rise_ = 0.0;     // how much higher the line would be without the points that hold it up, of late
  double watch_x_ = 0.0;  // begin of the span being watched
  double least_late_s_ = 0.0;
  std::uint32_t watched_ = 0;
  std::array<double, 2> watched_late_s_{};  // least lateness in the two spans before
  double run_ = 0.0;                        // messages in a row that are late as after a loss
  double usual_run_ = 1.0;  // how many such come in a row, and the one in time behind them, on average
  double stray_x_ = 0.0;    // the same of the span in which the clock may stray
  double least_stray_s_ = 0.0;
  std::uint32_t straying_ = 0;
  double unrest_ = 0.0;   // how often the count was corrected lately
  RecentCount left_out_;  // messages that the device did not send
};

}  // namespace thermorig::timing
