// SPDX-License-Identifier: MIT
// A stepper behind GRBL 1.1. Source: protocols/grbl.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/sensors/wire/byte_ledger.h"
#include "thermorig/sensors/wire/grbl.h"
#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::sensors {

namespace {

namespace grbl = wire::grbl;
using wire::Bytes;

std::string_view text_of_line(Bytes line) {
  return {reinterpret_cast<const char*>(line.data()), line.size()};
}

/// Without its ending.
std::string_view trimmed(std::string_view line) {
  while (!line.empty() && (line.back() == '\n' || line.back() == '\r')) line.remove_suffix(1);
  return line;
}

std::optional<double> number_of(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value)
             ? std::optional(value)
             : std::nullopt;
}

/// "error:9" and "ALARM:1" have numbers.
std::uint8_t error_of(std::string_view line) {
  const auto number = number_of(line.substr(line.find(':') + 1));
  return number && *number >= 1.0 && *number <= 255.0 ? static_cast<std::uint8_t>(*number) : 255;
}

/// What a status report says of the axis that turns.
struct GrblReport {
  std::string_view state;
  double position_deg = 0.0;
  double feed_dps = 0.0;
};

std::optional<GrblReport> report_of(std::string_view line) {
  if (line.size() < 2 || line.front() != '<' || line.back() != '>') return std::nullopt;
  line = line.substr(1, line.size() - 2);
  GrblReport report{.state = line.substr(0, line.find_first_of("|:"))};
  bool has_position = false, has_feed = false;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find('|'), line.size());
    const std::string_view field = line.substr(0, end);
    line.remove_prefix(std::min(end + 1, line.size()));
    const std::size_t colon = field.find(':');
    if (colon == field.npos) continue;
    const std::string_view name = field.substr(0, colon);
    const std::string_view rest = field.substr(colon + 1);
    const auto first = number_of(rest.substr(0, rest.find(',')));
    if (name == "MPos" || name == "WPos") {
      if (!first) return std::nullopt;
      report.position_deg = *first;
      has_position = true;
    } else if (name == "FS" || name == "F") {
      if (!first) return std::nullopt;
      report.feed_dps = *first / 60.0;
      has_feed = true;
    }
  }
  return has_position && has_feed ? std::optional(report) : std::nullopt;
}

/// A line is one message. Status reports become telemetry: a report has no time and no sign of its speed.
class GrblScanner {
 public:
  void sent(Bytes bytes) {
    for (const std::uint8_t byte : bytes) {
      if (byte == grbl::jog_cancel) {
        jog_.leg = 0;
        is_cancelled_ = true;
      }
      if (grbl::is_real_time(byte)) continue;
      if (byte != '\n') {
        if (sent_line_.size() < grbl::longest_line) sent_line_.push_back(static_cast<char>(byte));
        continue;
      }
      if (const auto jog = grbl::parse_jog(sent_line_)) {
        jog_ = *jog;
        is_cancelled_ = false;
      }
      is_armed_ = grbl::parse_power_note(sent_line_).value_or(is_armed_);
      sent_line_.clear();
    }
  }

  void push(Bytes bytes, std::vector<wire::ServoMessage>& out) {
    ledger_.receive(bytes.size());
    wire::reassemble(pending_, bytes, grbl::longest_line + 1, [&](Bytes rest) { return step(rest, out); });
  }
  void finish(std::vector<wire::ServoMessage>&) {}
  void restart() {
    ledger_.restart();
    pending_.clear();
    sent_line_.clear();
    jog_ = {};
    is_armed_ = is_cancelled_ = false;
    last_deg_.reset();
    synchronised_ = false;
  }
  const wire::Counters& counters() const { return ledger_.counters; }
  std::uint64_t welcomes() const { return welcomes_; }

 private:
  std::size_t step(Bytes rest, std::vector<wire::ServoMessage>& out) {
    const auto end = std::find(rest.begin(), rest.end(), '\n');
    const auto size = static_cast<std::size_t>(end - rest.begin()) + 1;
    if (size > grbl::longest_line) {
      ledger_.book_gap(grbl::longest_line);
      synchronised_ = false;
      return grbl::longest_line;
    }
    if (end == rest.end()) return 0;
    take(trimmed(text_of_line(rest.first(size))), size, out);
    synchronised_ = true;
    return size;
  }

  /// The first line may have lost its beginning.
  void take(std::string_view line, std::size_t bytes, std::vector<wire::ServoMessage>& out) {
    if (line.empty()) return ledger_.book_filler(bytes);
    if (const auto report = report_of(line)) {
      const StreamSpan span = ledger_.book_message(bytes);
      ++ledger_.counters.messages;
      out.push_back({.body = servo_state(*report), .span = span, .lost_before = ledger_.take_gap()});
      return;
    }
    auto body = answer_of(line);
    if (!body) {
      if (synchronised_) ++ledger_.counters.bad_value;
      return ledger_.book_gap(bytes);
    }
    ++ledger_.counters.replies;
    out.push_back({.body = *std::move(body), .span = ledger_.book_message(bytes)});
  }

  std::optional<wire::ServoBody> answer_of(std::string_view line) {
    if (line.starts_with("Grbl ")) {
      ++welcomes_;
      jog_ = {};
      is_armed_ = false;
      const std::string_view version = line.substr(5, line.substr(5).find(' '));
      return wire::ServoWelcome{.firmware = fmt::format("{} of GRBL", version)};
    }
    const bool is_failure = line.starts_with("error:") || line.starts_with("ALARM:");
    const bool is_known = is_failure || line == "ok" || line.front() == '$' || line.front() == '[';
    if (!is_known) return std::nullopt;
    return wire::ServoReply{.error = is_failure ? error_of(line) : std::uint8_t{0},
                            .data = {line.begin(), line.end()}};
  }

  ServoState servo_state(const GrblReport& report) {
    ServoState state{.angle_deg = report.position_deg, .leg = jog_.leg};
    const double moved_deg = report.position_deg - last_deg_.value_or(report.position_deg);
    last_deg_ = report.position_deg;
    const bool moves = report.state == "Jog" || report.state == "Hold" || report.state == "Run";
    const double direction = moved_deg != 0.0 ? std::copysign(1.0, moved_deg) : jog_.direction();
    state.rate_dps = moves ? direction * report.feed_dps : 0.0;
    if (report.state == "Alarm" || (!moves && !is_armed_))
      state.motion = ServoMotion::disarmed;
    else if (!moves)
      state.motion = ServoMotion::holding;
    else if (report.state == "Hold" || is_cancelled_)
      state.motion = ServoMotion::stopping;
    else
      state.motion = std::abs(report.feed_dps - jog_.rate_dps) <= grbl::feed_unit_dps ? ServoMotion::steady
                                                                                      : ServoMotion::ramping;
    return state;
  }

  wire::ByteLedger ledger_;
  std::vector<std::uint8_t> pending_;
  std::string sent_line_;
  grbl::Jog jog_;  // the last that was sent
  bool is_armed_ = false;
  bool is_cancelled_ = false;  // it ramps down, whatever its speed still is
  std::optional<double> last_deg_;
  bool synchronised_ = false;
  std::uint64_t welcomes_ = 0;
};

// Long: opening the port resets the board, which boots for a second or two.
constexpr std::array<UsualBaud, 1> grbl_bauds{{{115200, 0.38}}};
constexpr double reports_hz = 10.0;  // its authors ask for no more

ServoScanner grbl_scanner(const ServoProfile&) {
  return ServoScanner(GrblScanner());
}

/// By the last "$100=35.556" that it has listed.
std::optional<ScaleCause> grbl_scale_cause(double share, std::span<const wire::ServoMessage> answers) {
  std::optional<double> steps;
  for (const wire::ServoMessage& answer : answers)
    if (const auto* reply = std::get_if<wire::ServoReply>(&answer.body)) {
      const auto setting = grbl::parse_setting(text_of_line(reply->data));
      if (setting && setting->number == grbl::steps_setting) steps = setting->value;
    }
  if (!steps || !(*steps > 0.0) || !(share > 0.0)) return std::nullopt;
  return ScaleCause{
      fmt::format("$100 = {:.3f} is not the motor's steps per degree of the shaft", *steps),
      fmt::format(
          "set $100={:.3f} on the board, or what the motor and its gear have: steps per turn x gear / 360",
          *steps / share)};
}

std::optional<Evidence> recognise_grbl(Bytes bytes) {
  GrblScanner scanner;
  std::vector<wire::ServoMessage> messages;
  scanner.push(bytes, messages);
  const wire::Counters& counters = scanner.counters();
  if (scanner.welcomes() == 0 && counters.messages == 0) return std::nullopt;
  Evidence evidence{.messages = counters.messages,
                    .bytes = counters.bytes_in_messages,
                    .text = fmt::format("{} status reports of GRBL", counters.messages),
                    .text_format = {}};
  for (const wire::ServoMessage& message : messages)
    if (const auto* welcome = std::get_if<wire::ServoWelcome>(&message.body))
      evidence.text = fmt::format("answers of a servo board (firmware {})", welcome->firmware);
  return evidence;
}

}  // namespace

ServoProtocol grbl_servo() {
  return {.name = "grbl",
          .sends = "lines of GRBL 1.1",
          .greeted_as = "its reset",
          .bauds = grbl_bauds,
          .is_silent = true,
          .clock = {},
          .message_bytes = grbl::longest_line,
          .rate_hz = reports_hz,
          .longest_gap_s = 0.25,
          .scanner = grbl_scanner,
          .recognise = recognise_grbl,
          .greeting = [] { return std::vector{grbl::status_request}; },
          .emergency_bytes = [] { return std::vector{grbl::jog_cancel}; },
          .counts_steps = true,
          .scale_cause = grbl_scale_cause};
}

}  // namespace thermorig::sensors
