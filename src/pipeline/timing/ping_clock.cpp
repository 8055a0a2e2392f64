// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/ping_clock.h"

#include "thermorig/pipeline/timing/ping_epochs.h"

namespace thermorig::timing {
namespace {

TimeEstimate estimate(const PingBounds& bounds, std::int64_t mcu_us) {
  const ClockOrigin& origin = bounds.origin();
  return origin.estimate(origin.mcu_s(mcu_us), bounds.at(mcu_us));
}

}  // namespace

struct PingClock::State {
  PingEpochs epochs;
};

PingClock::PingClock(const PortProfile& link) : state_(std::make_unique<State>(State{PingEpochs(link)})) {}
PingClock::~PingClock() = default;
PingClock::PingClock(PingClock&&) noexcept = default;
PingClock& PingClock::operator=(PingClock&&) noexcept = default;

void PingClock::exchange(const PingExchange& exchange) {
  if (exchange.send_us < exchange.receive_us) return;  // no answer comes before its question
  state_->epochs.feed(two_sided(exchange));
}

void PingClock::sent(const SentStamp& stamp) {
  state_->epochs.feed(one_sided(stamp));
}

std::optional<TimeEstimate> PingClock::at(std::int64_t mcu_us) const {
  const PingBounds* likely = state_->epochs.likely();
  if (likely == nullptr || !likely->two_sided()) return std::nullopt;
  return within(estimate(*likely, mcu_us), estimate(*state_->epochs.sure(), mcu_us));
}

const std::vector<ClockEpoch>& PingClock::epochs() const {
  return state_->epochs.epochs();
}

}  // namespace thermorig::timing
