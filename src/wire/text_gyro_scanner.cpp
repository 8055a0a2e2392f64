// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cassert>
#include <utility>

#include "reassembly.h"
#include "text_line.h"
#include "thermorig/wire/gyro_scanner.h"

namespace thermorig::wire {

namespace {

constexpr std::size_t line_bytes_max = 256;  // without the line feed; no gyro prints longer lines

std::string_view as_text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t\r") == std::string_view::npos;
}

}  // namespace

TextGyroScanner::TextGyroScanner(TextColumns columns)
    : columns_(std::move(columns)), at_line_start_(!columns_.prefix.empty()) {}

void TextGyroScanner::push(std::span<const std::uint8_t> bytes, std::vector<GyroMessage>& out) {
  ledger_.receive(bytes.size());
  reassemble(pending_, bytes, line_bytes_max + 1, [&](Bytes rest) { return step(rest, out); });
  assert(pending_.size() == ledger_.counters.bytes_pending);
}

std::size_t TextGyroScanner::step(Bytes rest, std::vector<GyroMessage>& out) {
  if (!at_line_start_) return skip_to_line_end(rest);
  const Bytes window = rest.first(std::min(rest.size(), line_bytes_max + 1));
  const std::size_t size = bytes_before('\n', window);
  if (size < window.size()) {
    take_line(as_text(window.first(size)), size + 1, out);
    return size + 1;
  }
  if (size <= line_bytes_max) return 0;
  ++ledger_.counters.bad_length;
  return skip_to_line_end(rest);
}

std::size_t TextGyroScanner::skip_to_line_end(Bytes rest) {
  const std::size_t size = bytes_before('\n', rest);
  at_line_start_ = size < rest.size();
  const std::size_t skipped = at_line_start_ ? size + 1 : size;
  ledger_.book_gap(skipped);
  return skipped;
}

void TextGyroScanner::take_line(std::string_view line, std::size_t bytes, std::vector<GyroMessage>& out) {
  const TextLine read = read_text_line(columns_, line);
  if (is_blank(line) || !read.is_sample) return ledger_.book_filler(bytes);
  if (!read.reading || !has_usual_fields(read.fields)) {
    ++ledger_.counters.bad_value;
    ledger_.mark_damage(bytes);
    return ledger_.book_gap(bytes);
  }
  const StreamSpan span = ledger_.book_message(bytes);
  out.push_back({*read.reading, span, ledger_.take_gap()});
  ++ledger_.counters.messages;
}

/// A lost line feed or comma changes the number of fields. Two lines in a row set a new usual number.
bool TextGyroScanner::has_usual_fields(std::size_t fields) {
  if (usual_fields_ == 0 || other_fields_ == fields) usual_fields_ = fields;
  other_fields_ = fields == usual_fields_ ? 0 : fields;
  return fields == usual_fields_;
}

}  // namespace thermorig::wire
