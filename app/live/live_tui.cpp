// SPDX-License-Identifier: MIT
#include "live_tui.h"

#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "live_lines.h"
#include "print/output.h"
#include "print/terminal_width.h"
#include "thermorig/io/port.h"

namespace thermorig::app {

namespace {

constexpr auto draw_period = std::chrono::milliseconds(100);

struct Colour {
  int red, green, blue;
};

/// Inferno at nine places, straight lines between them: enough for a terminal.
Colour inferno(double share) {
  constexpr std::array<Colour, 9> stops{{{0, 0, 4},
                                         {31, 12, 72},
                                         {85, 15, 109},
                                         {136, 34, 106},
                                         {186, 54, 85},
                                         {227, 89, 51},
                                         {249, 140, 10},
                                         {249, 201, 50},
                                         {252, 255, 164}}};
  const double place = (share > 0.0 ? std::min(share, 1.0) : 0.0) * (stops.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(place), stops.size() - 2);
  const double part = place - static_cast<double>(below);
  const auto mix = [&](int from, int to) { return static_cast<int>(std::lround(from + part * (to - from))); };
  const Colour& one = stops[below];
  const Colour& other = stops[below + 1];
  return {mix(one.red, other.red), mix(one.green, other.green), mix(one.blue, other.blue)};
}

int cube_index(const Colour& colour) {
  const auto level = [](int value) { return (value * 5 + 127) / 255; };
  return 16 + 36 * level(colour.red) + 6 * level(colour.green) + level(colour.blue);
}

std::string colour_code(int ground, const Colour& colour, Colours colours) {
  if (colours == Colours::cube) return fmt::format("\x1b[{};5;{}m", ground, cube_index(colour));
  return fmt::format("\x1b[{};2;{};{};{}m", ground, colour.red, colour.green, colour.blue);
}

struct Range {
  float low, high;
};

Range range_of(const ThermalFrame& frame) {
  std::vector<float> pixels;
  for (const float temp_c : frame.temp_c)
    if (std::isfinite(temp_c)) pixels.push_back(temp_c);
  if (pixels.empty()) return {0.0F, 1.0F};
  std::sort(pixels.begin(), pixels.end());
  const auto at = [&](double share) {
    return pixels[static_cast<std::size_t>(share * static_cast<double>(pixels.size() - 1))];
  };
  return {at(0.02), std::max(at(0.98), at(0.02) + 0.1F)};
}

/// Lines of plain text, none of them longer than `width`.
std::string cut(const std::string& text, std::size_t width) {
  std::string lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    lines += text.substr(at, std::min(end - at, width)) + "\n";
    at = end + 1;
  }
  return lines;
}

std::string plain_figure(double value) {
  return std::isfinite(value) ? fmt::format("{:.1f}", value) : "-";
}

std::string signed_figure(double value) {
  return std::isfinite(value) ? fmt::format("{:+.1f}", value) : "-";
}

/// ", waiting for the camera (12.0 s)"; empty if it is there.
std::string absence_text(Device device, const rig::RecordingProgress& progress) {
  const std::optional<rig::AwaitedDevice>& awaited = progress.awaited[device];
  if (awaited)
    return fmt::format(", waiting for the {} ({} left)", name_of(device), duration_text(awaited->left_s));
  return progress.gone[device] ? fmt::format(", no {}", name_of(device)) : "";
}

/// Keys of the terminal on standard input, one by one and unseen as long as this lives. Another program's
/// terminal is left alone.
class Keyboard {
 public:
  Keyboard() {
    const pid_t owner = ::tcgetpgrp(STDIN_FILENO);
    if (::tcgetattr(STDIN_FILENO, &before_) != 0 || (owner >= 0 && owner != ::getpgrp())) return;
    termios keys = before_;
    keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    is_there_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &keys) == 0;
  }
  ~Keyboard() {
    if (is_there_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  bool is_there() const { return is_there_; }
  /// Has it been pressed since the last call?
  bool takes(char wanted) const {
    pollfd waiting{STDIN_FILENO, POLLIN, 0};
    bool taken = false;
    char key = 0;
    while (is_there_ && ::poll(&waiting, 1, 0) == 1 && ::read(STDIN_FILENO, &key, 1) == 1)
      taken = taken || key == wanted;
    return taken;
  }

 private:
  termios before_{};
  bool is_there_ = false;
};

class LiveTui : public LiveScreen {
 public:
  LiveTui(OutputWriter& output, Colours colours) : output_(output), colours_(colours) {}

  void hello(const LiveFacts& facts) override {
    facts_ = facts;
    output_.write(folded(heading_of(facts)), Matter::word);
  }
  void state(const rig::RecordingProgress& progress) override {
    leave_if_asked();
    state_ = fmt::format("{:.1f} s  {}, leg {} of {}, {}", progress.elapsed_s, name_of(progress.sweep.phase),
                         progress.sweep.leg, progress.sweep.leg_count,
                         facts_.repeats ? "until stopped" : duration_text(progress.sweep.eta_s) + " left");
    for (const Device device : all_devices) state_ += absence_text(device, progress);
  }
  void frame(const LiveFrame& frame) override {
    leave_if_asked();
    const HostTime now = io::now();
    if (drawn_at_ && now - *drawn_at_ < draw_period) return;
    drawn_at_ = now;
    draw(frame);
  }
  void note(const std::string& sentence) override {
    if (output_.write(fmt::format("{}{}\n", erasing(lines_), folded(printable(sentence))), Matter::word))
      lines_ = 0;
  }
  void ended(const LiveEnd& end, const live::LiveScores& scores) override {
    output_.write_last("\r" + folded(ending_of(end, scores, facts_.header.profile.servo.is_there())));
  }

 private:
  /// As Ctrl-C would.
  void leave_if_asked() {
    if (!keyboard_.takes('q')) return;
    note("q: leaving");
    ::kill(::getpid(), SIGINT);
  }

  void draw(const LiveFrame& frame) {
    std::string text = half_blocks(frame.frame.frame, facts_.header.profile.camera.mirrored, colours_);
    const Range range = range_of(frame.frame.frame);
    std::string figures = fmt::format("{:.1f} to {:.1f} degC, {}{}\n", range.low, range.high,
                                      new_pixels(frame.frame), keyboard_.is_there() ? "   (q leaves)" : "");
    figures += state_ + "\n";
    figures += rates_text(frame);
    text += cut(figures, terminal_width() - 1);  // a full line would wrap
    const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    if (output_.write(erasing(lines_) + text, Matter::frame)) lines_ = lines;
  }

  static std::string new_pixels(const TimedFrame& frame) {
    const std::string fresh = freshness(frame);
    return fresh == "repeated" ? fresh : fresh == "both" ? "all pixels new" : "half of the pixels new";
  }

  /// "  angle +123.4 +- 0.3", in degrees (80 columns have no room for the unit); of an estimate that is not
  /// good, the reason, or else its state: there is no room for both.
  static std::string angle_text(const RateEstimate& estimate) {
    if (estimate.state == EstimateState::absent) return "";
    if (estimate.state != EstimateState::good)
      return fmt::format("  {}", estimate.reason == EstimateReason::none
                                     ? thermorig::name_of(estimate.state)
                                     : thermorig::name_of(estimate.reason));
    if (!std::isfinite(estimate.angle_deg) || !std::isfinite(estimate.angle_sigma_deg)) return "";
    return fmt::format("  angle {:+.1f} +- {:.1f}", estimate.angle_deg, estimate.angle_sigma_deg);
  }

  /// As wide as the longest name.
  static std::size_t name_width(const LiveFrame& frame) {
    std::size_t width = 11;
    for (const EstimatorColumn& estimator : frame.estimators) width = std::max(width, estimator.name.size());
    return width;
  }

  static std::string rate_text(const std::string& name, std::size_t width, const RateEstimate& estimate,
                               float label_dps, double rmse_dps) {
    return fmt::format("\n{:<{}} {:>7}  error {:>7}  RMSE {:>6}{}", name, width,
                       signed_figure(estimate.rate_dps), signed_figure(estimate.rate_dps - label_dps),
                       plain_figure(rmse_dps), angle_text(estimate));
  }

  static std::string rates_text(const LiveFrame& frame) {
    const EstimateRow& row = frame.row;
    const float label_dps = row.rate_commanded_dps;
    const std::size_t width = name_width(frame);
    std::string text = fmt::format("{:<{}} {:>7} deg/s", "servo", width, signed_figure(label_dps));
    if (!row.counted) text += "  excluded: " + why_excluded(frame);
    for (std::size_t i = 0; i < frame.estimators.size(); ++i)
      text += rate_text(frame.estimators[i].name, width, row.estimates[i], label_dps,
                        frame.scores.estimators[i].rmse_dps);
    const std::optional<float> gain = live::gain_of(frame.estimators, row);
    const std::string gate =
        gain ? "Kg " + (std::isnan(*gain) ? "-" : fmt::format("{:.2f}", *gain)) + "  " : "";
    return text + fmt::format("\n{}counted {}  excluded {}  rates in deg/s, angles in deg  {} us\n", gate,
                              frame.scores.counted, frame.scores.excluded, plain_figure(frame.inference_us));
  }

  OutputWriter& output_;
  Colours colours_;
  Keyboard keyboard_;
  LiveFacts facts_;
  std::string state_;
  std::optional<HostTime> drawn_at_;
  std::size_t lines_ = 0;
};

}  // namespace

Colours terminal_colours() {
  const char* color_term = std::getenv("COLORTERM");
  const std::string_view says = color_term == nullptr ? "" : color_term;
  return says == "truecolor" || says == "24bit" ? Colours::true_colour : Colours::cube;
}

std::string half_blocks(const ThermalFrame& frame, bool mirrored, Colours colours) {
  const Range range = range_of(frame);
  const auto colour = [&](std::size_t row, std::size_t column) {
    const std::size_t from = mirrored ? frame_columns - 1 - column : column;
    const float temp_c = frame.temp_c[row * frame_columns + from];
    return inferno(double{temp_c - range.low} / double{range.high - range.low});
  };
  std::string text;
  for (std::size_t row = 0; row < frame_rows; row += 2) {
    for (std::size_t column = 0; column < frame_columns; ++column)
      text += colour_code(38, colour(row, column), colours) +
              colour_code(48, colour(row + 1, column), colours) + "\u2580";
    text += "\x1b[0m\n";
  }
  return text;
}

std::unique_ptr<LiveScreen> make_live_tui(OutputWriter& output, Colours colours) {
  return std::make_unique<LiveTui>(output, colours);
}

}  // namespace thermorig::app
