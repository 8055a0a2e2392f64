// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace thermorig::sensors {

// What the words on a line of text say of its numbers: names ("GyroX", "wx(deg/s)", "Rotation"), axes, units.

enum class Quantity : std::uint8_t {
  none,
  time,
  rate,
  acceleration,
  magnetic,
  temperature,
  angle,
  quaternion,
  other
};

constexpr double dps_of_rad_s = 180.0 / std::numbers::pi;

inline bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
inline bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// In words: "accelerations".
std::string_view name_of(Quantity quantity);

/// Of one number.
struct Meaning {
  Quantity quantity = Quantity::none;
  std::optional<std::size_t> axis;  // 0, 1, 2: x, y, z
  bool axis_named = false;          // not just by the order of three numbers
  double scale_dps = 0.0;           // deg/s of one unit of a rate; 0: the words do not say
  std::string unit;                 // the words that say it: "rad/s"
};

/// Reads words and numbers of a line in their order. Words stand before the numbers they name, units before
/// or behind them.
class WordReader {
 public:
  /// The words before the next number, behind the last one.
  void words(std::string_view text);
  /// A number stands here.
  void number();
  /// Of all numbers so far, once the words behind the last one were read.
  const std::vector<Meaning>& meanings() const { return meanings_; }
  /// Every quantity that the words named, numbers or not, and the last unit of rates.
  bool has_named(Quantity quantity) const { return named_[static_cast<std::size_t>(quantity)]; }
  double last_scale_dps() const { return last_scale_dps_; }
  const std::string& last_unit() const { return last_unit_; }

 private:
  void word(std::string_view text, std::size_t begin, std::size_t end);
  void name(Quantity quantity, std::optional<std::size_t> axis);
  void unit(double scale_dps, std::string_view text, bool of_rates_alone);
  void begin_group(Quantity quantity);

  std::vector<Meaning> meanings_;
  Quantity quantity_ = Quantity::none;
  std::optional<std::size_t> axis_;
  double scale_dps_ = 0.0;
  std::string unit_;
  std::size_t group_ = 0;      // its first number
  bool axes_named_ = false;    // of the group
  bool named_in_gap_ = false;  // since the last number: a unit that comes now is of the numbers to come
  bool is_first_word_ = true;  // of those between two numbers
  bool joined_ = false;        // the word before belongs to the same name: "accAngleX"
  std::array<bool, 9> named_{};
  double last_scale_dps_ = 0.0;
  std::string last_unit_;
};

/// The length of a unit that `text` begins with and that ends there as a word: "rad/s", "dps", "m/s^2", "C",
/// "ms", a degree sign in any encoding; 0: none.
std::size_t unit_length(std::string_view text);

}  // namespace thermorig::sensors
