// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "kept_journal.h"
#include "recording_start.h"
#include "servo_link.h"
#include "thermorig/pipeline/frame_pairs.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/rig/absent_camera.h"
#include "thermorig/rig/link_load.h"

namespace thermorig::rig {

namespace {

constexpr std::size_t first_bytes_kept = 8192;  // enough to tell which device it is
constexpr double silence_s = 3.0;               // then a device that has spoken before counts as lost
constexpr double silent_periods = 10.0;         // or so many of its periods, if they are longer

}  // namespace

struct Recording::Parts {
  Parts(const RecordingOptions& given, HostTime now, SendToServo send_to_servo)
      : options(given),
        begin(now),
        send(std::move(send_to_servo)),
        header(make_header(options, now)),
        journal(options, header),
        pipeline(options.profile),
        commander(options.profile.servo),
        sweep(options.plan, options.profile.servo, options.profile.camera.output_rate_hz, commander) {}

  void take(pipeline::Streams streams, const std::vector<LabelledSample>& samples, HostTime arrived);
  void observe(std::vector<TimedFrame> frames, const std::vector<LabelledSample>& samples, HostTime arrived);
  void observe(const pipeline::FramePair& pair, HostTime arrived);
  void take_absent(HostTime arrived);
  void take_streams(const pipeline::Streams& streams, HostTime arrived);
  void note_first_bytes(Device from, std::span<const std::uint8_t> bytes);
  void begin_when_ready(HostTime now);
  void check_devices(HostTime now);
  void drive(HostTime now);
  void drain_sweep(HostTime now);
  void note_return(Device device, HostTime now);
  void note_epoch(const ClockEpoch& epoch, HostTime now);
  void event(const RecordingEvent& event);
  void fail(const Error& error, HostTime now);
  void lose(Device device, const Error& error, HostTime now);
  double patience_s(Device device) const;
  Error silence(Device device, double silent_s) const;
  bool has_spoken(Device device) const { return meters[device].count() > 0; }
  bool is_needed(Device device) const { return device == Device::servo || options.needed[device]; }

  /// Runs `step`; what the rig's devices refuse ends the recording, a disk that refuses is thrown on.
  template <typename Step>
  void guarded(HostTime now, Step step) {
    try {
      step();
    } catch (const Error& error) {
      if (error.code() == ExitCode::storage) throw;
      fail(error, now);
    }
  }

  RecordingOptions options;
  HostTime begin;
  SendToServo send;
  RecordingHeader header;
  KeptJournal journal;
  pipeline::Pipeline pipeline;
  pipeline::FramePairs pairs;
  std::optional<AbsentCamera> absent_camera;  // where the recording goes on without one
  std::uint64_t samples_seen = 0;
  ServoCommander commander;
  SweepWalker sweep;
  PerDevice<RateMeter> meters;
  PerDevice<std::optional<float>> uncertainty_s;  // of the newest message's time
  std::uint64_t missing_frames = 0;
  PerDevice<std::vector<std::uint8_t>> first_bytes;
  std::vector<RecordingEvent> new_events;
  std::optional<LabelledSample> last_sample;
  std::optional<Error> failure;
  PerDevice<bool> gone{};      // not there, not needed
  PerDevice<bool> was_gone{};  // for a while at least
  std::string gone_advice;     // of the first
  bool was_ready = false;      // every device was there, and the servo was greeted
  bool began = false;
  bool may_start = false;
  bool greeting_noted = false;
  bool stopped = false;
  std::string stopped_by;
  bool finish_noted = false;
  bool servo_gone = false;
};

Recording::Recording(const RecordingOptions& options, HostTime now, SendToServo send)
    : parts_(std::make_unique<Parts>(options, now, std::move(send))) {
  if (options.begun) options.begun(parts_->header);
  parts_->may_start = !options.wait_for_start;
  parts_->sweep.greet();
}

Recording::~Recording() = default;

// ---- bytes --------------------------------------------------------------------------------------------

void Recording::received(Device from, std::span<const std::uint8_t> bytes, HostTime arrived) {
  Parts& parts = *parts_;
  parts.journal.received(from, bytes, arrived);
  if (!parts.has_spoken(from)) parts.note_first_bytes(from, bytes);
  const auto samples = parts.pipeline.feed(from, bytes, arrived);
  parts.take(parts.pipeline.take_streams(), samples, arrived);
}

// Who watches comes last: the servo's next command does not wait for a network.
void Recording::Parts::take(pipeline::Streams streams, const std::vector<LabelledSample>& samples,
                            HostTime arrived) {
  if (!samples.empty()) last_sample = samples.back();
  guarded(arrived, [&] { take_streams(streams, arrived); });
  if (absent_camera) {
    absent_camera->add(streams, arrived, samples_seen);
    take_absent(arrived);
    if (absent_camera->has_begun()) return;  // what a camera sends that is back is kept, and no more
  }
  samples_seen += samples.size();
  for (const LabelledSample& sample : samples) sweep.sample(sample);
  if (options.observe) observe(std::move(streams.frames), samples, arrived);
}

void Recording::Parts::take_absent(HostTime arrived) {
  for (const TimedFrame& frame : absent_camera->take_frames()) sweep.frame(frame);
  for (const pipeline::FramePair& pair : absent_camera->take_pairs()) {
    last_sample = pair.sample;
    sweep.sample(pair.sample);
    observe(pair, arrived);
  }
}

void Recording::Parts::observe(const pipeline::FramePair& pair, HostTime arrived) {
  if (!options.observe) return;
  if (const auto row = options.observe(pair.frame, pair.sample, arrived)) journal.estimate(*row);
}

void Recording::Parts::observe(std::vector<TimedFrame> frames, const std::vector<LabelledSample>& samples,
                               HostTime arrived) {
  pairs.add(std::move(frames));
  pairs.add(samples);
  for (const pipeline::FramePair& pair : pairs.take()) observe(pair, arrived);
}

void Recording::Parts::note_first_bytes(Device from, std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t>& kept = first_bytes[from];
  const std::size_t room = first_bytes_kept - std::min(first_bytes_kept, kept.size());
  const auto some = bytes.first(std::min(room, bytes.size()));
  kept.insert(kept.end(), some.begin(), some.end());
}

void Recording::Parts::take_streams(const pipeline::Streams& streams, HostTime arrived) {
  for (const TimedFrame& frame : streams.frames) {
    meters[Device::camera].message(arrived);
    uncertainty_s[Device::camera] = frame.stamp.uncertainty_s;
    missing_frames += frame.missing_before;
    if (!absent_camera || !absent_camera->has_begun()) sweep.frame(frame);
  }
  if (!streams.gyro.empty()) note_return(Device::gyro, arrived);
  for (const TimedGyro& gyro : streams.gyro) {
    meters[Device::gyro].message(arrived);
    uncertainty_s[Device::gyro] = gyro.stamp.uncertainty_s;
  }
  for (const wire::ServoMessage& message : streams.servo_answers) commander.answer(message, arrived);
  for (const TimedPong& pong : streams.pongs) commander.pong(pong);
  for (const ClockEpoch& epoch : streams.servo_epochs) note_epoch(epoch, arrived);
  for (const TimedServo& servo : streams.servo) {
    meters[Device::servo].message(arrived);
    uncertainty_s[Device::servo] = servo.stamp.uncertainty_s;
    sweep.telemetry(servo);
  }
}

/// A camera that is back is not: rows stand in for it already.
void Recording::Parts::note_return(Device device, HostTime now) {
  if (!std::exchange(gone[device], false)) return;
  event({now, EventKind::device_back, device, fmt::format("{}: it is back", name_of(device))});
}

void Recording::Parts::note_epoch(const ClockEpoch& epoch, HostTime now) {
  if (epoch.reason.empty()) return;  // the first: nothing has gone wrong
  event({now, EventKind::warning, Device::servo, "the servo's clock starts anew: " + epoch.reason});
}

// ---- time ---------------------------------------------------------------------------------------------

void Recording::tick(HostTime now) {
  Parts& parts = *parts_;
  parts.journal.check();
  if (done()) return;
  parts.guarded(now, [&] {
    parts.check_devices(now);
    parts.begin_when_ready(now);
  });
  if (!parts.servo_gone) parts.guarded(now, [&] { parts.drive(now); });
  parts.drain_sweep(now);
}

void Recording::Parts::drive(HostTime now) {
  sweep.tick(now);
  const std::vector<std::uint8_t> bytes = commander.poll(now);
  if (bytes.empty()) return;
  journal.sent(bytes, now);
  pipeline.sent(bytes, now);
  send(bytes);
}

void Recording::Parts::begin_when_ready(HostTime now) {
  if (began || failure || stopped) return;
  if (!greeting_noted && commander.greeted()) {
    greeting_noted = true;
    event({now, EventKind::info, Device::servo,
           fmt::format("firmware {} answered hello", commander.welcome()->firmware)});
  }
  const bool all_speak = std::all_of(all_devices.begin(), all_devices.end(),
                                     [&](Device device) { return has_spoken(device) || gone[device]; });
  if (!all_speak || !commander.greeted() || !commander.idle()) return;
  was_ready = true;
  if (!may_start) return;
  began = true;
  sweep.start(now);
}

double Recording::Parts::patience_s(Device device) const {
  const double periods_s = silent_periods / link_load(device, options.profile).rate_hz;
  return std::max(has_spoken(device) ? silence_s : options.start_patience_s, periods_s);
}

void Recording::Parts::check_devices(HostTime now) {
  if (failure || stopped) return;
  for (const Device device : all_devices) {
    if (gone[device] || failure) continue;
    const double silent_s = to_s(now - meters[device].last().value_or(begin));
    if (silent_s <= patience_s(device)) continue;
    if (device == Device::servo) servo_gone = has_spoken(device);
    lose(device, silence(device, silent_s), now);
  }
}

Error Recording::Parts::silence(Device device, double silent_s) const {
  if (!has_spoken(device))
    return silent_device(device, options.profile, pipeline.counters(device), first_bytes[device]);
  return {ExitCode::device_lost, fmt::format("nothing has come from it for {:.1f} s", silent_s),
          place_of(device, options.profile), "check cable and power, then record again"};
}

void Recording::Parts::drain_sweep(HostTime now) {
  for (const RecordingEvent& happened : sweep.take_events()) event(happened);
  for (const LegRecord& leg : sweep.take_legs()) journal.leg(leg);
  if (sweep.done() && sweep.plan_complete() && !failure && !stopped && !std::exchange(finish_noted, true))
    event({now, EventKind::finished, std::nullopt, "the plan is complete"});
}

void Recording::Parts::event(const RecordingEvent& happened) {
  journal.event(happened);
  new_events.push_back(happened);
}

// ---- ends ---------------------------------------------------------------------------------------------

void Recording::Parts::fail(const Error& error, HostTime now) {
  const bool first = !failure;
  if (first) {
    failure = error;
    event({now, EventKind::device_lost, std::nullopt, error.where() + ": " + error.what_happened()});
  }
  // A servo that does not answer cannot be stopped from here; its watchdog does it.
  if (!first || sweep.phase() == SweepPhase::stopping) servo_gone = true;
  if (!servo_gone) sweep.request_stop(now);
}

/// A device is not there, or no more: the end, or an event where the recording can do without it.
void Recording::Parts::lose(Device device, const Error& error, HostTime now) {
  if (gone[device]) return;
  const bool all_gone = gone[Device::camera] || gone[Device::gyro];  // the other one goes now
  if (is_needed(device) || all_gone) return fail(error, now);
  if (gone_advice.empty()) gone_advice = error.advice();
  gone[device] = was_gone[device] = true;
  if (device == Device::camera) absent_camera.emplace(options.profile, now);
  event({now, EventKind::missing, device,
         fmt::format("{}: {}; going on without it", error.where(), error.what_happened())});
}

void Recording::lost(Device device, const std::string& why, HostTime now) {
  Parts& parts = *parts_;
  if (device == Device::servo) parts.servo_gone = true;
  parts.lose(device,
             Error(ExitCode::device_lost, why, place_of(device, parts.options.profile),
                   "check cable and power, then record again"),
             now);
}

void Recording::missing(Device device, const Error& why, HostTime now) {
  Parts& parts = *parts_;
  parts.lose(device,
             Error(why.code(), why.what_happened(), place_of(device, parts.options.profile), why.advice()),
             now);
}

void Recording::request_stop(HostTime now, const std::string& who) {
  Parts& parts = *parts_;
  if (parts.stopped || done()) return;
  parts.stopped = true;
  parts.stopped_by = who;
  parts.event({now, EventKind::stopped, std::nullopt,
               who.empty() ? "stopped on request" : "stopped on request of " + who});
  parts.sweep.request_stop(now);
}

void Recording::mark(const std::string& note, HostTime now) {
  parts_->event({now, EventKind::mark, std::nullopt, note});
}

void Recording::allow_start(HostTime now) {
  Parts& parts = *parts_;
  if (std::exchange(parts.may_start, true)) return;
  parts.event({now, EventKind::info, std::nullopt, "the start was allowed"});
}

void Recording::carry_out(const Order& order, HostTime now) {
  switch (order.kind) {
    case OrderKind::stop:
      return request_stop(now, order.note);
    case OrderKind::mark:
      return mark(order.note, now);
    case OrderKind::start:
      return allow_start(now);
    case OrderKind::gate:
      return parts_->event({now, EventKind::gate, std::nullopt, order.note});
  }
}

bool Recording::done() const {
  return parts_->sweep.done() || parts_->servo_gone;
}

const std::optional<Error>& Recording::failure() const {
  return parts_->failure;
}

bool Recording::stopped() const {
  return parts_->stopped;
}

bool Recording::was_ready() const {
  return parts_->was_ready;
}

const std::string& Recording::stopped_by() const {
  return parts_->stopped_by;
}

bool Recording::keeps() const {
  return parts_->options.keep;
}

std::vector<Device> Recording::gone() const {
  std::vector<Device> gone;
  for (const Device device : all_devices)
    if (parts_->was_gone[device]) gone.push_back(device);
  return gone;
}

const std::string& Recording::gone_advice() const {
  return parts_->gone_advice;
}

const SessionFile& Recording::file() const {
  return parts_->journal.file();
}

const SweepPlan& Recording::plan() const {
  return parts_->options.plan;
}

RecordingProgress Recording::progress(HostTime now) {
  Parts& parts = *parts_;
  RecordingProgress progress;
  progress.time = now;
  progress.elapsed_s = to_s(now - parts.begin);
  progress.sweep = parts.sweep.progress(now);
  for (const Device device : all_devices) {
    progress.health[device] = parts.meters[device].health(now, parts.pipeline.counters(device));
    progress.health[device].expected_hz = link_load(device, parts.options.profile).rate_hz;
    progress.health[device].uncertainty_s = parts.uncertainty_s[device];
  }
  progress.health[Device::camera].lost += parts.missing_frames;
  progress.events = std::exchange(parts.new_events, {});
  progress.last_sample = parts.last_sample;
  progress.gone = parts.gone;
  progress.kept_bytes = parts.journal.bytes();
  progress.stopping = parts.stopped || parts.failure.has_value();
  return progress;
}

SessionFile Recording::close(HostTime now) {
  Parts& parts = *parts_;
  const auto samples = parts.pipeline.finish();
  const auto frames = parts.pipeline.take_streams().frames;
  if (parts.absent_camera) {
    parts.absent_camera->finish();
    parts.take_absent(now);
  }
  const bool has_camera = !parts.absent_camera || !parts.absent_camera->has_begun();
  if (parts.options.observe && has_camera) parts.observe(frames, samples, now);
  parts.drain_sweep(now);
  parts.journal.close(now);
  return file();
}

void Recording::discard(HostTime now) {
  close(now);
  if (!keeps()) return;
  std::filesystem::remove(file().journal);
  std::error_code in_use;  // by another recording: then the folder stays
  for (const auto& folder : file().made_folders) std::filesystem::remove(folder, in_use);
}

}  // namespace thermorig::rig
