// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <string_view>

#include "foreign_bytes.h"
#include "text_fields.h"
#include "text_line.h"
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

/// What the bytes seem to be, which explains none of them: at another baud rate they may be something else.
Evidence guess(std::string text, std::string advice) {
  return evidence_of({}, std::move(text), std::move(advice));
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
      "iconv -f UTF-16 -t UTF-8 FILE | thermorig decode --device gyro - (or camera); or log with another "
      "program");
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
  std::size_t lines = 0, rows = 0, columns = 0, zeros = 0, in_rows = 0;
  bool holds_words = false, has_decimals = false, has_commas = false;
  double largest = 0.0;
  for_each_line(bytes, [&](const RawLine& line) {
    if (is_blank(line.text) || !is_text(line.text)) return;
    std::size_t fields = 0, numbers = 0, zeros_here = 0;
    for (const TextField& field : split_fields(line.text)) {
      ++fields;
      const std::optional<double> number = read_number(field.value);
      numbers += number ? 1U : 0U;
      zeros_here += number == 0.0 ? 1U : 0U;
      largest = std::max(largest, number.value_or(0.0));
      has_decimals |= number && *number != std::trunc(*number);
    }
    ++lines;
    holds_words |= numbers == 0 && fields >= image_line_fields;  // a header
    if (numbers < image_line_fields) return;
    ++rows;
    zeros += zeros_here;
    in_rows += numbers;
    has_commas |= has_decimal_commas(line.text);
    columns = std::max(columns, numbers);
  });
  constexpr std::size_t convincing_columns = 192;  // an MLX90641's frame: one line is enough
  const bool is_table = rows >= 2 && 2 * rows >= lines;
  if ((!is_table && columns < convincing_columns) || holds_words) return std::nullopt;
  if (has_commas)
    return evidence_of(bytes, "a picture as text whose numbers have decimal commas",
                       "print points: 21.34, not 21,34");
  if (!has_decimals && largest > 255.0)
    return evidence_of(
        bytes,
        fmt::format("a picture as text of whole numbers up to {:.0f}, {} a line, in an unknown unit", largest,
                    columns),
        "print degrees Celsius with two decimals");
  if (!has_decimals)
    return evidence_of(
        bytes, fmt::format("a picture without temperatures as text ({} whole numbers a line)", columns),
        "turn on the temperatures in the camera's sketch (Adafruit: PRINT_TEMPERATURES), with "
        "two decimals");
  if (5 * zeros > 2 * in_rows)
    return evidence_of(bytes, "half-images as text: about half of the numbers are 0",
                       "let the sketch read both halves (subpages) before it prints, as the libraries of "
                       "Adafruit, Melexis and SparkFun do");
  if (columns == 192)
    return evidence_of(bytes, "a picture as text, 192 numbers a line, in a form that is not read",
                       "an MLX90640, which has 768 pixels (an MLX90641 has 192); or print all of them in one "
                       "line, or in 24 lines of 32");
  if (columns > frame_pixels && columns < frame_pixels + 16)
    return evidence_of(
        bytes,
        fmt::format(
            "a picture as text, {} numbers a line: it is not clear which {} of them are not temperatures",
            columns, columns - frame_pixels),
        "print the 768 temperatures alone in their line; a time or a count may stand before a colon in front "
        "(\"1000: 21.3, 21.4, ...\")");
  return evidence_of(
      bytes, fmt::format("a picture as text, {} numbers a line, in a form that is not read", columns),
      "print all 768 temperatures in one line, or in 24 lines of 32 with an empty line before each picture "
      "(protocols/text_camera.md)");
}

/// A character a pixel, 24 lines of 32: the picture that Adafruit's example draws unless it is told
/// otherwise.
std::optional<Evidence> picture_of_letters(Bytes bytes) {
  constexpr std::size_t most_letters = 16;
  std::size_t rows = 0, in_rows = 0;
  std::array<bool, 256> letters{};
  std::string room;
  for_each_line(bytes, [&](const RawLine& line) {
    const std::string_view text = plain_text(line.text, room);
    const bool is_row = text.size() == frame_columns || text.size() == 2 * frame_columns;
    const auto digits = static_cast<std::size_t>(std::count_if(text.begin(), text.end(), is_digit));
    if (!is_row || !is_text(text) || (digits > 0 && digits < text.size())) return;
    ++rows;
    in_rows += line.bytes;
    for (const char c : text) letters[static_cast<std::uint8_t>(c)] = true;
  });
  const auto different = static_cast<std::size_t>(std::count(letters.begin(), letters.end(), true));
  if (rows < frame_rows || different > most_letters || 2 * in_rows <= bytes.size()) return std::nullopt;
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

/// Nothing but numbers of 32 bits that may be temperatures: where an image begins, nothing shows.
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
    return guess("numbers of 32 bits that may be temperatures, without a mark between images",
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

bool begins_with(Bytes bytes, std::string_view mark) {
  return bytes.size() >= mark.size() &&
         std::equal(mark.begin(), mark.end(), bytes.begin(),
                    [](char c, std::uint8_t byte) { return static_cast<std::uint8_t>(c) == byte; });
}

/// Frames in a row, by their marks and lengths.
struct FrameRow {
  std::size_t frames = 0, bytes = 0;
};
template <typename Use>
FrameRow row_of_frames(Bytes bytes, const FramedProtocol& protocol, Use use) {
  FrameRow row;
  while (row.bytes < bytes.size()) {
    const Bytes rest = bytes.subspan(row.bytes);
    const std::size_t size = protocol.size(rest).value_or(0);
    if (size == 0 || size > rest.size()) break;
    use(rest.first(size));
    ++row.frames;
    row.bytes += size;
  }
  return row;
}

/// A sum of eight bits is right by chance in one of 256 frames.
bool are_wrong(std::size_t right, std::size_t frames) {
  return 16 * right <= frames;
}

std::string wrong_sums_text(std::string_view name, std::size_t right, std::size_t frames) {
  if (right == 0) return fmt::format("{} {} whose check sums are all wrong", frames, name);
  return fmt::format("{} {}, of which {} have a wrong check sum", frames, name, frames - right);
}

constexpr std::size_t convincing_frames = 5;  // marks are short

/// Marks and lengths of a protocol that is read fit throughout, and its check sums do not.
std::optional<Evidence> wrong_sums(Bytes bytes) {
  constexpr std::size_t most_begins = 64;
  for (const FramedProtocol& protocol :
       {witmotion_frames(), xsens_frames(), mip_frames(), hipnuc_frames(), mavlink_frames()})
    for (std::size_t at = 0, tried = 0; at < bytes.size() && tried < most_begins; ++at) {
      const Bytes rest = bytes.subspan(at);
      const FrameRow row = row_of_frames(rest, protocol, [](Bytes) {});
      tried += row.frames > 0 ? 1U : 0U;
      if (row.frames < convincing_frames || 2 * row.bytes < bytes.size()) continue;
      std::size_t right = 0;
      row_of_frames(rest, protocol, [&](Bytes frame) { right += protocol.is_good(frame) ? 1U : 0U; });
      if (!are_wrong(right, row.frames)) break;
      return guess(wrong_sums_text(protocol.name, right, row.frames),
                   "take the dump with a program that keeps every byte (no terminal, no line ends changed); "
                   "else its firmware forms another sum, which is not read");
    }
  return std::nullopt;
}

/// The same with lines of text, "$VNIMU,...*68", which are sure: they can be read.
std::optional<Evidence> wrong_sums_of_vectornav(Bytes bytes) {
  std::size_t lines = 0, of_vectornav = 0, right = 0;
  for_each_line(bytes, [&](const RawLine& line) {
    lines += is_blank(line.text) ? 0U : 1U;
    const std::optional<bool> is_right =
        line.text.starts_with("$VN") ? has_right_sum(line.text) : std::optional<bool>();
    of_vectornav += is_right ? 1U : 0U;
    right += is_right.value_or(false) ? 1U : 0U;
  });
  if (of_vectornav < convincing_frames || 2 * of_vectornav < lines || !are_wrong(right, of_vectornav))
    return std::nullopt;
  return evidence_of(bytes, wrong_sums_text("messages of a VectorNav", right, of_vectornav),
                     "take the dump with a program that keeps every byte");
}

/// A BNO08x in its mode for robot cleaners: AA AA, a count, three angles, three accelerations, a sum.
std::optional<Evidence> bno08x_rvc(Bytes bytes) {
  const std::size_t frames = frames_in_a_row(bytes, 19, [](Bytes frame) {
    unsigned sum = 0;
    for (const std::uint8_t byte : frame.subspan(2, 16)) sum += byte;
    return frame[0] == 0xAA && frame[1] == 0xAA && frame[18] == (sum & 0xFFU);
  });
  if (frames < frames_needed) return std::nullopt;
  return evidence_of(
      bytes,
      fmt::format("RVC packets of a BNO08x ({} in a row): angles and accelerations, no rates of turn",
                  frames),
      "another sketch: Adafruit_BNO08x, more_reports, prints its gyro (--gyro-protocol "
      "adafruit-bno08x)");
}

/// A run of 2 to 16 bytes that is the same in each period: the mark of a layout that nobody knows. Other
/// bytes may stay the same, too, if their runs are shorter; but a third of the period and more has to change.
std::optional<Evidence> unknown_mark(Bytes bytes) {
  if (is_readable(bytes)) return std::nullopt;
  const auto is_same = [&](std::size_t at, std::size_t period) {
    for (std::size_t other = at + period; other < bytes.size(); other += period)
      if (bytes[other] != bytes[at]) return false;
    return true;
  };
  struct Run {
    std::size_t at = 0, size = 0;
  };
  const auto mark_of = [&](std::size_t period) {  // the longest run; size 0: there is none, or several
    Run longest, run;
    bool is_only = false;
    std::size_t same = 0;
    for (std::size_t at = 0; at < period; ++at) {
      const bool goes_on = is_same(at, period);
      same += goes_on ? 1U : 0U;
      run = goes_on ? Run{run.size == 0 ? at : run.at, run.size + 1} : Run();
      if (run.size == longest.size && run.at != longest.at) is_only = false;
      if (run.size <= longest.size) continue;
      longest = run;
      is_only = true;
    }
    const bool is_mark = is_only && longest.size >= 2 && longest.size <= 16 && 3 * same < 2 * period;
    const Bytes run_bytes = bytes.subspan(longest.at, longest.size);
    constexpr std::string_view gy_mcu90640 = "\x5A\x5A\x02\x06";
    bool is_gy_mcu90640 = false;  // in the run, or right behind it: a check sum may be the same in each, too
    for (std::size_t i = longest.at; i <= longest.at + longest.size; ++i)
      is_gy_mcu90640 |= begins_with(bytes.subspan(i), gy_mcu90640);
    const bool is_zero = std::all_of(run_bytes.begin(), run_bytes.end(), [](auto byte) { return byte == 0; });
    bool is_number_again = longest.size >= 4;  // of 16 bits: pixels that are as warm as the next
    for (std::size_t i = 2; i < longest.size; ++i) is_number_again &= run_bytes[i] == run_bytes[i - 2];
    is_number_again &= longest.size < 2 || run_bytes[0] != run_bytes[1];
    return is_mark && !is_gy_mcu90640 && !is_zero && !is_number_again ? longest : Run();
  };
  const auto evidence = [&](std::size_t period, std::size_t needed, std::string_view what,
                            std::string advice) {
    if (bytes.size() < needed) return std::optional<Evidence>();
    const Run mark = mark_of(period);
    if (mark.size == 0) return std::optional<Evidence>();
    return std::optional(guess(
        fmt::format("{} of {} bytes, each with the mark {:02X}: an unknown layout, or impossible values",
                    what, period, fmt::join(bytes.subspan(mark.at, mark.size), " ")),
        std::move(advice)));
  };
  constexpr std::size_t longest_rest = 32, least_frame_bytes = 400;
  for (std::size_t period = 8; period <= 64; ++period)
    if (auto found = evidence(period, std::max(20 * period, least_frame_bytes), "frames",
                              "let the sketch print the gyro's rates as text, with their unit "
                              "(protocols/text_gyro.md); or another baud rate, if this one is wrong"))
      return found;
  for (const std::size_t pixel_bytes : {std::size_t{1}, std::size_t{2}, std::size_t{4}})
    for (std::size_t rest = 2; rest <= longest_rest; ++rest) {
      const std::size_t period = pixel_bytes * frame_pixels + rest;
      if (auto found = evidence(period, 5 * period, "images",
                                "let the sketch send a layout of protocols/binary_camera.md, or text; or "
                                "another baud rate, if this one is wrong"))
        return found;
    }
  return std::nullopt;
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
  for (const auto recognise :
       {git_lfs_pointer, utf16_text, hex_text, image_text, picture_of_letters, single_pixels, witmotion_ble,
        modbus, teapot, msp, bno08x_rvc, wrong_sums_of_vectornav})
    if (std::optional<Evidence> found = recognise(bytes)) return found;
  return std::nullopt;
}

std::optional<Evidence> recognise_unread(std::span<const std::uint8_t> bytes) {
  for (const auto recognise : {wrong_sums, unknown_mark, images_without_mark})
    if (std::optional<Evidence> found = recognise(bytes)) return found;
  return std::nullopt;
}

}  // namespace thermorig::sensors
