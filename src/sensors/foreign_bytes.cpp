// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <string_view>

#include "text_fields.h"
#include "text_words.h"
#include "thermorig/core/git_lfs.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/text_format.h"
#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::sensors {

namespace {

using wire::Bytes;

constexpr std::size_t frames_needed = 3;  // in a row: two marks that stand right by chance do so rarely twice

Evidence evidence_of(Bytes bytes, std::string text, std::string advice) {
  return {.messages = 0,
          .bytes = bytes.size(),
          .text = std::move(text),
          .text_format = {},
          .advice = std::move(advice)};
}

std::optional<Evidence> git_lfs_pointer(Bytes bytes) {
  if (!is_git_lfs_pointer({reinterpret_cast<const char*>(bytes.data()), bytes.size()})) return std::nullopt;
  return evidence_of(bytes, "a Git LFS pointer, not the file itself", git_lfs_advice);
}

/// Text of two bytes a character: one of each pair is 0, the other is not.
std::optional<Evidence> utf16_text(Bytes bytes) {
  std::array<std::size_t, 2> zeros{}, characters{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    zeros[i % 2] += bytes[i] == 0 ? 1U : 0U;
    characters[i % 2] +=
        bytes[i] == '\r' || bytes[i] == '\n' || bytes[i] == '\t' || (bytes[i] >= ' ' && bytes[i] < 0x7F);
  }
  const std::size_t half = bytes.size() / 2;
  const auto is_most = [&](std::size_t count) { return half >= 8 && count >= half - half / 16; };
  if (!(is_most(zeros[0]) && is_most(characters[1])) && !(is_most(zeros[1]) && is_most(characters[0])))
    return std::nullopt;
  return evidence_of(
      bytes, "text in UTF-16, as a Windows shell redirects it",
      "iconv -f UTF-16 -t UTF-8 FILE | thermorig decode --device gyro -; or log with another program");
}

bool is_hex(std::string_view text) {
  return text.find_first_not_of("0123456789abcdefABCDEF") == text.npos;
}

/// "55 51 0A 00", "0x55,0x51" or "55510a00", with an offset in front or without.
struct HexLine {
  bool is_hex = false, has_letter = false, has_offset = false;
};
HexLine hex_line(std::string_view line) {
  HexLine result;
  std::size_t bytes = 0;
  Fields fields(line);
  for (std::size_t i = 0; const auto field = fields.next(); ++i) {
    std::string_view token = field->text;
    if (i == 0 && token.size() >= 4 && (token.ends_with(':') || token.size() >= 7) &&
        is_hex(token.substr(0, token.size() - 1))) {
      result.has_offset = token.ends_with(':') || token.find_first_not_of('0') == token.npos;
      if (result.has_offset) continue;
    }
    if (token.starts_with("0x") || token.starts_with("0X")) token.remove_prefix(2);
    if (!is_hex(token) || token.size() % 2 != 0 || token.empty()) {
      if (bytes >= 8) break;  // the characters that a dump shows beside the bytes
      return result;
    }
    bytes += token.size() / 2;
    result.has_letter |= std::any_of(token.begin(), token.end(), [](char c) { return c > '9'; });
  }
  result.is_hex = bytes >= 8;
  return result;
}

std::optional<Evidence> hex_text(Bytes bytes) {
  std::size_t lines = 0, of_hex = 0, with_letter = 0, with_offset = 0;
  for_each_line(bytes, [&](const RawLine& line) {
    if (is_blank(line.text)) return;
    const HexLine hex = is_text(line.text) ? hex_line(line.text) : HexLine();
    ++lines;
    of_hex += hex.is_hex ? 1U : 0U;
    with_letter += hex.is_hex && hex.has_letter ? 1U : 0U;
    with_offset += hex.is_hex && hex.has_offset ? 1U : 0U;
  });
  if (lines < 2 || of_hex < lines - lines / 8 || 2 * with_letter < of_hex) return std::nullopt;
  return evidence_of(bytes, "hex text of a dump, not its bytes",
                     fmt::format("xxd -r {}FILE dump.bin, then thermorig decode dump.bin",
                                 2 * with_offset > of_hex ? "" : "-p "));
}

/// A table of numbers with so many columns that it is a picture, but none that is read as temperatures.
std::optional<Evidence> image_text(Bytes bytes) {
  std::size_t lines = 0, rows = 0, columns = 0;
  bool holds_words = false, has_decimals = false;
  for_each_line(bytes, [&](const RawLine& line) {
    if (is_blank(line.text) || !is_text(line.text)) return;
    std::size_t fields = 0, numbers = 0;
    for (const TextField& field : split_fields(line.text)) {
      ++fields;
      numbers += read_number(field.value) ? 1U : 0U;
      has_decimals |= field.value.find('.') != field.value.npos;
    }
    ++lines;
    holds_words |= numbers == 0 && fields >= image_line_fields;  // a header
    if (numbers < image_line_fields) return;
    ++rows;
    columns = std::max(columns, numbers);
  });
  constexpr std::size_t convincing_columns = 192;  // an MLX90641's frame: one line is enough
  const bool is_table = rows >= 2 && 2 * rows >= lines;
  if ((!is_table && columns < convincing_columns) || holds_words) return std::nullopt;
  if (!has_decimals)
    return evidence_of(
        bytes, fmt::format("a picture without temperatures as text ({} whole numbers a line)", columns),
        "turn on the temperatures in the camera's sketch (Adafruit: PRINT_TEMPERATURES), with "
        "two decimals");
  return evidence_of(
      bytes, fmt::format("a picture as text, {} numbers a line, in a form that is not read", columns),
      "print all 768 temperatures in one line, or in 24 lines of 32 with an empty line before each picture "
      "(protocols/text_camera.md)");
}

/// A character a pixel, 24 lines of 32: the picture that Adafruit's example draws unless it is told
/// otherwise.
std::optional<Evidence> picture_of_letters(Bytes bytes) {
  constexpr std::size_t most_letters = 16;
  std::size_t rows = 0;
  std::array<bool, 256> letters{};
  for_each_line(bytes, [&](const RawLine& line) {
    if (line.text.size() != frame_columns || !is_text(line.text) ||
        std::any_of(line.text.begin(), line.text.end(), is_digit))
      return;
    ++rows;
    for (const char c : line.text) letters[static_cast<std::uint8_t>(c)] = true;
  });
  const auto different = static_cast<std::size_t>(std::count(letters.begin(), letters.end(), true));
  const bool is_most = 2 * rows * frame_columns > bytes.size();
  if (rows < frame_rows || different > most_letters || !is_most) return std::nullopt;
  return evidence_of(bytes, "a picture drawn with letters, without temperatures",
                     "turn on the temperatures in the camera's sketch (Adafruit: PRINT_TEMPERATURES)");
}

/// "Pixel 0: 23.45C", as SparkFun's first example prints ten of.
std::optional<Evidence> single_pixels(Bytes bytes) {
  std::size_t lines = 0, of_pixels = 0;
  for_each_line(bytes, [&](const RawLine& line) {
    lines += is_blank(line.text) ? 0U : 1U;
    of_pixels += line.text.starts_with("Pixel ") && line.text.ends_with("C") ? 1U : 0U;
  });
  if (of_pixels < frames_needed || 2 * of_pixels < lines) return std::nullopt;
  return evidence_of(bytes, "single pixels of an image (SparkFun's Example 1 prints ten)",
                     "a sketch that prints all 768 temperatures, such as SparkFun's Example 2");
}

/// Nothing but numbers of 32 bits that may be temperatures: where an image begins, nothing tells.
std::optional<Evidence> images_without_mark(Bytes bytes) {
  constexpr std::size_t image_bytes = 4 * frame_pixels;
  if (bytes.size() < image_bytes) return std::nullopt;
  for (std::size_t phase = 0; phase < 4; ++phase) {
    std::size_t temperatures = 0;
    const std::size_t numbers = (bytes.size() - phase) / 4;
    for (std::size_t i = 0; i < numbers; ++i) {
      const std::size_t at = phase + 4 * i;
      const std::uint32_t low = wire::u16_at(bytes, at), high = wire::u16_at(bytes, at + 2);
      const float value = std::abs(std::bit_cast<float>(low | high << 16U));
      temperatures += value > 0.01F && value < hottest_pixel_c ? 1U : 0U;
    }
    if (temperatures < numbers - numbers / 64) continue;
    return evidence_of(bytes, "numbers of 32 bits that may be temperatures, without a mark between images",
                       "let the sketch send a mark in front of each image (protocols/binary_camera.md)");
  }
  return std::nullopt;
}

/// How many frames stand in a row that begin with `mark`, `size` bytes apart, at best.
template <typename IsFrame>
std::size_t frames_in_a_row(Bytes bytes, std::size_t size, IsFrame is_frame) {
  std::size_t best = 0;
  for (std::size_t at = 0; at + size <= bytes.size(); ++at) {
    std::size_t frames = 0;
    while (at + size <= bytes.size() && is_frame(bytes.subspan(at, size))) {
      ++frames;
      at += size;
    }
    best = std::max(best, frames);
  }
  return best;
}

/// WitMotion's sensors with Bluetooth, over USB as well: no check sum, no time, and a length that differs.
std::optional<Evidence> witmotion_ble(Bytes bytes) {
  constexpr std::array sizes{std::size_t{20}, std::size_t{28}};
  for (const std::size_t size : sizes) {
    const std::size_t frames =
        frames_in_a_row(bytes, size, [](Bytes frame) { return frame[0] == 0x55 && frame[1] == 0x61; });
    if (frames < frames_needed || 2 * frames * size < bytes.size()) continue;
    return evidence_of(
        bytes,
        fmt::format("WitMotion's Bluetooth frames (55 61, {} in a row), which have no check sum", frames),
        "a WitMotion sensor with a cable (WT61, WT901): its packets 55 52 are checked");
  }
  return std::nullopt;
}

/// CRC-16/MODBUS.
std::uint16_t modbus_crc(Bytes bytes) {
  std::uint16_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ byte);
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 1U) != 0 ? (crc >> 1) ^ 0xA001U : crc >> 1);
  }
  return crc;
}

/// Answers to "read registers": address, 3, how many bytes follow, these, CRC.
std::optional<Evidence> modbus(Bytes bytes) {
  std::size_t answers = 0, of_them = 0;
  for (std::size_t at = 0; at + 5 <= bytes.size(); ++at) {
    const std::size_t size = 3 + std::size_t{bytes[at + 2]};
    if (bytes[at + 1] != 3 || bytes[at + 2] == 0 || bytes[at + 2] % 2 != 0 || at + size + 2 > bytes.size())
      continue;
    if (modbus_crc(bytes.subspan(at, size)) != wire::u16_at(bytes, at + size)) continue;
    ++answers;
    of_them += size + 2;
    at += size + 1;
  }
  if (answers < frames_needed || 3 * of_them < bytes.size()) return std::nullopt;
  return evidence_of(
      bytes, fmt::format("Modbus ({} answers of registers), which speaks only when it is asked", answers),
      "set the sensor to send by itself (WitMotion: its \"normal\" protocol)");
}

/// The "teapot" packets of the MPU-6050's motion processor: a quaternion.
std::optional<Evidence> teapot(Bytes bytes) {
  const std::size_t frames = frames_in_a_row(bytes, 14, [](Bytes frame) {
    return frame[0] == '$' && frame[1] == 2 && frame[12] == '\r' && frame[13] == '\n';
  });
  if (frames < frames_needed) return std::nullopt;
  return evidence_of(bytes,
                     fmt::format("teapot packets ({} in a row): quaternions, no rates of turn", frames),
                     "make the sketch print the gyro's x, y, z (i2cdevlib: MPU6050_raw)");
}

/// Answers of a flight controller that speaks MSP: "$M>", how many bytes follow, what they are, these, XOR.
std::optional<Evidence> msp(Bytes bytes) {
  std::size_t answers = 0, of_them = 0;
  for (std::size_t at = 0; at + 6 <= bytes.size(); ++at) {
    const std::size_t size = std::size_t{bytes[at + 3]};
    if (bytes[at] != '$' || bytes[at + 1] != 'M' || bytes[at + 2] != '>' || at + size + 6 > bytes.size())
      continue;
    std::uint8_t sum = 0;
    for (const std::uint8_t byte : bytes.subspan(at + 3, size + 2))
      sum = static_cast<std::uint8_t>(sum ^ byte);
    if (sum != bytes[at + size + 5]) continue;
    ++answers;
    of_them += size + 6;
    at += size + 5;
  }
  if (answers < frames_needed || 3 * of_them < bytes.size()) return std::nullopt;
  return evidence_of(
      bytes,
      fmt::format(
          "MSP ({} answers of a flight controller): its firmware decides the unit, a bias is taken off, "
          "and no time is sent",
          answers),
      "a controller with ArduPilot or PX4, which speak MAVLink; or another gyro");
}

}  // namespace

std::optional<Evidence> recognise_foreign(std::span<const std::uint8_t> bytes) {
  for (const auto recognise : {git_lfs_pointer, utf16_text, hex_text, image_text, picture_of_letters,
                               single_pixels, images_without_mark, witmotion_ble, modbus, teapot, msp})
    if (std::optional<Evidence> found = recognise(bytes)) return found;
  return std::nullopt;
}

}  // namespace thermorig::sensors
