// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <deque>
#include <optional>

#include "thermorig/core/time.h"

namespace thermorig::timing {

/// Which read of a servo that is asked for its telemetry an answer belongs to. Answers come in the order of
/// the reads, but any of them may have been lost, and a host that was busy has asked again before it has read
/// what had come meanwhile.
class ReadLedger {
 public:
  /// After so long no answer is on its way any more to a host that has read others since.
  static constexpr auto longest_answer = std::chrono::milliseconds(100);

  struct Request {
    HostTime asked{};      // of the oldest that may be meant
    bool is_only = false;  // no other one can be meant
  };

  void asked(HostTime time);

  /// `begun`: the answer had begun to be sent by then. None: nothing was asked.
  std::optional<Request> answered(HostTime begun);

  bool is_open() const { return !open_.empty(); }

  /// An answer has come since the newest read, which was not its only one.
  bool is_unsure() const { return is_open() && answered_since_; }

  void restart() { *this = ReadLedger(); }

 private:
  std::deque<HostTime> open_;  // not answered yet
  bool answered_since_ = false;
  int unsure_ = 0;  // answers in a row
};

}  // namespace thermorig::timing
