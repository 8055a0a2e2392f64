// SPDX-License-Identifier: MIT
// Cameras whose sketch sends 768 temperatures as numbers in bytes. Source: protocols/binary_camera.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string_view>

#include "thermorig/core/freshness.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/wire/byte_ledger.h"
#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::sensors {

namespace {

using namespace std::string_view_literals;
using wire::Bytes;
using wire::CameraMessage;

float float_at(Bytes bytes) {
  const std::uint32_t low = wire::u16_at(bytes, 0), high = wire::u16_at(bytes, 2);
  return std::bit_cast<float>(low | (high << 16));
}
float tenths_at(Bytes bytes) {
  return static_cast<float>(wire::u16_at(bytes, 0)) / 10.0F;
}
float hundredths_at(Bytes bytes) {
  return static_cast<float>(wire::u16_at(bytes, 0)) / 100.0F;
}

/// Four hexadecimal digits of tenths.
float hex_tenths_at(Bytes bytes) {
  unsigned number = 0;
  for (const std::uint8_t byte : bytes.first(4)) {
    const auto at = "0123456789abcdefABCDEF"sv.find(static_cast<char>(byte));
    if (at == std::string_view::npos) return std::numeric_limits<float>::quiet_NaN();
    number = 16 * number + static_cast<unsigned>(at < 16 ? at : at - 6);
  }
  return static_cast<float>(number) / 10.0F;
}

/// How a sketch frames its images: `begin`, `ahead` bytes of other things, the pixels, `end`.
struct Layout {
  std::string_view begin, end;
  std::size_t ahead;
  std::size_t pixel_bytes;
  float (*pixel)(Bytes bytes);
  std::string_view remark;

  std::size_t size() const { return begin.size() + ahead + frame_pixels * pixel_bytes + end.size(); }
};
constexpr std::array layouts{
    Layout{"\xAA\xBB\xCC\xDD"sv, {}, 0, 4, float_at, {}},
    Layout{"BEGIN"sv, "END"sv, 12, 4, float_at, {}},
    Layout{"\xFF\xFF\xFF\xFF"sv, {}, 0, 4, float_at, {}},
    Layout{"\x00\x80\x01\x00\x00\x06"sv, {}, 0, 2, hundredths_at, {}},
    Layout{"\xCA\x01"sv, {}, 0, 2, tenths_at, ", in 0.1 degC and clamped to 0 to 40 degC"},
    Layout{"S"sv, {}, 0, 4, hex_tenths_at, ", in 0.1 degC"},
    Layout{"\xAA\xAA"sv, {}, 0, 4, float_at, {}},
};
constexpr std::size_t longest_mark = 6;
constexpr std::size_t longest_frame = 5 + 12 + 4 * frame_pixels + 3;
constexpr std::array<UsualBaud, 2> binary_bauds{
    {{460800, 0.12}, {115200, 0.15}}};  // a gyro is heard at the others

bool stands_at(std::string_view mark, Bytes bytes) {
  return bytes.size() >= mark.size() &&
         std::equal(mark.begin(), mark.end(), bytes.begin(),
                    [](char c, std::uint8_t byte) { return static_cast<std::uint8_t>(c) == byte; });
}

/// Finds frames by the mark in front of them. None of these layouts has a check sum: a frame counts if its
/// end and the mark of the next one stand where they belong (or the stream ends there) and every pixel is a
/// temperature. So the newest frame waits for the mark of the next one. The first good frame settles which
/// layout it is.
class BinaryCameraScanner {
 public:
  void push(Bytes bytes, std::vector<CameraMessage>& out) {
    ledger_.receive(bytes.size());
    wire::reassemble(pending_, bytes, longest_frame + longest_mark,
                     [&](Bytes rest) { return step(rest, out); });
  }
  void finish(std::vector<CameraMessage>& out) {
    ended_ = true;
    wire::reassemble_end(pending_, [&](Bytes rest) { return step(rest, out); });
  }
  void restart() {
    ledger_.restart();
    pending_.clear();
    freshness_.restart();
    ended_ = false;
  }
  const wire::Counters& counters() const { return ledger_.counters; }
  const Layout* layout() const { return layout_; }

 private:
  std::size_t step(Bytes rest, std::vector<CameraMessage>& out) {
    bool waits = false;
    for (const Layout& layout : layouts) {
      if (layout_ != nullptr && layout_ != &layout) continue;
      if (rest.size() < layout.begin.size()) {
        waits |= !ended_ && stands_at(layout.begin.substr(0, rest.size()), rest);
        continue;
      }
      if (!stands_at(layout.begin, rest)) continue;
      if (is_whole(layout, rest)) return take(layout, rest.first(layout.size()), out);
      const bool is_undecided = rest.size() < layout.size() + layout.begin.size();
      waits |= is_undecided && !ended_;
      if (layout_ != nullptr && !is_undecided) {
        ++ledger_.counters.bad_length;
        ledger_.mark_damage(layout.size());
      }
    }
    if (waits) return 0;
    ledger_.book_gap(1);
    return 1;
  }

  bool is_whole(const Layout& layout, Bytes rest) const {
    if (rest.size() < layout.size()) return false;
    if (!stands_at(layout.end, rest.subspan(layout.size() - layout.end.size()))) return false;
    if (layout.ahead > 0 && !is_between(rest.subspan(layout.begin.size()))) return false;
    const Bytes behind = rest.subspan(layout.size());
    if (behind.size() >= layout.begin.size()) return stands_at(layout.begin, behind);
    return ended_ && stands_at(layout.begin.substr(0, behind.size()), behind);
  }

  /// The three floats ahead are most, least and mean: else they stand behind the pixels, or are others.
  static bool is_between(Bytes ahead) {
    const float most = float_at(ahead), least = float_at(ahead.subspan(4)), mean = float_at(ahead.subspan(8));
    const float first = float_at(ahead.subspan(12));
    return least <= mean && mean <= most && least <= first && first <= most;
  }

  std::size_t take(const Layout& layout, Bytes frame, std::vector<CameraMessage>& out) {
    std::array<float, frame_pixels> temp_c{};
    for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
      temp_c[pixel] =
          layout.pixel(frame.subspan(layout.begin.size() + layout.ahead + pixel * layout.pixel_bytes));
    const bool is_good =
        !is_half_an_image(temp_c) && std::all_of(temp_c.begin(), temp_c.end(), [](float value) {
          return value >= coldest_pixel_c && value <= hottest_pixel_c;
        });
    if (!is_good && layout_ == nullptr) {  // its marks may be pixels
      ledger_.book_gap(1);
      return 1;
    }
    if (!is_good) {
      ledger_.book_damaged(&wire::Counters::bad_value, frame.size());
      return frame.size();
    }
    layout_ = &layout;
    CameraMessage& message = out.emplace_back();
    message.frame.temp_c = temp_c;
    message.frame.sensor_temp_c = std::numeric_limits<float>::quiet_NaN();
    message.fresh = freshness_.push(temp_c);
    ledger_.book_data(message, frame.size());
    return frame.size();
  }

  wire::ByteLedger ledger_;
  FreshnessDetector<float> freshness_;
  const Layout* layout_ = nullptr;
  std::vector<std::uint8_t> pending_;  // received, not yet booked
  bool ended_ = false;
};

CameraScanner binary_camera_scanner(const CameraProfile&) {
  return CameraScanner(BinaryCameraScanner());
}

std::optional<Evidence> recognise_binary_camera(Bytes bytes) {
  BinaryCameraScanner scanner;
  std::vector<CameraMessage> messages;
  scanner.push(bytes, messages);
  if (messages.empty()) return std::nullopt;
  return Evidence{.messages = messages.size(),
                  .bytes = scanner.counters().bytes_in_messages,
                  .text = fmt::format("{} image(s) of 768 temperatures in bytes, without check sums{}",
                                      messages.size(), scanner.layout()->remark),
                  .text_format = {},
                  .advice = advice_on_unit(messages.front().frame)};
}

}  // namespace

CameraProtocol binary_camera() {
  return {.name = "binary",
          .sends = "images of 768 temperatures in bytes",
          .bauds = binary_bauds,
          .clock = {},
          .message_bytes = longest_frame,
          .scanner = binary_camera_scanner,
          .recognise = recognise_binary_camera,
          .merges_halves = true,
          .doubt = doubt_on_unit};
}

}  // namespace thermorig::sensors
