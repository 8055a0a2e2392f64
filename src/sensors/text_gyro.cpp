// SPDX-License-Identifier: MIT
// Gyros that print text. Source: protocols/text_gyro.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "text_fields.h"
#include "text_line.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/gyro_sketch.h"
#include "thermorig/sensors/wire/byte_ledger.h"
#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::sensors {

/// In the file of that name: its messages are lines as well, which it checks.
GyroProtocol vectornav_gyro();

namespace {

using wire::Bytes;
using wire::GyroMessage;

constexpr std::size_t line_window = text_line_bytes_max + 2;
constexpr std::size_t learning_window = 2 * line_window;

/// Reads gyros that print one line of text a sample.
///
/// Text has no checksum. What can be told from it is: without a prefix, the first line of a stream that was
/// joined anywhere may be the tail of one and is not read; a line with another number of fields than the
/// lines before is damaged. How many fields are usual, two samples in a row tell, so the first one waits for
/// the second.
class TextGyroScanner {
 public:
  TextGyroScanner(const GyroProfile& profile, StreamStart start);
  void push(Bytes bytes, std::vector<GyroMessage>& out);
  /// The stream ends here: what only waits for the bytes behind it is decided. A line without an end stays
  /// pending, since it may be cut inside a number.
  void finish(std::vector<GyroMessage>& out);
  /// How many columns are usual is forgotten: what comes back may print others.
  void restart();
  const wire::Counters& counters() const { return ledger_.counters; }

 private:
  std::size_t step(Bytes rest, std::vector<GyroMessage>& out);
  std::size_t skip_to_line_end(Bytes rest);
  std::size_t take_line(const RawLine& line, Bytes rest, std::vector<GyroMessage>& out);
  std::size_t pass_over(std::size_t bytes);
  std::size_t learn_fields(Bytes rest);
  bool speak_otherwise(Bytes lines) const;
  bool has_usual_fields(std::size_t fields);

  TextColumns columns_;
  std::string sketch_;  // whose lines they are said to be
  wire::ByteLedger ledger_;
  std::vector<std::uint8_t> pending_;  // received, not yet booked
  std::string room_;                   // for a line without its colours
  bool at_line_start_;
  std::size_t usual_fields_ = 0;  // of the lines so far, 0: none yet
  std::size_t other_fields_ = 0;  // of the line before, if that was not the usual number
  LineSum sum_;
  bool is_contradicted_ = false;  // the words on the first lines say that they are not those of the sketch
  bool ended_ = false;
};

TextGyroScanner::TextGyroScanner(const GyroProfile& profile, StreamStart start)
    : columns_(profile.text),
      sketch_(profile.sketch),
      at_line_start_(!columns_.prefix.empty() || start == StreamStart::at_line_start) {}

void TextGyroScanner::push(Bytes bytes, std::vector<GyroMessage>& out) {
  assert(!ended_);
  ledger_.receive(bytes.size());
  wire::reassemble(pending_, bytes, learning_window, [&](Bytes rest) { return step(rest, out); });
  assert(pending_.size() == ledger_.waiting());
}

void TextGyroScanner::finish(std::vector<GyroMessage>& out) {
  ended_ = true;
  wire::reassemble_end(pending_, [&](Bytes rest) { return step(rest, out); });
  assert(pending_.size() == ledger_.waiting());
}

void TextGyroScanner::restart() {
  const wire::ByteLedger ledger = ledger_;
  *this = TextGyroScanner({.sketch = sketch_, .text = columns_}, StreamStart::anywhere);
  ledger_ = ledger;
  ledger_.restart();
}

std::size_t TextGyroScanner::step(Bytes rest, std::vector<GyroMessage>& out) {
  if (!at_line_start_) return skip_to_line_end(rest);
  const auto line = first_line(rest.first(std::min(rest.size(), line_window)), ended_);
  if (line && line->text.size() <= text_line_bytes_max) return take_line(*line, rest, out);
  if (!line && rest.size() < line_window) return 0;
  ++ledger_.counters.bad_length;
  return skip_to_line_end(rest);
}

std::size_t TextGyroScanner::skip_to_line_end(Bytes rest) {
  const std::size_t size = std::min(wire::bytes_before('\n', rest), wire::bytes_before('\r', rest));
  at_line_start_ = size < rest.size();
  const std::size_t skipped = at_line_start_ ? size + 1 : size;
  ledger_.book_gap(skipped);
  return skipped;
}

std::size_t TextGyroScanner::take_line(const RawLine& line, Bytes rest, std::vector<GyroMessage>& out) {
  const TextLine read = read_text_line(columns_, line.text, room_);
  if (is_blank(line.text) || !read.is_sample) return pass_over(line.bytes);
  if (read.reading && usual_fields_ == 0) usual_fields_ = learn_fields(rest);
  if (read.reading && usual_fields_ == 0) return 0;
  const bool is_usual = read.reading && has_usual_fields(read.fields);
  if (read.reading && !is_usual && ledger_.counters.messages == 0) return pass_over(line.bytes);
  const bool has_wrong_sum = is_usual && sum_.is_wrong(line.text);
  if (!is_usual || has_wrong_sum || is_contradicted_) {
    ++(has_wrong_sum ? ledger_.counters.bad_checksum : ledger_.counters.bad_value);
    ledger_.mark_damage(line.bytes);
    ledger_.book_gap(line.bytes);
    return line.bytes;
  }
  const StreamSpan span = ledger_.book_message(line.bytes);
  out.push_back({*read.reading, span, ledger_.take_gap()});
  ++ledger_.counters.messages;
  return line.bytes;
}

std::size_t TextGyroScanner::pass_over(std::size_t bytes) {
  ledger_.book_filler(bytes);
  return bytes;
}

/// The number of columns of the first two samples in a row that agree: one line alone may be a banner or the
/// tail of a line. 0 while more bytes are needed; the first line's where the window has no such two.
std::size_t TextGyroScanner::learn_fields(Bytes rest) {
  const Bytes window = rest.first(std::min(rest.size(), learning_window));
  std::size_t first = 0;
  std::size_t before = 0;
  std::size_t at = 0;
  while (const auto line = first_line(window.subspan(at), ended_)) {
    at += line->bytes;
    const TextLine read = read_text_line(columns_, line->text, room_);
    if (!read.reading || line->text.size() > text_line_bytes_max) continue;
    if (read.fields == before) {
      is_contradicted_ = speak_otherwise(window.first(at));
      return read.fields;
    }
    before = read.fields;
    if (first == 0) first = read.fields;
  }
  return ended_ || window.size() == learning_window ? first : 0;
}

bool TextGyroScanner::speak_otherwise(Bytes lines) const {
  if (sketch_.empty()) return false;
  const auto format = guess_text_format(lines, StreamStart::at_line_start);
  return format && !contradiction({.sketch = sketch_, .text = columns_}, *format).empty();
}

/// A lost line feed or comma changes the number of fields. Two lines in a row set a new usual number: the
/// layout has changed, and the columns may mean something else.
bool TextGyroScanner::has_usual_fields(std::size_t fields) {
  if (other_fields_ == fields) {
    usual_fields_ = fields;
    if (ledger_.counters.messages > 0) ++ledger_.counters.layout_changes;
  }
  other_fields_ = fields == usual_fields_ ? 0 : fields;
  return fields == usual_fields_;
}

constexpr std::array<UsualBaud, 2> text_bauds{{{115200, 0.15}, {9600, 0.11}}};

/// When the time begins again, no line tells.
ClockProperties text_clock(const GyroProfile& profile) {
  return {.tick_s = profile.text.time < 0 ? 0.0 : profile.text.time_unit_s};
}

constexpr std::uint64_t field_bytes = 8;  // a number as text, such as "-123.45", and its separator
constexpr std::uint64_t line_end_bytes = 2;

/// A line as long as the columns that are read; what a device prints behind them is not known.
std::uint64_t text_message_bytes(const GyroProfile& profile) {
  const TextColumns& text = profile.text;
  const int last = std::max(text.time, *std::max_element(text.rate.begin(), text.rate.end()));
  return text.prefix.size() + field_bytes * static_cast<std::uint64_t>(last + 1) + line_end_bytes;
}

GyroScanner text_scanner(const GyroProfile& profile, StreamStart start) {
  return GyroScanner(TextGyroScanner(profile, start));
}

std::optional<Evidence> recognise_text(Bytes bytes, double heard_s) {
  if (vectornav_gyro().recognise(bytes, heard_s)) return std::nullopt;
  std::optional<TextFormat> format = guess_text_format(bytes, StreamStart::anywhere, heard_s);
  if (!format) return std::nullopt;
  Evidence evidence{.messages = format->lines,
                    .bytes = format->bytes,
                    .text = fmt::format("{} lines of numbers, as a text gyro prints them", format->lines)};
  if (!format->sketch.empty())
    evidence.text = fmt::format("{} lines of numbers, as {} prints them", format->lines, format->sketch);
  if (!format->refusal.empty()) evidence.text = "lines of text: " + format->refusal;
  evidence.advice = format->advice;
  evidence.text_format = std::move(format);
  return evidence;
}

}  // namespace

GyroProtocol text_gyro() {
  return {.name = "text",
          .sends = "lines of text",
          .has_columns = true,
          .settings = {},
          .bauds = text_bauds,
          .clock = text_clock,
          .message_bytes = text_message_bytes,
          .scanner = text_scanner,
          .recognise = recognise_text};
}

}  // namespace thermorig::sensors
