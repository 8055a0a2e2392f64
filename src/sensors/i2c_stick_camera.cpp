// SPDX-License-Identifier: MIT
// An MLX90640 behind Melexis' I2C-Stick, which passes on the sensor's own words. Source:
// protocols/i2c_stick.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "raw_halves.h"
#include "thermorig/sensors/camera_protocol.h"

namespace thermorig::sensors {

namespace {

using wire::CameraMessage;

constexpr std::size_t stick_prefix_bytes = 7;  // "raw:33:", printed before the sensor has measured
constexpr std::size_t stick_words_at = 9;      // behind the milliseconds: "00012345:"
constexpr std::size_t stick_frame_bytes = stick_words_at + 5 * mlx90640::half_frame_words + 1;
constexpr std::size_t stick_line_bytes_max = 6000;  // its longest, with temperatures, has 5,400
constexpr std::size_t stick_text_bytes_max = 120;   // of its other lines
constexpr std::string_view eeprom_begin = "2400,10,01,0340,DATA,";
constexpr std::array<UsualBaud, 1> stick_bauds{{{1000000, 0.04}}};  // USB alone: any will do

bool is_line_end(char c) {
  return c == '\r' || c == '\n';
}

/// "FFDB,0012,..." of just so many words, each of four digits.
template <std::size_t Size>
bool read_words(std::string_view text, std::array<std::uint16_t, Size>& words) {
  if (text.size() != 5 * Size - 1) return false;
  for (std::size_t i = 0; i < Size; ++i) {
    const char* const begin = text.data() + 5 * i;
    const auto [end, error] = std::from_chars(begin, begin + 4, words[i], 16);
    if (error != std::errc() || end != begin + 4) return false;
    if (i + 1 < Size && *end != ',') return false;
  }
  return true;
}

/// Reads the stick's lines. Any chunking gives the same frames.
class I2cStickScanner {
 public:
  void push(std::span<const std::uint8_t> bytes, std::vector<CameraMessage>& out) {
    halves_.ledger.receive(bytes.size());
    for (const std::uint8_t byte : bytes) {
      line_ += static_cast<char>(byte);
      if (byte == '\n')
        end_line(out);
      else if (line_.size() == stick_line_bytes_max)
        skip_line();
    }
  }
  /// A last line without an end is not read: it may be cut.
  void finish(std::vector<CameraMessage>&) {}
  void restart() {
    halves_.restart();
    line_.clear();
    is_whole_ = false;
    own_images_ = binary_half_frames_ = 0;
  }
  const wire::Counters& counters() const { return halves_.ledger.counters; }

  std::uint64_t own_images() const { return own_images_; }
  /// In a format that has no end mark, so that a lost byte would move all words behind it: not read.
  std::uint64_t binary_half_frames() const { return binary_half_frames_; }
  const RawHalves& halves() const { return halves_; }

 private:
  void end_line(std::vector<CameraMessage>& out) {
    const std::string line = std::exchange(line_, {});
    const bool is_whole = std::exchange(is_whole_, true);
    std::string_view text = line;
    while (!text.empty() && is_line_end(text.back())) text.remove_suffix(1);
    if (!is_whole && !is_stick_line(text)) return halves_.ledger.book_filler(line.size());
    const std::size_t marked = mark_bytes(text);  // "@33:02:" of its continuous mode
    text.remove_prefix(marked);
    if (text.starts_with("raw:") && text.size() > stick_prefix_bytes)
      take_half_frame(text.substr(stick_prefix_bytes), marked + stick_prefix_bytes, line.size(), out);
    else if (text.starts_with("mr:") && text.size() > 6 && text.substr(6).starts_with(eeprom_begin))
      take_eeprom(text.substr(6 + eeprom_begin.size()), line.size());
    else
      take_other(text, line.size());
  }

  static std::size_t mark_bytes(std::string_view text) {
    return text.size() > 7 && text[0] == '@' && text[3] == ':' && text[6] == ':' ? 7 : 0;
  }
  static bool is_stick_line(std::string_view text) {
    text.remove_prefix(mark_bytes(text));
    return text.starts_with("raw:") || text.starts_with("mr:") || text.starts_with("mv:");
  }

  void take_half_frame(std::string_view text, std::size_t ahead, std::size_t size,
                       std::vector<CameraMessage>& out) {
    if (text.find("FAIL") != text.npos)  // "new_data bit set during read": torn
      return halves_.ledger.book_damaged(&wire::Counters::bad_value, size);
    RawHalves::Words words{};
    if (text.size() > stick_words_at && text.substr(stick_words_at).starts_with("BIN:"))
      ++binary_half_frames_;
    if (text.size() < stick_words_at || !read_words(text.substr(stick_words_at), words))
      return halves_.ledger.book_damaged(&wire::Counters::bad_length, size);
    halves_.take_half(words, ahead, size - ahead, out);
  }

  void take_eeprom(std::string_view text, std::size_t size) {
    RawHalves::Eeprom words{};
    if (!read_words(text, words)) return halves_.ledger.book_damaged(&wire::Counters::bad_length, size);
    halves_.take_eeprom(words, size);
  }

  /// Answers, banners, temperatures of its own; a long one of none of these is the rest of a lost line.
  void take_other(std::string_view text, std::size_t size) {
    if (text.starts_with("mv:33:")) ++own_images_;
    if (text.size() > stick_text_bytes_max && !is_stick_line(text))
      return halves_.ledger.book_damaged(&wire::Counters::bad_length, size);
    halves_.ledger.book_filler(size);
  }

  /// Nothing prints so long a line: it is passed over to its end.
  void skip_line() {
    halves_.ledger.book_damaged(&wire::Counters::bad_length, line_.size());
    line_.clear();
    is_whole_ = false;
  }

  RawHalves halves_;
  std::string line_;
  bool is_whole_ = false;  // the line was heard from its beginning
  std::uint64_t own_images_ = 0, binary_half_frames_ = 0;
};

CameraScanner i2c_stick_scanner(const CameraProfile&) {
  return CameraScanner(I2cStickScanner());
}

std::optional<Evidence> recognise_i2c_stick(std::span<const std::uint8_t> bytes) {
  I2cStickScanner scanner;
  std::vector<CameraMessage> messages;
  scanner.push(bytes, messages);
  const std::uint64_t heard =
      std::max({scanner.halves().half_frames(), scanner.own_images(), scanner.binary_half_frames()});
  if (heard == 0 && scanner.halves().eeprom_fault().empty() && !scanner.halves().has_eeprom())
    return std::nullopt;
  std::string text =
      fmt::format("{} raw half-frame(s) of a Melexis I2C-Stick", scanner.halves().half_frames());
  if (scanner.halves().half_frames() == 0 && scanner.own_images() > 0)
    text = fmt::format("{} image(s) of a Melexis I2C-Stick, made by its own filters", scanner.own_images());
  else if (scanner.halves().half_frames() == 0 && scanner.binary_half_frames() > 0)
    text = fmt::format("{} half-frame(s) of a Melexis I2C-Stick in its format BIN, which is not read",
                       scanner.binary_half_frames());
  else if (!scanner.halves().has_eeprom())
    text += ", without the sensor's EEPROM";
  Evidence evidence{.messages = std::max<std::uint64_t>(heard, 1),
                    .bytes = bytes.size(),
                    .text = std::move(text),
                    .text_format = {}};
  if (!scanner.halves().eeprom_fault().empty())
    evidence.advice = "its EEPROM cannot be used: " + scanner.halves().eeprom_fault();
  evidence.is_asked_otherwise = scanner.halves().half_frames() == 0;
  return evidence;
}

std::vector<std::uint8_t> stick_command(std::string_view text) {
  return {text.begin(), text.end()};
}

std::vector<std::uint8_t> ask_for_half_frame(const CameraProfile&) {
  return stick_command("raw:33\n");
}

/// So many half-frames are asked for ahead: it measures while the one before is under way.
constexpr std::string_view asks_ahead = "raw:33\nraw:33\nraw:33\nraw:33\nraw:33\nraw:33\n";
/// The line end closes what others have said to it, "!" stops its continuous mode.
constexpr std::string_view stick_begin = "\n!+ch:FORMAT=HEX\n+ch:I2C_FREQ=F400k\nmr:33:2400,0340\n";

/// The EEPROM is read at 400 kHz, as its data sheet demands; then 1 MHz, without which 8 half-frames a second
/// are late. Its register's refresh rate counts half-frames.
Commands i2c_stick_request(const CameraProfile& profile) {
  const double code = std::clamp(std::round(std::log2(2.0 * profile.output_rate_hz)), 0.0, 7.0);
  return {stick_command(stick_begin),
          stick_command(fmt::format("+ch:I2C_FREQ=F1M\n+cs:33:RR={:.0f}\n", code)),
          stick_command(asks_ahead)};
}

std::vector<std::uint8_t> i2c_stick_greeting() {
  return stick_command(std::string(stick_begin).append("raw:33\nraw:33\nraw:33\nraw:33\n"));
}

}  // namespace

CameraProtocol i2c_stick_camera() {
  return {.name = "i2c-stick",
          .sends = "raw half-frames of a Melexis I2C-Stick",
          .bauds = stick_bauds,
          .clock = {},
          .message_bytes = stick_frame_bytes,
          .scanner = i2c_stick_scanner,
          .recognise = recognise_i2c_stick,
          .request = i2c_stick_request,
          .greeting = i2c_stick_greeting,
          .next = ask_for_half_frame};
}

}  // namespace thermorig::sensors
