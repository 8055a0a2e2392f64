// SPDX-License-Identifier: MIT
#include "text_words.h"

#include <algorithm>

namespace thermorig::sensors {

namespace {

struct KnownWord {
  std::string_view word;
  Quantity quantity;
};

// Names that are used as they stand, or with the letter of an axis behind them ("gyrox", "gx").
constexpr std::array known_words{
    KnownWord{"gyro", Quantity::rate},
    KnownWord{"gyros", Quantity::rate},
    KnownWord{"gyr", Quantity::rate},
    KnownWord{"gyroscope", Quantity::rate},
    KnownWord{"rotation", Quantity::rate},
    KnownWord{"rot", Quantity::rate},
    KnownWord{"angular", Quantity::rate},
    KnownWord{"omega", Quantity::rate},
    KnownWord{"angvel", Quantity::rate},
    KnownWord{"yawrate", Quantity::rate},
    KnownWord{"pitchrate", Quantity::rate},
    KnownWord{"rollrate", Quantity::rate},
    KnownWord{"acc", Quantity::acceleration},
    KnownWord{"accel", Quantity::acceleration},
    KnownWord{"acceleration", Quantity::acceleration},
    KnownWord{"accelerations", Quantity::acceleration},
    KnownWord{"accelerometer", Quantity::acceleration},
    KnownWord{"gravity", Quantity::acceleration},
    KnownWord{"mag", Quantity::magnetic},
    KnownWord{"magnetic", Quantity::magnetic},
    KnownWord{"magneto", Quantity::magnetic},
    KnownWord{"magnetometer", Quantity::magnetic},
    KnownWord{"compass", Quantity::magnetic},
    KnownWord{"temp", Quantity::temperature},
    KnownWord{"temperature", Quantity::temperature},
    KnownWord{"tmp", Quantity::temperature},
    KnownWord{"degc", Quantity::temperature},
    KnownWord{"celsius", Quantity::temperature},
    KnownWord{"angle", Quantity::angle},
    KnownWord{"angles", Quantity::angle},
    KnownWord{"ang", Quantity::angle},
    KnownWord{"ypr", Quantity::angle},
    KnownWord{"rpy", Quantity::angle},
    KnownWord{"euler", Quantity::angle},
    KnownWord{"orientation", Quantity::angle},
    KnownWord{"orient", Quantity::angle},
    KnownWord{"attitude", Quantity::angle},
    KnownWord{"heading", Quantity::angle},
    KnownWord{"tilt", Quantity::angle},
    KnownWord{"yaw", Quantity::angle},
    KnownWord{"pitch", Quantity::angle},
    KnownWord{"roll", Quantity::angle},
    KnownWord{"quat", Quantity::quaternion},
    KnownWord{"quaternion", Quantity::quaternion},
    KnownWord{"time", Quantity::time},
    KnownWord{"timestamp", Quantity::time},
    KnownWord{"t", Quantity::time},
    KnownWord{"s", Quantity::time},
    KnownWord{"sec", Quantity::time},
    KnownWord{"seconds", Quantity::time},
    KnownWord{"ms", Quantity::time},
    KnownWord{"us", Quantity::time},
    KnownWord{"millis", Quantity::time},
    KnownWord{"micros", Quantity::time},
    KnownWord{"pressure", Quantity::other},
    KnownWord{"baro", Quantity::other},
    KnownWord{"altitude", Quantity::other},
    KnownWord{"humidity", Quantity::other},
    KnownWord{"voltage", Quantity::other},
    KnownWord{"battery", Quantity::other},
    KnownWord{"calibration", Quantity::other},
    KnownWord{"steps", Quantity::other},
    KnownWord{"bias", Quantity::other},
    KnownWord{"offset", Quantity::other},
    KnownWord{"offsets", Quantity::other},
    KnownWord{"range", Quantity::other},
    KnownWord{"std", Quantity::other},
    KnownWord{"hz", Quantity::other},
};

// Letters that are a name only with an axis right behind them.
constexpr std::array stems{
    KnownWord{"g", Quantity::rate},         KnownWord{"gy", Quantity::rate},
    KnownWord{"w", Quantity::rate},         KnownWord{"rate", Quantity::rate},
    KnownWord{"a", Quantity::acceleration}, KnownWord{"ac", Quantity::acceleration},
    KnownWord{"m", Quantity::magnetic},     KnownWord{"h", Quantity::magnetic},
    KnownWord{"q", Quantity::quaternion},
};

constexpr std::string_view degree_signs[] = {"\xC2\xB0", "\xC2\xBA", "\xB0", "\xBA"};  // UTF-8, Latin-1

char small(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool is_capital(char c) {
  return c >= 'A' && c <= 'Z';
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), small);
  return out;
}

std::optional<std::size_t> axis_of(char c) {
  const char letter = small(c);
  if (letter < 'x' || letter > 'z') return std::nullopt;
  return static_cast<std::size_t>(letter - 'x');
}

template <typename Words>
std::optional<Quantity> find(const Words& words, std::string_view word) {
  const auto found =
      std::find_if(words.begin(), words.end(), [&](const KnownWord& known) { return known.word == word; });
  return found == words.end() ? std::nullopt : std::optional(found->quantity);
}

/// Takes what is asked for from the front of a text, whatever its case.
class Front {
 public:
  explicit Front(std::string_view text) : text_(text) {}

  bool take(std::string_view word) {
    if (text_.size() - at_ < word.size()) return false;
    for (std::size_t i = 0; i < word.size(); ++i)
      if (small(text_[at_ + i]) != word[i]) return false;
    at_ += word.size();
    return true;
  }
  /// The longest words stand first.
  bool take_any(std::initializer_list<std::string_view> words) {
    return std::any_of(words.begin(), words.end(), [&](std::string_view word) { return take(word); });
  }
  std::size_t at() const { return at_; }
  bool at_word_end() const { return at_ == text_.size() || !is_letter(text_[at_]); }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

struct Unit {
  std::size_t length = 0;  // 0: none
  double scale_dps = 0.0;  // of rates; 0: another quantity's
  bool of_rates_alone = false;
};

bool take_degrees(Front& front) {
  if (front.take_any({"degrees", "degree", "degs", "deg"})) return true;
  return std::any_of(std::begin(degree_signs), std::end(degree_signs),
                     [&](std::string_view sign) { return front.take(sign); });
}

void skip_gap(Front& front) {
  while (front.take_any({" ", "_"})) {
  }
}

/// "/s", " per second", "_s", "ps".
bool take_per_second(Front& front) {
  const bool is_joined = Front(front).take("_");
  skip_gap(front);
  if (!front.take_any({"/", "per", "p", ".", "s^-1"}) && !is_joined) return false;
  skip_gap(front);
  return front.take_any({"seconds", "second", "secs", "sec", "s"}) && front.at_word_end();
}

/// "rad/s", "milliradians per second", "deg/sec"; also "rads" and "degs" of a rate. "rad" and "deg" alone may
/// be those of an angle: they say nothing.
Unit rate_unit(std::string_view text) {
  Front front(text);
  if (front.take("mdps") && front.at_word_end()) return {front.at(), 1e-3, true};
  if (front.take_any({"dps", "o/s"}) && front.at_word_end())
    return {front.at(), 1.0, true};  // o: a degree sign
  front = Front(text);
  double scale_dps = front.take_any({"milli", "m"}) ? 1e-3 : 1.0;
  if (front.take_any({"radians", "radian", "rads", "rad"}))
    scale_dps *= dps_of_rad_s;
  else if (!take_degrees(front))
    return {};
  Front per = front;
  if (take_per_second(per)) return {per.at(), scale_dps, true};
  if (!front.at_word_end() || Front(text.substr(front.at())).take("c")) return {};
  const bool is_short_for_rate = small(text[front.at() - 1]) == 's' && front.at() <= 5;  // "rads", "mdegs"
  return {front.at(), is_short_for_rate ? scale_dps : 0.0, false};
}

std::size_t acceleration_unit_length(std::string_view text) {
  Front front(text);
  return front.take_any({"m/s^2", "m/s2", "m/s/s", "m/s\xC2\xB2"}) && front.at_word_end() ? front.at() : 0;
}

Unit other_unit(std::string_view text) {
  if (const std::size_t length = acceleration_unit_length(text); length > 0) return {length, 0.0, false};
  Front front(text);
  if (front.take_any({"mg", "ut", "gauss", "hz", "g", "ms", "us", "s", "c", "f", "v", "%"}) &&
      front.at_word_end())
    return {front.at(), 0.0, false};
  front = Front(text);
  if (take_degrees(front) && front.take("c") && front.at_word_end()) return {front.at(), 0.0, false};
  return {};
}

/// Where a name written in one piece goes on with its next word: "gyroX", "IMUGyro".
bool is_word_begin(std::string_view text, std::size_t at) {
  if (at == 0 || !is_letter(text[at - 1])) return true;
  if (!is_capital(text[at])) return false;
  return !is_capital(text[at - 1]) ||
         (at + 1 < text.size() && is_letter(text[at + 1]) && !is_capital(text[at + 1]));
}

std::size_t word_end(std::string_view text, std::size_t at) {
  ++at;
  while (at < text.size() && is_letter(text[at]) && !is_word_begin(text, at)) ++at;
  return at;
}

/// The axis that follows a word within the same name: "gyro_x", "gyro.x", "g[x]", "GyX", {"gyro":{"x":.
std::optional<std::size_t> axis_behind(std::string_view text, std::size_t end) {
  const std::size_t at = std::min(text.find_first_not_of("_.-[({\"':", end), text.size());
  if (at == text.size() || !axis_of(text[at]) || !is_word_begin(text, at)) return std::nullopt;
  return word_end(text, at) == at + 1 ? axis_of(text[at]) : std::nullopt;
}

}  // namespace

std::string_view name_of(Quantity quantity) {
  constexpr std::array<std::string_view, 9> names{
      "numbers without a name", "time",   "rates",       "accelerations", "a magnetic field",
      "a temperature",          "angles", "quaternions", "other values"};
  return names[static_cast<std::size_t>(quantity)];
}

std::size_t unit_length(std::string_view text) {
  const Unit rate = rate_unit(text);
  return rate.length > 0 ? rate.length : other_unit(text).length;
}

void WordReader::words(std::string_view text) {
  named_in_gap_ = joined_ = false;
  is_first_word_ = true;
  axis_.reset();
  for (std::size_t at = 0; at < text.size();) {
    const bool is_sign = static_cast<unsigned char>(text[at]) >= 0x80;
    if (!is_letter(text[at]) && !is_sign) {
      if (text[at] == ' ' || text[at] == '\t' || text[at] == ',' || text[at] == ';') joined_ = false;
      ++at;
      continue;
    }
    if (is_sign || is_word_begin(text, at)) {
      const Unit found = rate_unit(text.substr(at));
      if (found.length > 0) {
        unit(found.scale_dps, text.substr(at, found.length), found.of_rates_alone);
        at += found.length;
        continue;
      }
      if (const std::size_t length = acceleration_unit_length(text.substr(at)); length > 0) {
        at += length;
        continue;
      }
    }
    const std::size_t end = is_sign ? at + 1 : word_end(text, at);
    const bool in_number = at > 0 && is_digit(text[at - 1]);  // "0x50"
    if (!is_sign && !in_number) word(text, at, end);
    is_first_word_ = false;
    at = end;
  }
}

void WordReader::word(std::string_view text, std::size_t begin, std::size_t end) {
  const std::string word = lower(text.substr(begin, end - begin));
  const bool has_digit = end < text.size() && is_digit(text[end]);
  const bool was_angle = named_in_gap_ && quantity_ == Quantity::angle;
  if (was_angle && (word == "rate" || word == "vel" || word == "velocity" || word == "speed"))
    return name(Quantity::rate, axis_);  // "yaw rate", "AngVelX"
  if (word == "vector" && named_in_gap_ && quantity_ == Quantity::rate)
    return name(Quantity::quaternion, std::nullopt);  // "rotation vector"
  if (word.size() == 1 && axis_of(word[0])) return name(quantity_, axis_of(word[0]));
  if (std::optional<Quantity> known = find(known_words, word)) {
    if (*known == Quantity::time && named_in_gap_) return;                          // "in g's"
    if (*known == Quantity::rate && was_angle && joined_) known = Quantity::angle;  // "angleGyroX"
    joined_ = true;
    if (word == "yaw" || word == "yawrate") return name(*known, 2);
    if (word == "pitch" || word == "pitchrate") return name(*known, 1);
    if (word == "roll" || word == "rollrate") return name(*known, 0);
    return name(*known, std::nullopt);
  }
  const bool is_label =
      is_first_word_ && end < text.size() && text[end] == ':';  // "G: 1 2 3", not "Acc in G:"
  if (const auto stem = find(stems, word);
      stem && (axis_behind(text, end) || (word == "q" && has_digit) || (is_label && word.size() == 1)))
    return name(*stem, std::nullopt);
  const std::optional<std::size_t> axis = axis_of(word.back());
  const std::string_view rest = std::string_view(word).substr(0, word.size() - 1);
  if (const auto known = axis ? find(known_words, rest) : std::nullopt) return name(*known, axis);
  if (const auto stem = axis || (word.back() == 'w' && rest == "q") ? find(stems, rest) : std::nullopt)
    return name(*stem, axis);
  if (word == "raw" || word == "lsb" || word == "counts" || word == "count") unit(-1.0, "counts", false);
}

void WordReader::name(Quantity quantity, std::optional<std::size_t> axis) {
  named_[static_cast<std::size_t>(quantity)] = true;
  if (quantity != quantity_) begin_group(quantity);
  if (axis) axis_ = axis;
  named_in_gap_ = true;
}

void WordReader::begin_group(Quantity quantity) {
  quantity_ = quantity;
  group_ = meanings_.size();
  axes_named_ = false;
  scale_dps_ = 0.0;
  unit_.clear();
}

/// Counts, whose scale no word says: -1, kept as 0 with their name.
void WordReader::unit(double scale_dps, std::string_view text, bool of_rates_alone) {
  const double said_dps = std::max(scale_dps, 0.0);
  if (of_rates_alone) {
    named_[static_cast<std::size_t>(Quantity::rate)] = true;
    last_scale_dps_ = said_dps;
    last_unit_ = text;
  }
  if (named_in_gap_ || group_ == meanings_.size()) {
    if (of_rates_alone && quantity_ == Quantity::none) begin_group(Quantity::rate);
    scale_dps_ = said_dps;
    unit_ = text;
  }
  if (named_in_gap_) return;
  for (std::size_t i = of_rates_alone ? 0 : group_; i < meanings_.size(); ++i) {  // "0.01, -0.02, 0.35 rad/s"
    Meaning& meaning = meanings_[i];
    const bool becomes_rate = of_rates_alone && i >= group_ && meaning.quantity == Quantity::none;
    if (!meaning.unit.empty() || (meaning.quantity != Quantity::rate && !becomes_rate)) continue;
    meaning.quantity = Quantity::rate;
    meaning.scale_dps = said_dps;
    meaning.unit = text;
  }
}

void WordReader::number() {
  Meaning meaning{
      .quantity = quantity_, .axis = axis_, .axis_named = axis_.has_value(), .scale_dps = 0.0, .unit = {}};
  if (quantity_ == Quantity::rate) {
    meaning.scale_dps = scale_dps_;
    meaning.unit = unit_;
  }
  axes_named_ |= axis_.has_value();
  const std::size_t order = meanings_.size() - group_;
  if (!axes_named_ && order < 3) meaning.axis = order;
  meanings_.push_back(meaning);
  axis_.reset();
  named_in_gap_ = false;
}

}  // namespace thermorig::sensors
