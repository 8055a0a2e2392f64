// SPDX-License-Identifier: MIT
#include "decode_advice.h"

#include <fmt/format.h>

#include <algorithm>

#include "print/output.h"
#include "print/text_columns.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/gyro_sketch.h"

namespace thermorig::app {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t convincing_packets = 4;  // a packet's sum is weak

ChecksumPolicy checksum_policy(const std::string& name) {
  if (name == "ignore") return ChecksumPolicy::ignore;
  return name == "byte" ? ChecksumPolicy::byte : ChecksumPolicy::word;
}

std::size_t frames_in(Bytes bytes, const DecodeOptions& options) {
  sensors::CameraScanner scanner = sensors::camera_scanner(camera_profile(options));
  std::vector<wire::CameraMessage> frames;
  scanner.push(bytes, frames);
  scanner.finish(frames);
  return frames.size();
}

bool is_text_gyro(const DecodeOptions& options) {
  return options.device == Device::gyro && sensors::gyro_protocol(options.gyro_protocol).has_columns;
}

std::string shown(const std::string& line, std::size_t fields) {
  constexpr std::size_t longest = 80;
  if (line.size() > longest) return shown(line.substr(0, longest - 4) + " ...", fields);
  return fmt::format("a line reads \"{}\" ({} column{})", line, fields, fields == 1 ? "" : "s");
}

/// The unit is asked for where nothing says it.
std::string scale_options(const sensors::TextFormat& format) {
  if (format.scale_known) return "";
  return format.is_counts ? "; --scale is 1/131, 1/65.5, 1/32.8 or 1/16.4 by the range"
                          : "; --scale is 1 for deg/s, 57.2958 for rad/s";
}

/// Of lines that hold no whole image in a form that is read.
Advice advice_on_lines_of_camera(Bytes head) {
  const auto line = sensors::first_text_line(head);
  if (!line || !sensors::is_readable(head)) return {};
  return {shown(line->text, line->fields) + ": no image of 768 temperatures in a form that is read",
          "print all 768 temperatures in one line, or in 24 lines of 32 with an empty line before each "
          "picture (protocols/text_camera.md); if a gyro sent this: --device gyro"};
}

/// What lines of text say, and the options that read them; empty if there is no text.
Advice advice_on_text(const DecodeOptions& options, Bytes head) {
  const auto format = sensors::guess_text_format(head, sensors::StreamStart::at_line_start);
  if (options.device == Device::camera && !(format && format->rates_known))
    return advice_on_lines_of_camera(head);
  if (format) {
    const GyroProfile profile{.sketch = options.gyro_sketch, .text = text_columns(options)};
    std::string reason =
        shown(format->sample_line, format->fields + (format->columns.prefix.empty() ? 0 : 1));
    if (!format->refusal.empty()) return {reason + ": " + format->refusal, format->advice};
    for (const std::string& more : format->remarks) reason += ": " + more;
    if (const std::string why = sensors::contradiction(profile, *format); !why.empty()) reason += ": " + why;
    const std::string question = sensors::open_question(*format);
    if (!question.empty()) reason += ": " + question;
    return {reason, "--device gyro " + options_text(format->columns) + scale_options(*format) + " (" +
                        assumptions_text(*format) + ")"};
  }
  if (const auto line = sensors::first_text_line(head); line && sensors::is_readable(head))
    return {shown(line->text, line->fields),
            "--device gyro --gyro-protocol text, and how to read it: --prefix, --columns, --scale, "
            "--time-column"};
  return {};
}

std::string in_one(const Advice& advice) {
  return advice.reason + ": " + advice.what_to_try;
}

/// Another way to form the check sum that gives frames; empty if there is none.
std::string advice_on_checksum(const DecodeOptions& options, Bytes head) {
  if (options.camera_protocol != CameraProfile().protocol) return "";  // others have no such choice
  DecodeOptions other = options;
  for (const char* name : {"word", "byte", "ignore"}) {
    other.camera_checksum = name;
    if (name != options.camera_checksum && frames_in(head, other) > 0)
      return fmt::format("--camera-checksum {}: so the frames can be read", name);
  }
  return "";
}

std::string advice_on_camera(const DecodeOptions& options, Bytes head) {
  const std::string checksum = advice_on_checksum(options, head);
  return checksum.empty() ? "another cable or baud rate: bytes are lost or changed in the frames" : checksum;
}

/// The options that read such bytes.
std::string options_for(const sensors::Recognised& found) {
  std::string text = fmt::format("--device {}", name_of(*found.role));
  if (found.protocol != sensors::device_stream(*found.role, RigProfile()).protocol)
    text += fmt::format(" --{}-protocol {}", name_of(*found.role), found.protocol);
  for (const auto& [name, value] : found.evidence.settings)
    text += fmt::format(" --gyro-setting {}={:.6g}", name, value);
  return text;
}

/// The protocol was asked for already: something else is wrong.
bool is_chosen(const DecodeOptions& options, const sensors::Recognised& found) {
  return found.role == options.device && found.evidence.settings.empty() &&
         found.protocol == (found.role == Device::camera ? options.camera_protocol : options.gyro_protocol);
}

/// What the bytes are, where they cannot be read; or whose they look like, if not the named device's. Text is
/// told apart by its lines.
Advice advice_on_device(const DecodeOptions& options, Bytes head) {
  for (const sensors::Recognised& found : sensors::recognise(head, 0.0)) {
    if (!found.evidence.advice.empty()) return {found.evidence.text, found.evidence.advice};
    const bool convinces = found.role != Device::gyro || found.evidence.messages >= convincing_packets;
    if (found.evidence.text_format || !convinces || is_chosen(options, found)) continue;
    return {found.evidence.text, options_for(found)};
  }
  return {};
}

bool reads_clock_as_rate(const sensors::TextFormat& format, const DecodeOptions& options) {
  return std::find(options.columns.begin(), options.columns.end(), format.columns.time) !=
         options.columns.end();
}

/// Whether the lines say, rather than let guess, that other columns hold the rates.
bool speaks_for_others(const sensors::TextFormat& format, const DecodeOptions& options) {
  if (format.columns.prefix != options.prefix) return false;
  const bool others =
      !std::equal(options.columns.begin(), options.columns.end(), format.columns.rate.begin());
  return (others && format.rates_known) || (format.columns.time >= 0 && reads_clock_as_rate(format, options));
}

}  // namespace

TextColumns text_columns(const DecodeOptions& options) {
  TextColumns columns;
  std::copy(options.columns.begin(), options.columns.end(), columns.rate.begin());
  columns.prefix = options.prefix;
  columns.scale_dps = options.scale_dps;
  columns.time = options.time_column;
  columns.time_unit_s = options.time_unit_s;
  return columns;
}

CameraProfile camera_profile(const DecodeOptions& options) {
  CameraProfile profile;
  profile.protocol = options.camera_protocol;
  profile.checksum = checksum_policy(options.camera_checksum);
  return profile;
}

bool is_mostly_bad(const wire::Counters& counters) {
  return counters.bad_checksum + counters.bad_length + counters.bad_value >
         counters.messages + counters.replies;
}

Recognition recognise_gyro(std::span<const std::uint8_t> head) {
  Recognition best{.gyro_protocol = GyroProfile().protocol, .settings = {}, .text_format = {}};
  std::uint64_t most_bytes = 0;
  for (sensors::Recognised& found : sensors::recognise(head, 0.0)) {
    const bool is_read = found.is_usable() && found.role == Device::gyro && found.evidence.messages > 0;
    if (!is_read || found.evidence.bytes <= most_bytes) continue;
    auto format = found.evidence.text_format;
    if (format) format = sensors::guess_text_format(head, sensors::StreamStart::at_line_start);
    if (found.evidence.text_format && !(format && format->is_known())) continue;
    best = {std::string(found.protocol), std::move(found.evidence.settings), std::move(format)};
    most_bytes = found.evidence.bytes;
  }
  return best;
}

Advice advice_on_nothing(const DecodeOptions& options, std::span<const std::uint8_t> head,
                         const wire::Counters& counters) {
  Advice device = advice_on_device(options, head);
  if (!device.what_to_try.empty()) return device;
  if (options.device == Device::camera && counters.bad_checksum > 0)
    return {"", advice_on_camera(options, head)};
  if (counters.bytes_received > 0 && counters.bytes_pending == counters.bytes_received)
    return {"", "a longer dump: this one ends within its first message"};
  Advice text = advice_on_text(options, head);
  if (!text.what_to_try.empty()) return text;
  return {"nothing in these bytes is known",
          "take the dump at another baud rate (a wrong one gives random bytes), or check the device"};
}

std::vector<std::string> remarks_on(const DecodeOptions& options, const Recognition& recognition,
                                    std::span<const std::uint8_t> head, const wire::Counters& counters) {
  if (is_mostly_bad(counters) && options.device == Device::camera)
    return {"most frames are damaged: " + advice_on_camera(options, head)};
  if (!is_text_gyro(options))
    return is_mostly_bad(counters) ? std::vector<std::string>{"most messages are damaged"}
                                   : std::vector<std::string>{};
  std::vector<std::string> remarks;
  if (counters.bad_length > 0)
    remarks.push_back(fmt::format("{} lines were left out: they are longer than the limit of {} bytes",
                                  count_text(counters.bad_length), count_text(sensors::text_line_bytes_max)));
  if (counters.layout_changes > 0)
    remarks.push_back(
        fmt::format("the lines went on with another number of columns {} time(s): from there on the "
                    "columns may mean something else",
                    count_text(counters.layout_changes)));
  if (is_mostly_bad(counters))
    remarks.push_back("most lines could not be read: " + in_one(advice_on_text(options, head)));
  else if (recognition.text_format)
    remarks.insert(remarks.end(), recognition.text_format->remarks.begin(),
                   recognition.text_format->remarks.end());
  else if (const auto format = sensors::guess_text_format(head, sensors::StreamStart::at_line_start);
           format && speaks_for_others(*format, options))
    remarks.push_back("the lines suggest other columns: " + in_one(advice_on_text(options, head)));
  return remarks;
}

}  // namespace thermorig::app
