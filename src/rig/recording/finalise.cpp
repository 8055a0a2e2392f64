// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/finalise.h"

#include <algorithm>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/core/run_all.h"
#include "thermorig/fit/fit.h"
#include "thermorig/io/port.h"
#include "thermorig/io/spill/spill.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/pipeline/replay.h"
#include "thermorig/rig/recording/session_file.h"
#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::rig {

namespace {

PerDevice<std::uint64_t> byte_counts(const PerDevice<RawStream>& received) {
  PerDevice<std::uint64_t> counts;
  for (const Device device : all_devices) counts[device] = received[device].bytes.size();
  return counts;
}

struct Decoded {
  pipeline::Streams streams;
  std::vector<LabelledSample> samples;
  PerDevice<wire::Counters> counters;
};

Decoded decode(const RawRecording& raw, const pipeline::Fits& fits, bool without_labels = false) {
  Decoded decoded;
  pipeline::Pipeline pipeline(raw.header.profile, fits, without_labels);
  pipeline.expect(byte_counts(raw.received));
  const auto keep = [&](const std::vector<Measurement>& measurements) {
    for (const Measurement& measurement : measurements) decoded.samples.push_back(measurement.sample);
  };
  Replay replay(raw);
  while (const auto step = replay.next()) keep(pipeline::feed(pipeline, *step));
  keep(pipeline.finish());
  decoded.streams = pipeline.take_streams();
  for (const Device device : all_devices) decoded.counters[device] = pipeline.counters(device);
  return decoded;
}

session::State state_of(const RawRecording& raw) {
  if (!raw.complete) return session::State::recovered;
  const bool finished = std::any_of(raw.events.begin(), raw.events.end(), [](const RecordingEvent& event) {
    return event.kind == EventKind::finished;
  });
  return finished ? session::State::complete : session::State::partial;
}

/// What the firmware said of itself, "1.0.0": known only after the header was written.
std::string firmware_of(const pipeline::Streams& streams) {
  for (const wire::ServoMessage& message : streams.servo_answers)
    if (const auto* welcome = std::get_if<wire::ServoWelcome>(&message.body)) return welcome->firmware;
  return {};
}

/// The labels decide which frames a leg has; what the recorder counted was enough to drive by.
void recount(std::vector<LegRecord>& legs, const std::vector<LabelledSample>& samples, int wanted) {
  for (LegRecord& leg : legs) {
    leg.frames = static_cast<int>(std::count_if(
        samples.begin(), samples.end(), [&](const LabelledSample& sample) { return sample.leg == leg.leg; }));
    leg.complete = leg.complete && leg.frames >= wanted;
  }
}

}  // namespace

session::Session build_session(RawRecording raw) {
  pipeline::Fits fits = fit::fit_recording(raw, decode(raw, {}, true).streams, on_all_cores);
  Decoded decoded = decode(raw, fits);
  session::Session session;
  session.state = state_of(raw);
  session.settle_s = raw.header.profile.servo.settle_s;
  session.camera_mode = fits.camera_mode == labels::CameraMode::full_fresh ? "full-fresh" : "half-fresh";
  session.frame_period_s = fits.frame_period_s.value_or(1.0 / raw.header.profile.camera.output_rate_hz);
  session.frames = std::move(decoded.streams.frames);
  session.gyro = std::move(decoded.streams.gyro);
  session.servo = std::move(decoded.streams.servo);
  session.shaft = std::move(decoded.streams.shaft);
  raw.header.shaft_sensor = session.shaft.empty()
                                ? std::string_view()
                                : sensors::servo_protocol(raw.header.profile.servo.protocol).shaft_sensor;
  session.pongs = std::move(decoded.streams.pongs);
  session.samples = std::move(decoded.samples);
  if (raw.header.firmware.empty()) raw.header.firmware = firmware_of(decoded.streams);
  session.counters = decoded.counters;
  session.sync = std::move(fits.sync).value_or(SyncReport{});
  recount(raw.legs, session.samples, raw.header.frames_per_leg);
  session.raw = std::move(raw);
  return session;
}

Finalised finalise(const std::filesystem::path& journal, const std::filesystem::path& session_path,
                   files::Disk& disk, WithoutEnd without_end, std::int64_t clock_set_ns) {
  spill::arrays_near(session_path);
  journal::JournalContents contents = journal::read_journal(journal, disk);
  if (clock_set_ns != 0) {
    RecordingHeader& header = contents.recording.header;
    header.realtime_offset_ns += clock_set_ns;
    header.start_time_utc = io::utc_text(header.time_reference, header.realtime_offset_ns);
  }
  Finalised made;
  made.bytes_ignored = contents.bytes_ignored;
  made.is_retired =
      contents.bytes_ignored == 0 && (contents.recording.complete || without_end == WithoutEnd::retire);
  made.session = build_session(std::move(contents.recording));
  session::write_session(session_path, made.session, disk);
  if (made.is_retired) retire_journal(journal, disk);
  return made;
}

}  // namespace thermorig::rig
