// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "commands.h"
#include "decode_advice.h"
#include "print/decoded_text.h"
#include "print/output.h"
#include "print/terminal_width.h"
#include "print/text_columns.h"
#include "thermorig/core/auto_zero.h"
#include "thermorig/core/error.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/gyro_sketch.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::app {

namespace {

/// A file or, for "-", standard input, read in blocks so that its size does not matter.
class ByteSource {
 public:
  /// Throws Error(bad_usage) if there is no such file, Error(no_permission) or Error(storage) if it cannot be
  /// opened.
  explicit ByteSource(const std::string& path);

  /// The next block; empty at the end. Throws Error(storage) if reading fails. Valid until the next call.
  std::span<const std::uint8_t> next();

  const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::vector<std::uint8_t> block_;
};

constexpr std::size_t block_bytes = 1 << 16;

int keep_open(std::FILE*) {
  return 0;
}

[[noreturn]] void refuse_to_read(const std::string& path, int reason) {
  if (reason == ENOENT)
    throw Error(ExitCode::bad_usage, "there is no such file", path, "another name, or - for standard input");
  if (reason == EISDIR)
    throw Error(ExitCode::bad_usage, "this is a folder, not a dump", path,
                "name a file in it, or - for standard input");
  const ExitCode code = reason == EACCES ? ExitCode::no_permission : ExitCode::storage;
  throw Error(code, std::string("it cannot be read: ") + std::strerror(reason), path,
              "ls -l " + shell_word(path));
}

std::unique_ptr<std::FILE, int (*)(std::FILE*)> open_source(const std::string& path) {
  if (path == "-") return {stdin, keep_open};
  const std::filesystem::file_status status = std::filesystem::status(path);
  if (std::filesystem::is_directory(status)) refuse_to_read(path, EISDIR);
  if (std::filesystem::is_character_file(status) || std::filesystem::is_block_file(status))
    throw Error(ExitCode::bad_usage, "this is a device, not a dump", path,
                "thermorig ports reads what is plugged in; - stands for standard input");
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) refuse_to_read(path, errno);
  return {file, std::fclose};
}

ByteSource::ByteSource(const std::string& path)
    : name_(path == "-" ? "standard input" : path), file_(open_source(path)), block_(block_bytes) {}

std::span<const std::uint8_t> ByteSource::next() {
  for (;;) {  // read(), not fread(): what a pipe has is shown at once
    const ssize_t got = read(fileno(file_.get()), block_.data(), block_.size());
    if (got >= 0) return {block_.data(), static_cast<std::size_t>(got)};
    if (errno != EINTR) refuse_to_read(name_, errno);
  }
}

constexpr std::uint64_t usual_lines = 10;

[[noreturn]] void refuse_setting(const std::string& word, const sensors::GyroProtocol& protocol) {
  std::string known;
  for (const sensors::GyroSetting& setting : protocol.settings)
    known += fmt::format("{}{}, {} to {}", known.empty() ? "" : "; ", setting.name, setting.min, setting.max);
  throw Error(ExitCode::bad_usage,
              fmt::format("\"{}\" is not a setting of {}, or out of range", word, protocol.name),
              "--gyro-setting", known.empty() ? "it has none" : "NAME=NUMBER with one of: " + known);
}

/// "name=number" as the profile would say it.
void set(const std::string& word, GyroProfile& profile) {
  const sensors::GyroProtocol& protocol = sensors::gyro_protocol(profile.protocol);
  const std::size_t equals = std::min(word.find('='), word.size());
  const std::string name = word.substr(0, equals);
  const char* const end = word.data() + word.size();
  double value = 0.0;
  const auto [at, error] = std::from_chars(word.data() + std::min(equals + 1, word.size()), end, value);
  if (error != std::errc() || at != end || !sensors::is_allowed(protocol, name, value))
    refuse_setting(word, protocol);
  profile.settings[name] = value;
}

GyroProfile gyro_profile(const DecodeOptions& options, const Recognition& recognition) {
  GyroProfile profile;
  profile.protocol = options.gyro_protocol;
  profile.sketch = options.gyro_sketch;
  profile.settings = recognition.settings;
  for (const std::string& word : options.gyro_settings) set(word, profile);
  profile.text = recognition.text_format ? recognition.text_format->columns : text_columns(options);
  return profile;
}

/// Prints messages as they come: all of them, or the first few.
class MessagePrinter {
 public:
  explicit MessagePrinter(const DecodeOptions& options)
      : json_(options.json),
        width_(isatty(STDOUT_FILENO) != 0 ? terminal_width() : std::string::npos),
        most_(options.all ? every : options.lines.value_or(options.json ? every : usual_lines)) {}

  template <typename Message>
  void print(const Message& message) {
    const std::uint64_t index = count_++;
    if (index >= most_) return;
    const std::string line =
        json_ ? json_line(message_json(message, index)) : folded(text_of(message, index) + "\n", width_);
    write_to(stdout, line);
  }

  std::uint64_t count() const { return count_; }
  std::uint64_t left_out() const { return count_ > most_ ? count_ - most_ : 0; }

 private:
  static constexpr std::uint64_t every = std::numeric_limits<std::uint64_t>::max();

  bool json_;
  std::size_t width_;  // elsewhere than on a terminal a message is one line, for grep, awk and wc
  std::uint64_t most_;
  std::uint64_t count_ = 0;
};

/// What is learnt of a dump beside its messages.
struct Learnt {
  std::vector<std::uint8_t> head;  // its first bytes
  Recognition recognition;         // of a gyro, where no option says how it is read
  AutoZero zeros;                  // of a gyro
  std::optional<ThermalFrame> first_frame;
  int bus_id = 1;  // of a servo on a bus
};

void learn(const wire::GyroMessage& message, Learnt& learnt) {
  learnt.zeros.add(message.reading);
}
void learn(const wire::CameraMessage& message, Learnt& learnt) {
  if (!learnt.first_frame) learnt.first_frame = message.frame;
}
template <typename Message>
void learn(const Message&, Learnt&) {}

std::string remark_on_frames(const DecodeOptions& options, const Learnt& learnt) {
  if (!learnt.first_frame) return "";
  const sensors::CameraProtocol& camera = sensors::camera_protocol(options.camera_protocol);
  return camera.doubt == nullptr ? "" : camera.doubt(*learnt.first_frame);
}

std::string remark_on_zeros(const AutoZero& zeros) {
  return fmt::format(
      "the rates are exactly 0 on all axes for {} samples in a row: this gyro zeroes itself at rest and so "
      "hides its bias; switch that off in the device (WitMotion: registers 61 and 63)",
      count_text(zeros.longest()));
}

constexpr std::size_t head_bytes = 1 << 16;

/// The first bytes of a dump: as many as tell what it is, and no more, for a pipe may go on slowly.
std::vector<std::uint8_t> read_head(ByteSource& source, std::size_t telling_bytes) {
  std::vector<std::uint8_t> head;
  while (head.size() < telling_bytes) {
    const auto block = source.next();
    if (block.empty()) break;
    head.insert(head.end(), block.begin(), block.end());
  }
  return head;
}

template <typename Message, typename Scanner>
wire::Counters decode(Scanner scanner, ByteSource& source, MessagePrinter& printer, Learnt& learnt) {
  std::vector<std::uint8_t>& head = learnt.head;
  std::vector<Message> messages;
  const auto take = [&] {
    for (const Message& message : messages) {
      learn(message, learnt);
      printer.print(message);
    }
    messages.clear();
  };
  scanner.push(head, messages);
  take();
  for (auto block = source.next(); !block.empty(); block = source.next()) {
    if (head.size() < head_bytes) head.insert(head.end(), block.begin(), block.end());
    scanner.push(block, messages);
    take();
    require_printed();  // a stream of bytes need not end
  }
  scanner.finish(messages);
  take();
  return scanner.counters();
}

wire::Counters decode(const DecodeOptions& options, ByteSource& source, MessagePrinter& printer,
                      Learnt& learnt) {
  switch (options.device) {
    case Device::camera:
      return decode<wire::CameraMessage>(sensors::camera_scanner(camera_profile(options)), source, printer,
                                         learnt);
    case Device::gyro:
      return decode<wire::GyroMessage>(sensors::gyro_scanner(gyro_profile(options, learnt.recognition),
                                                             sensors::StreamStart::at_line_start),
                                       source, printer, learnt);
    case Device::servo:
      break;
  }
  const sensors::ServoProtocol& servo = sensors::servo_protocol(options.servo_protocol);
  return decode<wire::ServoMessage>(servo.scanner({.bus_id = learnt.bus_id}), source, printer, learnt);
}

[[noreturn]] void refuse_bytes(const DecodeOptions& options, const std::string& name,
                               const wire::Counters& counters, std::span<const std::uint8_t> head) {
  const std::string device(name_of(options.device));
  if (counters.bytes_received == 0)
    throw Error(ExitCode::device_missing, "there are no bytes", name,
                "a dump that the " + device + " has sent");
  const Advice advice = advice_on_nothing(options, head, counters);
  std::string what =
      fmt::format("not one message of a {} in {} bytes", device, count_text(counters.bytes_received));
  if (!advice.reason.empty()) what += ": " + advice.reason;
  throw Error(ExitCode::device_missing, what, name, advice.what_to_try);
}

/// Options that only lines of text need.
bool names_columns(const DecodeOptions& options) {
  const DecodeOptions usual;
  return options.columns != usual.columns || options.prefix != usual.prefix ||
         options.scale_dps != usual.scale_dps || options.time_column != usual.time_column;
}

constexpr std::size_t telling_of_gyro = 1 << 13, telling_of_camera = 1 << 15;  // two images as text

/// The options that a sketch's name stands for. Those that are given beside it win.
DecodeOptions with_sketch(DecodeOptions options) {
  const sensors::GyroSketch* const sketch = sensors::find_gyro_sketch(options.gyro_protocol);
  if (sketch == nullptr) return options;
  options.gyro_sketch = sketch->name;
  options.gyro_protocol = "text";
  const DecodeOptions usual;
  const TextColumns& text = sketch->columns;
  if (options.columns == usual.columns) options.columns.assign(text.rate.begin(), text.rate.end());
  if (options.prefix.empty()) options.prefix = text.prefix;
  if (options.scale_dps == usual.scale_dps) options.scale_dps = text.scale_dps;
  if (options.time_column != usual.time_column) return options;
  options.time_column = text.time;
  options.time_unit_s = text.time_unit_s;
  return options;
}

/// How a camera or a gyro is read that no option names.
DecodeOptions completed(DecodeOptions options, ByteSource& source, Learnt& learnt) {
  options = with_sketch(std::move(options));
  if (options.device == Device::camera && options.camera_protocol.empty()) {
    learnt.head = read_head(source, telling_of_camera);
    options.camera_protocol = CameraProfile().protocol;
    for (const sensors::Recognised& found : sensors::recognise(learnt.head, 0.0))
      if (found.role == Device::camera && found.is_usable()) options.camera_protocol = found.protocol;
    return options;
  }
  if (options.device == Device::servo) {
    learnt.head = read_head(source, telling_of_gyro);
    for (const sensors::Recognised& found : sensors::recognise(learnt.head, 0.0)) {
      if (found.role != Device::servo) continue;
      if (options.servo_protocol.empty()) options.servo_protocol = found.protocol;
      if (const auto id = found.evidence.settings.find("bus_id"); id != found.evidence.settings.end())
        learnt.bus_id = static_cast<int>(id->second);
    }
    if (options.servo_protocol.empty()) options.servo_protocol = ServoProfile().protocol;
    return options;
  }
  if (options.device != Device::gyro || !options.gyro_protocol.empty()) return options;
  if (names_columns(options)) {
    options.gyro_protocol = "text";
    return options;
  }
  learnt.head = read_head(source, telling_of_gyro);
  learnt.recognition = recognise_gyro(learnt.head);
  options.gyro_protocol = learnt.recognition.gyro_protocol;
  return options;
}

/// What a gyro's bytes were recognised as, for a person to check.
void print_recognition(const DecodeOptions& options, const Recognition& recognition) {
  if (options.json) return;
  if (const auto& format = recognition.text_format) {
    print("line  {}\nread  {}\nwhy   {}\n\n", printable(format->sample_line),
          printable(columns_text(format->columns)), printable(assumptions_text(*format)));
  } else if (!recognition.settings.empty()) {
    std::string text = options.gyro_protocol;
    for (const auto& [name, value] : recognition.settings) text += fmt::format(", {} {:.6g}", name, value);
    print("read  {}\n\n", text);
  }
}

void print_summary(const DecodeOptions& options, const std::string& name, const wire::Counters& counters,
                   const MessagePrinter& printer, const Recognition& recognition,
                   const std::vector<std::string>& remarks) {
  if (options.json) {
    nlohmann::json summary{{"event", "summary"},
                           {"device", name_of(options.device)},
                           {"file", name},
                           {"messages_decoded", printer.count()},
                           {"counters", counters_json(counters)},
                           {"remarks", remarks}};
    if (options.device == Device::gyro) summary["gyro_protocol"] = options.gyro_protocol;
    if (recognition.text_format) summary["text_format"] = format_json(*recognition.text_format);
    print_json(summary);
    return;
  }
  if (printer.left_out() > 0) print("... and {} more (--all prints them)\n", count_text(printer.left_out()));
  print("\n{}", text_of(counters));
  for (const std::string& remark : remarks) print("\nnote  {}\n", printable(remark));
}

}  // namespace

ExitCode run(const DecodeOptions& given) {
  ByteSource source(given.file);
  Learnt learnt;
  const DecodeOptions options = completed(given, source, learnt);
  MessagePrinter printer(options);
  print_recognition(options, learnt.recognition);
  const wire::Counters counters = decode(options, source, printer, learnt);
  std::vector<std::string> remarks;
  if (printer.count() > 0) remarks = remarks_on(options, learnt.recognition, learnt.head, counters);
  if (options.device == Device::gyro && printer.count() > 0)
    if (std::string remark = sensors::remark_on_rates(gyro_profile(options, learnt.recognition));
        !remark.empty())
      remarks.push_back(std::move(remark));
  if (std::string remark = remark_on_frames(options, learnt); !remark.empty())
    remarks.push_back(std::move(remark));
  if (learnt.zeros.is_seen()) remarks.push_back(remark_on_zeros(learnt.zeros));
  print_summary(options, source.name(), counters, printer, learnt.recognition, remarks);
  if (printer.count() == 0) refuse_bytes(options, source.name(), counters, learnt.head);
  return is_mostly_bad(counters) ? ExitCode::finished_lossy : ExitCode::ok;
}

}  // namespace thermorig::app
