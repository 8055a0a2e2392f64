// SPDX-License-Identifier: MIT
// Cameras whose sketch prints temperatures. Source: protocols/text_camera.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "text_fields.h"
#include "text_words.h"
#include "thermorig/core/freshness.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/wire/byte_ledger.h"

namespace thermorig::sensors {

namespace {

using wire::CameraMessage;

constexpr float unknown_c = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t token_bytes_max = 32;                // a double printed in full has 24
constexpr std::size_t line_bytes_max = frame_pixels * 26;  // a number in full and what separates it
constexpr std::size_t usual_frame_bytes = frame_pixels * 7 + frame_rows * 2;  // "-23.4, ", a row a line
constexpr std::array<UsualBaud, 2> text_camera_bauds{{{460800, 0.12}, {115200, 0.15}}};

/// One line, token by token.
class Line {
 public:
  void take(char c) {
    ++bytes_;
    if (c == '\0') return;  // the end of a C string, sent with it
    const bool is_of_token = is_letter(c) || is_digit(c) || c == '.' || c == '-' || c == '+';
    if (is_of_token && token_.size() <= token_bytes_max) token_ += c;
    if (is_of_token) return;
    end_token();
    if (c == '[') value_of_word_.reset(), behind_word_ = false;  // "temperature":[ holds pixels
    if (c == ':') take_colon();
    is_broken_ |= std::string_view(" \t\r\n,;[]{}()\"':=|>").find(c) == std::string_view::npos;  // "1.#QNAN"
  }
  void end() {
    end_token();
    take_value_of_word();
  }

  std::size_t bytes() const { return bytes_; }
  /// A whole number in front of 768 with decimals is a count or a time, no pixel.
  bool is_numbered() const { return numbers_ == frame_pixels + 1 && begins_with_count(); }
  /// Such a number in front of 767: a pixel is missing.
  bool is_short_of_one() const { return numbers_ == frame_pixels && begins_with_count(); }
  std::size_t numbers() const { return is_numbered() ? numbers_ - 1 : numbers_; }
  bool is_temperatures() const {
    return !is_broken_ && !(first_is_broken_ && !is_numbered()) && has_decimals_;
  }
  std::span<const float> values() const {
    return std::span(values_).first(std::min(numbers_, values_.size())).subspan(is_numbered() ? 1 : 0);
  }
  float sensor_temp_c() const { return sensor_temp_c_; }  // NaN: the line does not say it

 private:
  bool begins_with_count() const { return without_point_ == 1 && !first_has_point_; }

  void end_token() {
    if (token_.empty()) return;
    const std::string token = std::exchange(token_, {});
    if (token.find_first_not_of('-') == token.npos) return;  // a line of marks, an arrow
    const auto number = token.size() <= token_bytes_max ? read_number(token) : std::nullopt;
    const bool is_number = number && digits_of(token).size() + (token[0] == '+' ? 1U : 0U) == token.size();
    if (is_number)
      take_number(*number, !std::isfinite(*number) || token.find_first_of(".eE") != token.npos);
    else
      take_word(token);
  }

  /// Of "Frame 3:" and "12:34:51.123 ->" no number is a pixel.
  void take_colon() {
    if (value_of_word_) return take_value_of_word();
    if (!behind_number_) return;
    if (is_pushed_) {
      --numbers_;
      without_point_ -= is_pushed_decimal_ ? 0U : 1U;
    }
    drops_next_ = true;
  }

  /// What Arduino prints for a number that is none stands in a pixel's place.
  void take_word(std::string token) {
    std::transform(token.begin(), token.end(), token.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    if (token == "ovf" || token == "null" || token == "none") return take_number(std::nan(""), true);
    take_value_of_word();
    behind_number_ = false;
    is_ambient_ =
        token == "at" || token == "ta" || token == "ambient" || (is_ambient_ && token == "temperature");
    behind_word_ = true;
  }

  /// "Ambient temperature = 27.4" is no pixel; "frame: 23.1, 23.2, ..." begins with one.
  void take_number(double number, bool is_decimal) {
    behind_number_ = true;
    is_pushed_ = false;
    if (std::exchange(drops_next_, false)) return;
    if (std::exchange(behind_word_, false)) {
      value_of_word_ = number;
      value_is_decimal_ = is_decimal;
      return;
    }
    if (const auto first = std::exchange(value_of_word_, std::nullopt)) push(*first, value_is_decimal_);
    push(number, is_decimal);
  }
  void push(double number, bool is_decimal) {
    const auto temp_c = static_cast<float>(number);
    const bool is_pixel = temp_c >= coldest_pixel_c && temp_c <= hottest_pixel_c;
    if (numbers_ == 0) first_is_broken_ = !is_pixel;
    if (numbers_ > 0) is_broken_ |= !is_pixel;
    has_decimals_ |= is_decimal;
    without_point_ += is_decimal ? 0U : 1U;
    if (numbers_ == 0) first_has_point_ = is_decimal;
    if (numbers_ < values_.size()) values_[numbers_] = temp_c;
    ++numbers_;
    is_pushed_ = true;
    is_pushed_decimal_ = is_decimal;
  }
  void take_value_of_word() {
    if (const auto value = std::exchange(value_of_word_, std::nullopt); value && is_ambient_)
      sensor_temp_c_ = static_cast<float>(*value);
  }

  std::size_t bytes_ = 0;
  std::string token_;
  std::array<float, frame_pixels + 1> values_{};
  std::size_t numbers_ = 0, without_point_ = 0;
  bool has_decimals_ = false;
  bool first_has_point_ = false;  // the first number
  bool first_is_broken_ = false;
  bool is_broken_ = false;  // a value that is no temperature
  bool behind_number_ = false, is_pushed_ = false, is_pushed_decimal_ = false, drops_next_ = false;
  bool behind_word_ = false, is_ambient_ = false, value_is_decimal_ = false;
  std::optional<double> value_of_word_;
  float sensor_temp_c_ = unknown_c;
};

/// Whole numbers that differ, printed as "128.0".
bool are_grey_values(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return value == std::trunc(value); }) &&
         std::any_of(values.begin(), values.end(), [&](float value) { return value != values.front(); });
}

/// Reads frames of 768 temperatures as text: in one line, in 24 lines of 32, or a pixel a line with its row
/// and column. Any chunking gives the same frames.
///
/// Text has no check sum. A frame of rows lies between two lines without pixels (words, marks, an empty one),
/// a line of 768 is one wherever it stands, and what has not exactly 768 numbers is damaged as a whole: no
/// number ever moves to another pixel.
class TextCameraScanner {
 public:
  void push(std::span<const std::uint8_t> bytes, std::vector<CameraMessage>& out) {
    ledger_.receive(bytes.size());
    for (const std::uint8_t byte : bytes) {
      const char c = static_cast<char>(byte);
      if (std::exchange(behind_return_, c == '\r') && c != '\n') end_line(out);
      line_.take(c);
      if (c == '\n') end_line(out);
      if (line_.bytes() == line_bytes_max) skip_line();
    }
  }
  /// A last line without an end is not read: it may be cut inside a number.
  void finish(std::vector<CameraMessage>& out) {
    if (std::exchange(behind_return_, false)) end_line(out);
    if (is_held_) complete(out);
  }
  void restart() {
    wire::ByteLedger ledger = ledger_;
    ledger.restart();
    *this = TextCameraScanner();
    ledger_ = ledger;
  }
  const wire::Counters& counters() const { return ledger_.counters; }

 private:
  void end_line(std::vector<CameraMessage>& out) {
    line_.end();
    const Line line = std::exchange(line_, Line());
    const bool was_joined = std::exchange(is_joined_, true);
    if (std::exchange(is_overlong_, false)) return lose(line);
    if (is_held_) line.numbers() == 0 ? complete(out) : drop_frame_without_mark();
    if (!std::isnan(line.sensor_temp_c())) sensor_temp_c_ = line.sensor_temp_c();
    if (line.numbers() == frame_pixels && !line.is_short_of_one()) {
      drop_frame();
      is_as_before(line, was_joined) ? add(line, line.values()) : lose(line);
    } else if (line.numbers() == 0) {
      drop_frame();
      ledger_.book_filler(line.bytes());
      is_synced_ = true;
    } else if (const auto first = pixel_of(line, 0)) {
      drop_frame();
      add(line, std::span(&*first, 1));
    } else if (const auto pixel = pixel_of(line, pixels_); pixel && pixels_ > 0) {
      add(line, std::span(&*pixel, 1));
    } else if (line.numbers() == frame_columns && is_synced_) {
      add(line, line.values());
    } else {
      lose(line);
    }
    if (pixels_ < frame_pixels) return;
    is_held_ = line.numbers() == frame_columns;
    if (!is_held_) complete(out);
  }

  /// Whether a line of 768 has a count in front where those before had one: else it may have lost a digit or
  /// a pixel. Of two that differ in a row the second says what is usual.
  bool is_as_before(const Line& line, bool was_joined) {
    if (!was_joined || !line.is_temperatures())
      return is_numbered_.value_or(line.is_numbered()) == line.is_numbered();
    const bool is_usual = !is_numbered_ || *is_numbered_ == line.is_numbered() || was_unusual_;
    was_unusual_ = !is_usual;
    if (is_usual) is_numbered_ = line.is_numbered();
    return is_usual;
  }

  /// Rows tell a frame only between two marks: after one that is lost, or came twice, all others stand one
  /// row off.
  void drop_frame_without_mark() {
    drop_frame();
    is_synced_ = false;
  }

  /// "frame,row,column,temperature" of that pixel.
  static std::optional<float> pixel_of(const Line& line, std::size_t pixel) {
    if (line.numbers() != 4) return std::nullopt;
    const auto values = line.values();
    const auto row = static_cast<float>(pixel / frame_columns),
               column = static_cast<float>(pixel % frame_columns);
    return values[1] == row && values[2] == column ? std::optional(values[3]) : std::nullopt;
  }

  void add(const Line& line, std::span<const float> values) {
    if (pixels_ + values.size() > frame_pixels) return lose(line);
    std::copy(values.begin(), values.end(), temp_c_.begin() + static_cast<std::ptrdiff_t>(pixels_));
    pixels_ += values.size();
    bytes_ += line.bytes();
    is_temperatures_ &= line.is_temperatures();
  }

  void complete(std::vector<CameraMessage>& out) {
    is_synced_ = true;
    if (!is_temperatures_ || is_half_an_image(temp_c_) || are_grey_values(temp_c_)) {
      ledger_.book_damaged(&wire::Counters::bad_value, bytes_);
    } else {
      CameraMessage& message = out.emplace_back();
      message.frame.temp_c = temp_c_;
      message.frame.sensor_temp_c = std::exchange(sensor_temp_c_, unknown_c);
      message.fresh = freshness_.push(temp_c_);
      ledger_.book_data(message, bytes_);
    }
    begin_frame();
  }

  /// Nothing prints so long a line: it is passed over to its end.
  void skip_line() {
    lose(line_);
    line_ = Line();
    is_overlong_ = true;
  }

  /// A frame of which lines are missing.
  void drop_frame() {
    if (pixels_ == 0) return;
    ledger_.book_damaged(&wire::Counters::bad_length, bytes_);
    begin_frame();
  }

  /// A line that is no part of a frame; the frame that it stands in is lost. Before the first break it may be
  /// the tail of one.
  void lose(const Line& line) {
    if (pixels_ > 0 || is_synced_) {
      ledger_.book_damaged(&wire::Counters::bad_length, bytes_ + line.bytes());
    } else {
      ledger_.book_filler(line.bytes());
    }
    begin_frame();
    is_synced_ = false;
  }

  void begin_frame() {
    pixels_ = bytes_ = 0;
    is_held_ = false;
    is_temperatures_ = true;
  }

  wire::ByteLedger ledger_;
  FreshnessDetector<float> freshness_;
  Line line_;
  bool is_held_ = false;      // the rows are there: the next line tells whether they are a frame
  bool is_overlong_ = false;  // the line that is being read
  bool behind_return_ = false;
  bool was_unusual_ = false;         // the last line of 768: see is_as_before()
  bool is_joined_ = false;           // a line has ended: the first one may be the tail of one
  std::optional<bool> is_numbered_;  // lines of 768, by the first whole one: a digit cut off is no count
  bool is_synced_ = false;           // the next line may begin a frame, or goes on with one
  std::array<float, frame_pixels> temp_c_{};
  std::size_t pixels_ = 0;
  std::size_t bytes_ = 0;  // of the lines that hold them
  bool is_temperatures_ = true;
  float sensor_temp_c_ = unknown_c;
};

/// "Temp (F)", {"unit":"F"}, "71.2 degF".
bool says_fahrenheit(std::span<const std::uint8_t> bytes) {
  std::string text(bytes.begin(), bytes.end());
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  constexpr auto words =
      std::to_array<std::string_view>({"fahrenheit", "degf", "deg f", "(f)", "[f]", ":\"f\"", ": \"f\"",
                                       "\xC2\xB0"
                                       "f"});
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
    for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1))
      if (const std::size_t end = at + word.size(); end == text.size() || !is_letter(text[end])) return true;
    return false;  // "55 deg FOV"
  });
}

CameraScanner text_camera_scanner(const CameraProfile&) {
  return CameraScanner(TextCameraScanner());
}

std::optional<Evidence> recognise_text_camera(std::span<const std::uint8_t> bytes) {
  TextCameraScanner scanner;
  std::vector<CameraMessage> messages;
  scanner.push(bytes, messages);
  scanner.finish(messages);
  if (messages.empty()) return std::nullopt;
  Evidence evidence{.messages = messages.size(),
                    .bytes = scanner.counters().bytes_in_messages,
                    .text = fmt::format("{} image(s) of 768 temperatures as text", messages.size()),
                    .text_format = {},
                    .advice = advice_on_unit(messages.front().frame)};
  if (const std::string doubt = doubt_on_unit(messages.front().frame); !doubt.empty())
    evidence.text += "; " + doubt;
  if (says_fahrenheit(bytes))
    evidence.advice = "its words say Fahrenheit: print degrees Celsius in the sketch";
  return evidence;
}

}  // namespace

CameraProtocol text_camera() {
  return {.name = "text",
          .sends = "images of 768 temperatures as text",
          .bauds = text_camera_bauds,
          .clock = {},
          .message_bytes = usual_frame_bytes,
          .scanner = text_camera_scanner,
          .recognise = recognise_text_camera,
          .merges_halves = true,
          .doubt = doubt_on_unit};
}

}  // namespace thermorig::sensors
