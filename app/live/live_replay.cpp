// SPDX-License-Identifier: MIT
#include "live_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <thread>
#include <vector>

#include "interrupts.h"
#include "live_model.h"
#include "live_page.h"
#include "live_run.h"
#include "live_screens.h"
#include "sessions/session_files.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/io/port.h"
#include "thermorig/pipeline/replay.h"
#include "thermorig/rig/recording/recording.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::app {

namespace {

/// Where a replay stands, in the words of a recording.
class ReplayProgress {
 public:
  explicit ReplayProgress(const RawRecording& raw) : raw_(raw) {}

  void add(const pipeline::ReplayMoment& moment);
  void add(const LabelledSample& sample);

  /// With the events since the last call.
  rig::RecordingProgress at(HostTime now, const pipeline::CausalReplay& replay);

 private:
  std::vector<RecordingEvent> take_events(HostTime now);
  void note_gone(const RecordingEvent& event);
  rig::SweepProgress sweep(HostTime now) const;

  const RawRecording& raw_;
  PerDevice<rig::RateMeter> meters_;
  PerDevice<std::optional<float>> uncertainty_s_;
  std::uint64_t missing_frames_ = 0;
  std::optional<LabelledSample> last_sample_;
  int frames_in_leg_ = 0;
  PerDevice<bool> gone_{};
  std::size_t events_taken_ = 0;
};

std::vector<RecordingEvent> ReplayProgress::take_events(HostTime now) {
  std::vector<RecordingEvent> events;
  for (; events_taken_ < raw_.events.size() && raw_.events[events_taken_].time <= now; ++events_taken_)
    events.push_back(raw_.events[events_taken_]);
  return events;
}

void ReplayProgress::note_gone(const RecordingEvent& event) {
  if (!event.source) return;
  if (event.kind == EventKind::missing) gone_[*event.source] = true;
  if (event.kind == EventKind::device_back) gone_[*event.source] = false;
}

void ReplayProgress::add(const pipeline::ReplayMoment& moment) {
  for (const TimedFrame& frame : moment.streams.frames) {
    meters_[Device::camera].message(moment.time);
    uncertainty_s_[Device::camera] = frame.stamp.uncertainty_s;
    missing_frames_ += frame.missing_before;
  }
  for (const TimedGyro& gyro : moment.streams.gyro) {
    meters_[Device::gyro].message(moment.time);
    uncertainty_s_[Device::gyro] = gyro.stamp.uncertainty_s;
  }
  for (const TimedServo& servo : moment.streams.servo) {
    meters_[Device::servo].message(moment.time);
    uncertainty_s_[Device::servo] = servo.stamp.uncertainty_s;
  }
}

void ReplayProgress::add(const LabelledSample& sample) {
  frames_in_leg_ = last_sample_ && last_sample_->leg == sample.leg ? frames_in_leg_ + 1 : 1;
  last_sample_ = sample;
}

rig::SweepProgress ReplayProgress::sweep(HostTime now) const {
  rig::SweepProgress sweep;
  const double whole_s = to_s(raw_.end_time - raw_.header.time_reference);
  const double passed_s = to_s(now - raw_.header.time_reference);
  sweep.done_share = whole_s > 0.0 ? std::clamp(passed_s / whole_s, 0.0, 1.0) : 1.0;
  sweep.eta_s = std::max(0.0, whole_s - passed_s);
  sweep.leg_count = static_cast<int>(raw_.legs.size());
  sweep.frames_per_leg = raw_.header.frames_per_leg;
  const auto leg = std::find_if(raw_.legs.begin(), raw_.legs.end(), [&](const LegRecord& record) {
    return record.begin <= now && now < record.end;
  });
  if (leg == raw_.legs.end()) {
    sweep.phase = now < raw_.end_time ? rig::SweepPhase::transit : rig::SweepPhase::done;
    return sweep;
  }
  sweep.phase = rig::SweepPhase::leg;
  sweep.leg = leg->leg;
  sweep.rate_dps = leg->rate_dps;
  if (std::next(leg) != raw_.legs.end()) sweep.next_rate_dps = std::next(leg)->rate_dps;
  if (last_sample_ && last_sample_->leg == leg->leg) sweep.frames = frames_in_leg_;
  return sweep;
}

rig::RecordingProgress ReplayProgress::at(HostTime now, const pipeline::CausalReplay& replay) {
  rig::RecordingProgress progress;
  progress.time = now;
  progress.elapsed_s = to_s(now - raw_.header.time_reference);
  progress.sweep = sweep(now);
  for (const Device device : all_devices) {
    progress.health[device] = meters_[device].health(now, replay.counters(device));
    progress.health[device].expected_hz = rig::link_load(device, raw_.header.profile).rate_hz;
    progress.health[device].uncertainty_s = uncertainty_s_[device];
  }
  progress.health[Device::camera].lost += missing_frames_;
  progress.events = take_events(now);
  for (const RecordingEvent& event : progress.events) note_gone(event);
  progress.last_sample = last_sample_;
  progress.gone = gone_;
  return progress;
}

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
