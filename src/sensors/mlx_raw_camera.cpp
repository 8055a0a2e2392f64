// SPDX-License-Identifier: MIT
// A sensor of Melexis on a bus of this computer, or behind a board that passes on its words as mlx_raw.h
// frames them. Source: protocols/mlx_raw.md.
#include <fmt/format.h>
#include <mlx_raw.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "raw_halves.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/wire/checksums.h"
#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::sensors {

namespace {

using wire::Bytes;
using wire::CameraMessage;

constexpr std::size_t raw_sum_bytes = MLX_RAW_SUM_BYTES, raw_words_at = MLX_RAW_HEADER_BYTES;
constexpr std::size_t raw_sign_bytes = raw_words_at + 2 * MLX_RAW_NEW_DATA_WORDS + raw_sum_bytes;
constexpr std::size_t raw_half_bytes = raw_words_at + 2 * MLX_RAW_HALF_WORDS + raw_sum_bytes;
constexpr std::array<UsualBaud, 1> raw_bauds{{{921600, 0.03}}};  // of a board: 16 half-frames a second

std::uint16_t raw_word(Bytes words, std::size_t index) {
  return static_cast<std::uint16_t>(words[2 * index] << 8 | words[2 * index + 1]);
}

/// Of a message that begins there: its size; 0 if more bytes are needed; none if there is no message.
std::optional<std::size_t> raw_size(Bytes rest) {
  if (rest[0] != MLX_RAW_MARK_0 || (rest.size() > 1 && rest[1] != MLX_RAW_MARK_1)) return std::nullopt;
  if (rest.size() < raw_words_at) return 0;
  const std::uint16_t words = mlx_raw_words(rest[2]);
  if (words == 0 || words != (rest[3] << 8 | rest[4])) return std::nullopt;
  return mlx_raw_size(words);
}

bool is_sum_right(Bytes message) {
  return wire::crc16_xmodem(message) == 0;  // over itself as well
}

class MlxRawScanner {
 public:
  void push(Bytes bytes, std::vector<CameraMessage>& out) {
    halves_.ledger.receive(bytes.size());
    wire::reassemble(pending_, bytes, raw_sign_bytes + raw_half_bytes + 1,
                     [&](Bytes rest) { return step(rest, out); });
  }
  /// A last message without its end is not read.
  void finish(std::vector<CameraMessage>&) {}
  void restart() {
    halves_.restart();
    last_image_ = {};
    pending_.clear();
    own_images_ = 0;
    bus_fault_.clear();
  }
  const wire::Counters& counters() const { return halves_.ledger.counters; }

  std::uint64_t own_images() const { return own_images_; }
  const RawHalves& halves() const { return halves_; }
  const std::string& bus_fault() const { return bus_fault_; }

 private:
  std::size_t step(Bytes rest, std::vector<CameraMessage>& out) {
    if (rest[0] != MLX_RAW_MARK_0) return skip(wire::bytes_before(MLX_RAW_MARK_0, rest));
    const auto size = raw_size(rest);
    if (!size) return skip(1);
    if (*size == 0 || rest.size() < *size) return 0;
    if (!is_sum_right(rest.first(*size))) return refuse(*size);
    if (rest[2] == MLX_RAW_NEW_DATA) return take_sign(rest, out);
    return take(rest.first(*size), 0, out);
  }

  /// The half-frame behind it began when the sign came: the sensor had measured, and was read from then on.
  std::size_t take_sign(Bytes rest, std::vector<CameraMessage>& out) {
    const Bytes behind = rest.subspan(raw_sign_bytes);
    const auto size = behind.empty() ? 0 : raw_size(behind);
    const bool may_be_half =
        size && (behind.size() < 3 || behind[2] == MLX_RAW_HALF || behind[2] == MLX_RAW_IMAGE);
    if (may_be_half && (*size == 0 || behind.size() < *size)) return 0;
    if (may_be_half && is_sum_right(behind.first(*size)))
      return take(rest.first(raw_sign_bytes + *size), raw_sign_bytes, out);
    halves_.ledger.book_filler(raw_sign_bytes);
    return raw_sign_bytes;
  }

  /// `ahead` bytes of a sign belong to the message.
  std::size_t take(Bytes whole, std::size_t ahead, std::vector<CameraMessage>& out) {
    const Bytes message = whole.subspan(ahead);
    const Bytes words = message.subspan(raw_words_at);
    switch (message[2]) {
      case MLX_RAW_EEPROM:
        take_eeprom(words, whole.size());
        break;
      case MLX_RAW_HALF:
        take_half(words, whole.size(), out);
        break;
      case MLX_RAW_IMAGE:
        take_image(words, whole.size(), out);
        break;
      default:
        take_bus_fault(words, whole.size());
    }
    return whole.size();
  }

  void take_eeprom(Bytes bytes, std::size_t size) {
    RawHalves::Eeprom words{};
    for (std::size_t i = 0; i < words.size(); ++i) words[i] = raw_word(bytes, i);
    halves_.take_eeprom(words, size);
  }

  void take_half(Bytes bytes, std::size_t size, std::vector<CameraMessage>& out) {
    RawHalves::Words words{};
    for (std::size_t i = 0; i < words.size(); ++i) words[i] = raw_word(bytes, i);
    halves_.take_half(words, 0, size, out);
  }

  /// An MLX90642 computes degrees itself: 1/50 K; its own temperature 1/100 K.
  void take_image(Bytes bytes, std::size_t size, std::vector<CameraMessage>& out) {
    constexpr std::uint16_t ready = 0x0100;  // again, since it was read: torn
    CameraMessage message;
    bool is_new = false, is_good = (raw_word(bytes, frame_pixels + 1) & ready) == 0;
    for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel) {
      const auto counts = static_cast<std::int16_t>(raw_word(bytes, pixel));
      message.frame.temp_c[pixel] = static_cast<float>(counts) / 50.0F;
      is_good = is_good && message.frame.temp_c[pixel] >= coldest_pixel_c &&
                message.frame.temp_c[pixel] <= hottest_pixel_c;
      is_new = is_new || counts != last_image_[pixel];
      last_image_[pixel] = counts;
    }
    if (!is_good) return halves_.ledger.book_damaged(&wire::Counters::bad_value, size);
    const auto own = static_cast<std::int16_t>(raw_word(bytes, frame_pixels));
    message.frame.sensor_temp_c = static_cast<float>(own) / 100.0F;
    ++own_images_;
    if (is_new) message.fresh = {frame_pixels / 2, frame_pixels / 2};
    halves_.ledger.book_data(message, size);
    out.push_back(message);
  }

  void take_bus_fault(Bytes words, std::size_t size) {
    const double rate_hz = std::ldexp(0.5, raw_word(words, 0) & 7);
    bus_fault_ = fmt::format(
        "its bus takes {} ms to read a half-frame, too long for {:g} a second: at 400 kHz it takes 40 "
        "(Raspberry Pi: dtparam=i2c_arm=on,i2c_arm_baudrate=400000 in /boot/firmware/config.txt, then "
        "restart; MCP2221: options hid_mcp2221 i2c_clk_freq=400 in /etc/modprobe.d); or ask for fewer: "
        "--camera-rate",
        raw_word(words, 1), rate_hz);
    halves_.ledger.book_reply(size);
  }

  std::size_t refuse(std::size_t size) {
    ++halves_.ledger.counters.bad_checksum;
    halves_.ledger.mark_damage(size);
    return skip(1);
  }
  std::size_t skip(std::size_t bytes) {
    halves_.ledger.book_gap(bytes);
    return bytes;
  }

  RawHalves halves_;
  std::array<std::int16_t, frame_pixels> last_image_{};
  std::vector<std::uint8_t> pending_;  // received, not yet booked
  std::uint64_t own_images_ = 0;
  std::string bus_fault_;
};

CameraScanner mlx_raw_scanner(const CameraProfile&) {
  return CameraScanner(MlxRawScanner());
}

std::optional<Evidence> recognise_mlx_raw(Bytes bytes) {
  MlxRawScanner scanner;
  std::vector<CameraMessage> messages;
  scanner.push(bytes, messages);
  const std::uint64_t heard = scanner.halves().half_frames() + scanner.own_images();
  const std::string& fault =
      scanner.bus_fault().empty() ? scanner.halves().eeprom_fault() : scanner.bus_fault();
  if (heard == 0 && fault.empty() && !scanner.halves().has_eeprom()) return std::nullopt;
  Evidence evidence{
      .messages = std::max<std::uint64_t>(heard, 1),
      .bytes =
          std::max<std::uint64_t>(scanner.counters().bytes_in_messages, fault.empty() ? 0 : bytes.size()),
      .text = fmt::format("{} raw half-frame(s) of an MLX90640", scanner.halves().half_frames()),
      .text_format = {}};
  if (heard == 0) evidence.text = "the EEPROM of an MLX90640, and no half-frame";
  if (scanner.own_images() > 0)
    evidence.text = fmt::format("{} image(s) of an MLX90642", scanner.own_images());
  else if (heard > 0 && !scanner.halves().has_eeprom())
    evidence.text += ", without the sensor's EEPROM";
  if (!scanner.bus_fault().empty())
    evidence.advice = scanner.bus_fault();
  else if (!fault.empty())
    evidence.advice = "its EEPROM cannot be used: " + fault;
  evidence.is_asked_otherwise = heard == 0;
  return evidence;
}

std::vector<std::uint8_t> raw_command(char rate) {
  std::string text = MLX_RAW_COMMAND;
  text += {rate, '\n'};
  return {text.begin(), text.end()};
}

/// The register's refresh rate counts half-frames.
Commands mlx_raw_request(const CameraProfile& profile) {
  const double code = std::clamp(std::round(std::log2(2.0 * profile.output_rate_hz)), 0.0, 7.0);
  return {raw_command(static_cast<char>('0' + static_cast<int>(code)))};
}

std::vector<std::uint8_t> mlx_raw_greeting() {
  return raw_command('-');
}

}  // namespace

CameraProtocol mlx_raw_camera() {
  return {.name = "mlx-raw",
          .sends = "raw half-frames of an MLX90640",
          .bauds = raw_bauds,
          .clock = {},
          .message_bytes = raw_sign_bytes + raw_half_bytes,
          .scanner = mlx_raw_scanner,
          .recognise = recognise_mlx_raw,
          .request = mlx_raw_request,
          .greeting = mlx_raw_greeting};
}

}  // namespace thermorig::sensors
