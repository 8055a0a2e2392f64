// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cassert>
#include <utility>

#include "reassembly.h"
#include "text_fields.h"
#include "text_line.h"
#include "thermorig/wire/gyro_scanner.h"

namespace thermorig::wire {

namespace {

constexpr std::size_t line_bytes_max = 256;  // without the line end; no gyro prints longer lines
constexpr std::size_t line_window = line_bytes_max + 2;
constexpr std::size_t learning_window = 4 * line_window;

}  // namespace

TextGyroScanner::TextGyroScanner(TextColumns columns, StreamStart start)
    : columns_(std::move(columns)),
      at_line_start_(!columns_.prefix.empty() || start == StreamStart::at_line_start) {}

void TextGyroScanner::push(std::span<const std::uint8_t> bytes, std::vector<GyroMessage>& out) {
  assert(!ended_);
  ledger_.receive(bytes.size());
  reassemble(pending_, bytes, learning_window, [&](Bytes rest) { return step(rest, out); });
  assert(pending_.size() == ledger_.counters.bytes_pending);
}

void TextGyroScanner::finish(std::vector<GyroMessage>& out) {
  ended_ = true;
  reassemble_end(pending_, [&](Bytes rest) { return step(rest, out); });
  assert(pending_.size() == ledger_.counters.bytes_pending);
}

std::size_t TextGyroScanner::step(Bytes rest, std::vector<GyroMessage>& out) {
  if (!at_line_start_) return skip_to_line_end(rest);
  const auto line = first_line(rest.first(std::min(rest.size(), line_window)), ended_);
  if (line && line->text.size() <= line_bytes_max) return take_line(*line, rest, out);
  if (!line && rest.size() < line_window) return 0;
  ++ledger_.counters.bad_length;
  return skip_to_line_end(rest);
}

std::size_t TextGyroScanner::skip_to_line_end(Bytes rest) {
  const std::size_t size = std::min(bytes_before('\n', rest), bytes_before('\r', rest));
  at_line_start_ = size < rest.size();
  const std::size_t skipped = at_line_start_ ? size + 1 : size;
  ledger_.book_gap(skipped);
  return skipped;
}

std::size_t TextGyroScanner::take_line(const RawLine& line, Bytes rest, std::vector<GyroMessage>& out) {
  const TextLine read = read_text_line(columns_, line.text);
  if (is_blank(line.text) || !read.is_sample) return pass_over(line.bytes);
  if (read.reading && usual_fields_ == 0) usual_fields_ = learn_fields(rest);
  if (read.reading && usual_fields_ == 0) return 0;
  const bool is_usual = read.reading && has_usual_fields(read.fields);
  if (read.reading && !is_usual && ledger_.counters.messages == 0) return pass_over(line.bytes);
  if (!is_usual) {
    ++ledger_.counters.bad_value;
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
std::size_t TextGyroScanner::learn_fields(Bytes rest) const {
  const Bytes window = rest.first(std::min(rest.size(), learning_window));
  std::size_t first = 0;
  std::size_t before = 0;
  std::size_t at = 0;
  while (const auto line = first_line(window.subspan(at), ended_)) {
    at += line->bytes;
    const TextLine read = read_text_line(columns_, line->text);
    if (!read.reading || line->text.size() > line_bytes_max) continue;
    if (read.fields == before) return read.fields;
    before = read.fields;
    if (first == 0) first = read.fields;
  }
  return ended_ || window.size() == learning_window ? first : 0;
}

/// A lost line feed or comma changes the number of fields. Two lines in a row set a new usual number.
bool TextGyroScanner::has_usual_fields(std::size_t fields) {
  if (other_fields_ == fields) usual_fields_ = fields;
  other_fields_ = fields == usual_fields_ ? 0 : fields;
  return fields == usual_fields_;
}

}  // namespace thermorig::wire
