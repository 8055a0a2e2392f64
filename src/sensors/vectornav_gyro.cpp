// SPDX-License-Identifier: MIT
// VectorNav sensors in their ASCII protocol. Source: protocols/vectornav.md.
#include <charconv>
#include <string>

#include "framed_gyro.h"
#include "text_fields.h"
#include "thermorig/sensors/wire/checksums.h"

namespace thermorig::sensors {

namespace {

using wire::Bytes;

constexpr std::array<GyroSetting, 1> vectornav_settings{{
    {"filtered", 0, 1, true, "0: VNIMU, whose rates are uncompensated; 1: VNYMR, without the filter's bias"},
}};

/// An asynchronous message that holds rates.
struct VectornavMessage {
  std::string_view name;
  std::size_t numbers;
  std::size_t rate;  // the first of three, rad/s
  int temperature;   // -1: none
};
constexpr VectornavMessage uncompensated{"VNIMU", 11, 6, 9};
constexpr VectornavMessage filtered{"VNYMR", 12, 9, -1};

std::string_view text_in(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::optional<unsigned> hex_number(std::string_view text) {
  unsigned number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, 16);
  const bool is_whole = error == std::errc() && end == text.data() + text.size();
  return is_whole && text[0] != '-' ? std::optional(number) : std::nullopt;
}

std::optional<double> decimal_number(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

class VectornavFraming {
 public:
  using Content = FrameContent;
  static constexpr std::uint8_t sync = '$';
  static constexpr std::size_t longest = 256;

  explicit VectornavFraming(bool reads_filtered) : wanted_(reads_filtered ? &filtered : &uncompensated) {}

  /// To the line feed. Only the star, the check sum and the line end may stand between the first character
  /// that is not of the message and that.
  static std::optional<std::size_t> size(Bytes rest) {
    const std::string_view text = text_in(rest.first(std::min(rest.size(), longest)));
    constexpr std::string_view begin = "$VN";
    if (!text.starts_with(begin.substr(0, text.size()))) return std::nullopt;
    const auto is_inside = [](char c) { return c > ' ' && c < 0x7F && c != '$'; };
    const auto end = std::find_if_not(text.begin() + 1, text.end(), is_inside);
    const auto at = static_cast<std::size_t>(end - text.begin());
    if (end == text.end()) return text.size() < longest ? std::optional<std::size_t>(0) : std::nullopt;
    if (*end == '\n') return at + 1;
    if (*end != '\r') return std::nullopt;
    if (at + 1 == text.size()) return at + 1 < longest ? std::optional<std::size_t>(0) : std::nullopt;
    return text[at + 1] == '\n' ? std::optional(at + 2) : std::nullopt;
  }

  static bool is_good(Bytes frame) {
    const std::string_view text = message_of(frame);
    const std::size_t star = text.rfind('*');
    if (star == text.npos) return false;
    const std::string_view sum = text.substr(star + 1);
    const std::optional<unsigned> told = sum.empty() ? std::nullopt : hex_number(sum);
    const Bytes summed = frame.subspan(1, star - 1);
    if (told && sum.size() == 2) {
      std::uint8_t all = 0;
      for (const std::uint8_t byte : summed) all = static_cast<std::uint8_t>(all ^ byte);
      return all == *told;
    }
    return told && sum.size() == 4 && wire::crc16_xmodem(summed) == *told;
  }
  static bool is_proof(Bytes) { return true; }

  FrameContent read(Bytes frame) {
    std::string_view text = message_of(frame);
    text = text.substr(1, text.rfind('*') - 1);
    const std::string_view name = text.substr(0, std::min(text.find(','), text.size()));
    if (name == uncompensated.name) ++with_uncompensated;
    if (name == filtered.name) ++with_filtered;
    if (name != wanted_->name) return {};
    text.remove_prefix(name.size());
    return read_rates(text);
  }
  void restart() {}

  std::uint64_t with_uncompensated = 0, with_filtered = 0;  // messages

 private:
  static std::string_view message_of(Bytes frame) {
    const std::string_view text = text_in(frame);
    return text.substr(0, text.find_last_not_of("\r\n") + 1);
  }

  /// Counters and states of its synchronisation, which it may be told to add, begin with a letter.
  FrameContent read_rates(std::string_view text) const {
    std::array<double, 12> numbers{};
    std::size_t count = 0;
    while (!text.empty()) {
      text.remove_prefix(1);
      const std::string_view field = text.substr(0, std::min(text.find(','), text.size()));
      text.remove_prefix(field.size());
      const std::optional<double> number = decimal_number(field);
      const bool is_added = count >= wanted_->numbers && !field.empty() && is_letter(field[0]);
      if (is_added) continue;
      if (!number || count >= wanted_->numbers) return FrameContent::bad(FrameContent::Kind::bad_value);
      numbers[count++] = *number;
    }
    if (count < wanted_->numbers) return FrameContent::bad(FrameContent::Kind::bad_value);
    GyroReading reading;
    for (std::size_t axis = 0; axis < 3; ++axis)
      reading.rate_dps[axis] = static_cast<float>(numbers[wanted_->rate + axis] * dps_of_rad_s);
    if (wanted_->temperature >= 0)
      reading.temp_c = static_cast<float>(numbers[static_cast<std::size_t>(wanted_->temperature)]);
    return sample_or_bad_value(reading);
  }

  const VectornavMessage* wanted_;
};

constexpr std::array<UsualBaud, 2> vectornav_bauds{{{115200, 0.15}, {921600, 0.04}}};

bool reads_filtered(const GyroProfile& profile) {
  return profile.setting("filtered") != 0.0;
}

ClockProperties vectornav_clock(const GyroProfile&) {
  return {};
}

/// Numbers have a fixed width; a check sum of 16 bits has two digits more.
std::uint64_t vectornav_message_bytes(const GyroProfile&) {
  return 128;
}

GyroScanner vectornav_scanner(const GyroProfile& profile, StreamStart) {
  return GyroScanner(FramedScanner(VectornavFraming(reads_filtered(profile))));
}

/// "Write register": which message it sends by itself. It forgets that when its power goes.
std::vector<std::uint8_t> vectornav_request(const GyroProfile& profile, unsigned) {
  const std::string_view text = reads_filtered(profile) ? "$VNWRG,06,14*59\r\n" : "$VNWRG,06,19*54\r\n";
  return {text.begin(), text.end()};
}

std::string_view vectornav_remark(const GyroProfile& profile) {
  return reads_filtered(profile) ? "VNYMR: its filter takes the bias that it estimates off the rates, and "
                                   "goes on estimating it"
                                 : "";
}

std::optional<Evidence> recognise_vectornav(Bytes bytes, double) {
  const auto first = scanned(VectornavFraming(false), bytes);
  const bool has_only_filtered = first.counters().messages == 0 && first.framing().with_uncompensated == 0 &&
                                 first.framing().with_filtered > 1;
  const auto scanner = has_only_filtered ? scanned(VectornavFraming(true), bytes) : first;
  auto evidence =
      framed_evidence(scanner.counters(), "VectorNav messages", "",
                      "set register 06 to 19 (VNIMU): $VNWRG,06,19*54 in a terminal, or VectorNav's tool");
  if (!evidence || !has_only_filtered) return evidence;
  evidence->text += " (VNYMR: its filter has taken a bias off the rates)";
  evidence->settings["filtered"] = 1.0;
  evidence->is_asked_otherwise = true;
  return evidence;
}

}  // namespace

GyroProtocol vectornav_gyro() {
  return {.name = "vectornav",
          .sends = "VectorNav messages (VNIMU)",
          .settings = vectornav_settings,
          .bauds = vectornav_bauds,
          .usual_rate_hz = 40.0,
          .clock = vectornav_clock,
          .message_bytes = vectornav_message_bytes,
          .scanner = vectornav_scanner,
          .recognise = recognise_vectornav,
          .request = vectornav_request,
          .remark = vectornav_remark};
}

}  // namespace thermorig::sensors
