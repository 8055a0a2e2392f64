// SPDX-License-Identifier: MIT
#include "live_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "interrupts.h"
#include "live_model.h"
#include "live_page.h"
#include "live_run.h"
#include "live_screens.h"
#include "replay_progress.h"
#include "sessions/session_files.h"
#include "thermorig/io/port.h"
#include "thermorig/pipeline/replay.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::app {

namespace {

constexpr double longest_replay_s =
    1e9;  // of a replay: what nanoseconds can hold, whatever a file says of its times
constexpr auto longest_sleep = std::chrono::milliseconds(50);  // so that Ctrl-C and the page are heard

/// The recording's time against the wall's.
class Pace {
 public:
  Pace(HostTime begin, double speed) : begin_(begin), speed_(speed), wall_begin_(io::now()) {}

  /// How long until `time` is due, not negative.
  HostDuration wait(HostTime time) const {
    if (speed_ <= 0.0) return {};
    const double passed_s = std::clamp(to_s(time - begin_) / speed_, 0.0, longest_replay_s);
    const HostTime due = wall_begin_ + from_s(passed_s);
    return std::max(HostDuration{}, due - io::now());
  }

 private:
  HostTime begin_;
  double speed_;
  HostTime wall_begin_;
};

/// One replay: steps, their rows, and the state four times a second of whichever clock is slower.
class Replayer {
 public:
  Replayer(const LiveOptions& options, const RawRecording& raw, LiveRun& run, LivePage* page,
           const LiveScreens& screens, bool same_model)
      : raw_(raw),
        run_(run),
        page_(page),
        screens_(screens),
        replay_(raw),
        progress_(raw),
        pace_(raw.header.time_reference, options.speed),
        same_model_(same_model) {}

  /// False if it was stopped.
  bool play() {
    while (const auto moment = replay_.next()) {
      if (!wait_for(moment->time)) return false;
      progress_.add(*moment);
      for (const Measurement& measurement : moment->measurements) {
        progress_.add(measurement.sample);
        run_.observe(measurement, moment->time);
      }
      tell_orders(moment->time);
      tell(moment->time, false);
    }
    tell(raw_.end_time, true);
    return true;
  }

  std::string ending() const { return "stopped on request" + stopped_by_; }

 private:
  bool wait_for(HostTime time) {
    if (stopped(time)) return false;
    for (HostDuration left = pace_.wait(time); left > HostDuration{}; left = pace_.wait(time)) {
      std::this_thread::sleep_for(std::min<HostDuration>(left, longest_sleep));
      if (stopped(time)) return false;
    }
    return true;
  }

  /// Takes the page's orders at `time`. A mark is seen, and kept nowhere: a session does not change.
  bool stopped(HostTime time) {
    if (page_ != nullptr)
      for (const rig::Order& order : page_->take_orders()) {
        if (order.kind == rig::OrderKind::stop) stopped_by_ = " of " + order.note;
        if (order.kind == rig::OrderKind::mark) run_.tell({time, EventKind::mark, std::nullopt, order.note});
      }
    return interrupted() || !stopped_by_.empty() || screens_.alone();
  }

  /// The network's gate may collapse; of its own model the session has that event already.
  void tell_orders(HostTime time) {
    for (const rig::Order& order : run_.take_orders()) {
      if (order.kind == rig::OrderKind::gate && !same_model_)
        run_.tell({time, EventKind::gate, std::nullopt, order.note});
      if (order.kind == rig::OrderKind::info) run_.tell({time, EventKind::info, std::nullopt, order.note});
    }
  }

  void tell(HostTime time, bool last) {
    const HostTime wall = io::now();
    if (!last && (time < next_ || wall < next_wall_)) return;
    next_ = time + state_period;
    next_wall_ = wall + state_period;
    run_.progress(progress_.at(time, replay_));
  }

  const RawRecording& raw_;
  LiveRun& run_;
  LivePage* page_;
  const LiveScreens& screens_;
  pipeline::CausalReplay replay_;
  ReplayProgress progress_;
  Pace pace_;
  bool same_model_;         // as when the session was made
  std::string stopped_by_;  // " of the page"
  HostTime next_{}, next_wall_{};
};

LiveFacts facts_of(const RawRecording& raw) {
  LiveFacts facts;
  facts.mode = LiveMode::replay;
  facts.plan_name = raw.header.plan_name;
  facts.legs = raw.legs.size();
  facts.frames_per_leg = raw.header.frames_per_leg;
  facts.expected_s = to_s(raw.end_time - raw.header.time_reference);
  return facts;
}

}  // namespace

ExitCode replay_live(const LiveOptions& options) {
  const std::filesystem::path file = one_session_at(*options.replay);
  const RawRecording raw = session::read_raw(file);
  const ChosenModel model = choose_live_model(options, raw.header.profile.camera);
  watch_interrupts();
  const std::unique_ptr<LivePage> page =
      options.record.page.serve ? std::make_unique<LivePage>(options.record.page) : nullptr;
  LiveMap map(options.map, raw.header.profile.camera, raw.header.simulated);
  LiveRun run(
      facts_of(raw), model,
      estimators::Bank(options.estimators, model.model, raw.header.profile, model.run, 1, map.begun_with()),
      &map);
  LiveScreens screens(options, page.get(), run);
  RecordingHeader header = raw.header;
  header.live_model = model.facts;
  run.begun(header);
  for (const std::string& warning : warnings_of(model, header.simulated, header.frames_per_leg))
    run.warn(warning);
  const bool same_model = !model.facts.hash.empty() && model.facts.hash == raw.header.live_model.hash &&
                          model.facts.precision == raw.header.live_model.precision &&
                          model.facts.turned == raw.header.live_model.turned;
  Replayer replayer(options, raw, run, page.get(), screens, same_model);
  const bool finished = replayer.play();
  const ExitCode code = finished ? ExitCode::ok : ExitCode::interrupted;
  run.write_map(file);
  run.ended({static_cast<int>(code), finished ? "" : replayer.ending(), "", ""});
  screens.finish(code);
  return code;
}

}  // namespace thermorig::app
