// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
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
  bool is_named = false;            // by a word, not just by a unit
  std::optional<std::size_t> axis;  // 0, 1, 2: x, y, z
  bool axis_named = false;          // not just by the order of three numbers
  double scale_dps = 0.0;           // deg/s of one unit of a rate; 0: the words do not say
  std::string unit;                 // the words that say it: "rad/s"
};

/// Reads words and numbers of a line in their order. Words stand before the numbers they name, units before
/// or behind them. A name holds for the numbers until the next one; a unit holds for the name that it stands
/// at, and for no other.
class WordReader {
 public:
  /// The words before the next number, behind the last one.
  void words(std::string_view text);
  /// A number stands here.
  void number();
  /// The line ends here: what was said behind the last number is taken in.
  void end();
  /// Of all numbers, once the line has ended.
  const std::vector<Meaning>& meanings() const { return meanings_; }
  /// Every quantity that the words named, numbers or not.
  bool has_named(Quantity quantity) const { return named_[static_cast<std::size_t>(quantity)]; }
  /// The one unit of rates on lines that have no numbers of their own; 0: none, or several.
  double said_scale_dps() const { return is_contradicted_ ? 0.0 : said_scale_dps_; }
  const std::string& said_unit() const { return said_unit_; }

 private:
  /// What stands between two numbers.
  struct Gap {
    bool is_named = false;               // a known word
    Quantity quantity = Quantity::none;  // then: which
    bool is_unknown = false;             // another word, which may name something else
    bool is_last_unknown = false;        // the word that stands nearest
    bool has_factor = false;             // "tenths of", "raw"
    bool is_modified = false;            // "max", "target": not what is measured
    bool is_first_word = true;           // none stands before the one that is read
    bool is_joined = false;              // the word before belongs to the same name: "accAngleX"
    bool closes = false;                 // a bracket
    bool has_unit_behind = false;        // of the numbers before
    bool closes_factor = false;          // of "(0.1 dps)"
    bool roll_is_rate = false;           // "gyro roll=1 pitch=2 yaw=3"
    bool opens = false;                  // a bracket right before the number
    std::vector<std::size_t> axes;
    double scale_dps = 0.0;
    std::string unit;
  };
  struct Word {
    std::string_view text;
    std::size_t begin, end;
  };

  std::size_t take_unit(std::string_view text, std::size_t at);
  void word(const Word& word);
  void name(Quantity quantity, std::optional<std::size_t> axis);
  void unit(double scale_dps, std::string_view text);
  void unit_behind(double scale_dps, std::string_view text);
  void begin_group(Quantity quantity);
  void drop_factor();
  void end_group();
  bool goes_on_modified() const;
  bool is_tail() const {
    return !meanings_.empty() && !gap_.is_named && !gap_.is_unknown && gap_.axes.empty();
  }
  bool is_of_something_else() const;

  std::vector<Meaning> meanings_;
  Gap gap_;
  std::size_t brackets_ = 0;                // that are open
  std::optional<std::size_t> modified_in_;  // brackets around a word such as "target"
  bool begins_with_number_ = false;         // the line
  bool was_opened_ = false;                 // the last number, by a bracket

  // Of the group: the numbers that one name holds for.
  Quantity quantity_ = Quantity::none;
  std::size_t group_ = 0;  // its first number
  bool is_named_ = false;  // by a known word
  bool is_modified_ = false;
  bool axes_named_ = false;
  bool roll_is_rate_ = false;           // "gyro roll=1 pitch=2 yaw=3"
  Quantity modified_ = Quantity::none;  // what a modified name is of: "target gx=1 gy=2 gz=3"
  std::vector<std::size_t> modified_axes_;

  // Of numbers to come.
  double scale_dps_ = 0.0;
  std::string unit_;
  std::vector<std::size_t> axes_;  // "gyro (z,y,x): 1 2 3"

  // Of all lines.
  std::array<bool, 9> named_{};
  double said_scale_dps_ = 0.0;
  std::string said_unit_;
  bool is_contradicted_ = false;
};

/// The length of a unit that `text` begins with and that ends there as a word: "rad/s", "dps", "m/s^2", "C",
/// "ms", a degree sign in any encoding; 0: none.
std::size_t unit_length(std::string_view text);

/// Words such as "off", "not", "divide": a line with one does not say what the numbers below it are.
bool holds_doubt(std::string_view text);

/// deg/s of one of the unit of a rate that `text` begins with; 0: none.
double scale_of_unit(std::string_view text);

}  // namespace thermorig::sensors
