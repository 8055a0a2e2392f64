// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "file_lock.h"
#include "journal_sync.h"
#include "recording_start.h"
#include "servo_link.h"
#include "thermorig/journal/journal.h"
#include "thermorig/pipeline/pipeline.h"

namespace thermorig::rig {

namespace {

constexpr std::size_t first_bytes_kept = 8192;  // enough to tell which device it is
constexpr double silence_s = 3.0;               // then a device that has spoken before counts as lost
constexpr double silent_periods = 10.0;         // or so many of its periods, if they are longer

double nominal_rate_hz(const RigProfile& profile, Device device) {
  if (device == Device::camera) return profile.camera.output_rate_hz;
  if (device == Device::gyro) return profile.gyro.output_rate_hz;
  return 1e3 / SERVO_TELEMETRY_PERIOD_MS;
}

}  // namespace

struct Recording::Parts {
  Parts(const RecordingOptions& given, HostTime now, SendToServo send_to_servo)
      : options(given),
        begin(now),
        send(std::move(send_to_servo)),
        pipeline(options.profile),
        commander(options.profile.servo),
        sweep(options.plan, options.profile.servo, options.profile.camera.output_rate_hz, commander) {}

  void create_journal();
  void take_streams(HostTime arrived);
  void note_first_bytes(Device from, std::span<const std::uint8_t> bytes);
  void begin_when_ready(HostTime now);
  void check_devices(HostTime now);
  void drive(HostTime now);
  void drain_sweep(HostTime now);
  void note_epoch(const ClockEpoch& epoch, HostTime now);
  void event(const RecordingEvent& event);
  void fail(const Error& error, HostTime now);
  double patience_s(Device device) const;
  bool has_spoken(Device device) const { return meters[device].count() > 0; }

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
  pipeline::Pipeline pipeline;
  ServoCommander commander;
  SweepWalker sweep;
  SessionFile file;
  std::unique_ptr<journal::JournalWriter> journal;
  std::unique_ptr<FileLock> journal_lock;  // tells `recover` that this one is being written
  std::unique_ptr<JournalSync> sync;
  PerDevice<RateMeter> meters;
  std::uint64_t missing_frames = 0;
  PerDevice<std::vector<std::uint8_t>> first_bytes;
  std::vector<RecordingEvent> new_events;
  std::optional<LabelledSample> last_sample;
  std::optional<Error> failure;
  bool began = false;
  bool greeting_noted = false;
  bool stopped = false;
  bool finish_noted = false;
  bool servo_gone = false;
};

Recording::Recording(const RecordingOptions& options, HostTime now, SendToServo send)
    : parts_(std::make_unique<Parts>(options, now, std::move(send))) {
  parts_->create_journal();
  parts_->sweep.greet();
}

Recording::~Recording() = default;

void Recording::Parts::create_journal() {
  RecordingHeader header = make_header(options, begin);
  const FolderLock lock(options.output, options.environment);
  file = lock.next(compact_utc(header.start_time_utc));
  header.acquisition = file.acquisition;
  journal = std::make_unique<journal::JournalWriter>(file.journal, header, expected_journal_bytes(options));
  journal_lock = std::make_unique<FileLock>(file.journal, FileLock::Wait::yes);
  if (options.sync_while_recording) sync = std::make_unique<JournalSync>(*journal);
}

// ---- bytes --------------------------------------------------------------------------------------------

void Recording::received(Device from, std::span<const std::uint8_t> bytes, HostTime arrived) {
  Parts& parts = *parts_;
  parts.journal->received(from, bytes, arrived);
  if (!parts.has_spoken(from)) parts.note_first_bytes(from, bytes);
  const auto samples = parts.pipeline.feed(from, bytes, arrived);
  if (!samples.empty()) parts.last_sample = samples.back();
  parts.guarded(arrived, [&] { parts.take_streams(arrived); });
  for (const LabelledSample& sample : samples) parts.sweep.sample(sample);
}

void Recording::Parts::note_first_bytes(Device from, std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t>& kept = first_bytes[from];
  const std::size_t room = first_bytes_kept - std::min(first_bytes_kept, kept.size());
  const auto some = bytes.first(std::min(room, bytes.size()));
  kept.insert(kept.end(), some.begin(), some.end());
}

void Recording::Parts::take_streams(HostTime arrived) {
  const pipeline::Streams streams = pipeline.take_streams();
  for (const TimedFrame& frame : streams.frames) {
    meters[Device::camera].message(arrived);
    missing_frames += frame.missing_before;
    sweep.frame(frame);
  }
  for (std::size_t i = 0; i < streams.gyro.size(); ++i) meters[Device::gyro].message(arrived);
  for (const wire::ServoMessage& message : streams.servo_answers) commander.answer(message, arrived);
  for (const TimedPong& pong : streams.pongs) commander.pong(pong);
  for (const ClockEpoch& epoch : streams.servo_epochs) note_epoch(epoch, arrived);
  for (const TimedServo& servo : streams.servo) {
    meters[Device::servo].message(arrived);
    sweep.telemetry(servo);
  }
}

void Recording::Parts::note_epoch(const ClockEpoch& epoch, HostTime now) {
  if (epoch.reason.empty()) return;  // the first: nothing has gone wrong
  event({now, EventKind::warning, Device::servo, "the servo's clock starts anew: " + epoch.reason});
}

// ---- time ---------------------------------------------------------------------------------------------

void Recording::tick(HostTime now) {
  Parts& parts = *parts_;
  if (parts.sync) parts.sync->check();
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
  journal->sent(bytes, now);
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
  const bool all_speak =
      std::all_of(all_devices.begin(), all_devices.end(), [&](Device d) { return has_spoken(d); });
  if (!all_speak || !commander.greeted() || !commander.idle()) return;
  began = true;
  sweep.start(now);
}

double Recording::Parts::patience_s(Device device) const {
  const double periods_s = silent_periods / nominal_rate_hz(options.profile, device);
  return std::max(has_spoken(device) ? silence_s : options.start_patience_s, periods_s);
}

void Recording::Parts::check_devices(HostTime now) {
  if (failure || stopped) return;
  for (const Device device : all_devices) {
    const double silent_s = to_s(now - meters[device].last().value_or(begin));
    if (silent_s <= patience_s(device)) continue;
    if (!has_spoken(device))
      throw silent_device(device, options.profile, pipeline.counters(device), first_bytes[device]);
    if (device == Device::servo) servo_gone = true;
    throw Error(ExitCode::device_lost, fmt::format("nothing has come from it for {:.1f} s", silent_s),
                fmt::format("{} ({})", name_of(device), options.profile.link(device).port),
                "check cable and power, then record again");
  }
}

void Recording::Parts::drain_sweep(HostTime now) {
  for (const RecordingEvent& happened : sweep.take_events()) event(happened);
  for (const LegRecord& leg : sweep.take_legs()) journal->leg(leg);
  if (sweep.done() && sweep.plan_complete() && !failure && !stopped && !std::exchange(finish_noted, true))
    event({now, EventKind::finished, std::nullopt, "the plan is complete"});
}

void Recording::Parts::event(const RecordingEvent& happened) {
  journal->event(happened);
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

void Recording::lost(Device device, const std::string& why, HostTime now) {
  Parts& parts = *parts_;
  if (device == Device::servo) parts.servo_gone = true;
  parts.fail(Error(ExitCode::device_lost, why,
                   fmt::format("{} ({})", name_of(device), parts.options.profile.link(device).port),
                   "check cable and power, then record again"),
             now);
}

void Recording::request_stop(HostTime now) {
  Parts& parts = *parts_;
  if (parts.stopped || done()) return;
  parts.stopped = true;
  parts.event({now, EventKind::stopped, std::nullopt, "stopped on request"});
  parts.sweep.request_stop(now);
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

bool Recording::sweep_began() const {
  return parts_->began;
}

const SessionFile& Recording::file() const {
  return parts_->file;
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
  for (const Device device : all_devices)
    progress.health[device] = parts.meters[device].health(now, parts.pipeline.counters(device));
  progress.health[Device::camera].lost += parts.missing_frames;
  progress.events = std::exchange(parts.new_events, {});
  progress.last_sample = parts.last_sample;
  return progress;
}

SessionFile Recording::close(HostTime now) {
  Parts& parts = *parts_;
  parts.drain_sweep(now);
  parts.sync.reset();
  parts.journal->close(now);
  parts.journal_lock.reset();
  return parts.file;
}

void Recording::discard(HostTime now) {
  close(now);
  std::filesystem::remove(parts_->file.journal);
  std::error_code in_use;  // by another recording: then the folder stays
  for (const auto& folder : parts_->file.made_folders) std::filesystem::remove(folder, in_use);
}

}  // namespace thermorig::rig
