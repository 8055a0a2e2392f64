// SPDX-License-Identifier: MIT
#include "verdict.h"

#include <fmt/format.h>

#include <algorithm>

namespace thermorig::session {

namespace {

constexpr double lost_share_bad = 0.05;
constexpr double lost_share_usable = 0.005;
constexpr double valid_share_usable = 0.5;

class Verdict {
 public:
  void bad(const std::string& reason) { note(2, reason); }
  void usable(const std::string& reason) { note(1, reason); }

  void write_to(Quality& quality) const {
    quality.verdict = level_ == 2 ? "bad" : level_ == 1 ? "usable" : "good";
    quality.verdict_reasons = reasons_;
  }

 private:
  void note(int level, const std::string& reason) {
    level_ = std::max(level_, level);
    reasons_.push_back(reason);
  }
  int level_ = 0;
  std::vector<std::string> reasons_;
};

void judge_stream(Device device, const Quality::Stream& stream, Verdict& verdict) {
  const std::uint64_t lost = stream.lost + stream.bad;
  if (stream.received == 0)
    return verdict.bad(fmt::format("the {} sent nothing that can be read", name_of(device)));
  const double share = static_cast<double>(lost) / static_cast<double>(lost + stream.received);
  const auto reason =
      fmt::format("{:.1f} % of the {}'s messages were lost or damaged", 100 * share, name_of(device));
  if (share > lost_share_bad) return verdict.bad(reason);
  if (share > lost_share_usable) verdict.usable(reason);
}

void judge_samples(const Quality& quality, Verdict& verdict) {
  if (quality.valid == 0) return verdict.bad("no frame is valid");
  if (static_cast<double>(quality.valid) < valid_share_usable * static_cast<double>(quality.swept))
    verdict.usable(fmt::format("only {} of {} frames within legs are valid", quality.valid, quality.swept));
  const auto empty = std::count_if(quality.speeds.begin(), quality.speeds.end(),
                                   [](const auto& speed) { return speed.valid == 0; });
  if (empty > 0)
    verdict.usable(fmt::format("{} of {} speeds have no valid frame", empty, quality.speeds.size()));
}

void judge_events(const Session& session, Verdict& verdict) {
  const auto is_loss = [](const RecordingEvent& event) { return event.kind == EventKind::device_lost; };
  const auto losses = std::count_if(session.raw.events.begin(), session.raw.events.end(), is_loss);
  if (losses == 1) verdict.usable("a device was lost once");
  if (losses > 1) verdict.usable(fmt::format("devices were lost {} times", losses));
  if (session.state == State::recovered) verdict.usable("recovered after the recorder was cut short");
  if (session.state == State::partial) verdict.usable("stopped before the plan was complete");
}

}  // namespace

void judge(const Session& session, Quality& quality) {
  Verdict verdict;
  for (const Device device : all_devices) judge_stream(device, quality.stream[device], verdict);
  judge_samples(quality, verdict);
  judge_events(session, verdict);
  verdict.write_to(quality);
}

}  // namespace thermorig::session
