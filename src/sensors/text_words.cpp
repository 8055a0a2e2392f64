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
    KnownWord{"gierrate", Quantity::rate},
    KnownWord{"nickrate", Quantity::rate},
    KnownWord{"drehrate", Quantity::rate},
    KnownWord{"drehraten", Quantity::rate},
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
    KnownWord{"ts", Quantity::time},
    KnownWord{"calibration", Quantity::other},
};

// What stands at such a word is not what the gyro measures now: a setting, a wish, a statistic.
constexpr auto modifiers = std::to_array<std::string_view>(
    {"servo",   "servos",  "motor",     "motors",      "wheel",      "wheels",     "stepper",    "rotor",
     "gimbal",  "pid",     "rc",        "controller",  "encoder",    "turntable",  "joint",      "pwm",
     "pulse",   "des",     "sp",        "soll",        "sollwert",   "consigne",   "odr",        "lpf",
     "dlpf",    "mean",    "median",    "avg",         "average",

     "max",     "min",     "maximum",   "minimum",     "limit",      "fs",         "fsr",        "fullscale",
     "range",   "scale",   "sens",      "sensitivity", "resolution", "target",     "setpoint",   "desired",
     "demand",  "command", "commanded", "cmd",         "ref",        "reference",  "goal",       "expected",
     "nominal", "error",   "errors",    "err",         "noise",      "bias",       "biases",     "offset",
     "offsets", "drift",   "std",       "stddev",      "sigma",      "rms",        "variance",   "threshold",
     "peak",    "sum",     "total",     "integral",    "delta",      "correction", "uncertainty"});

// Beside a unit they say that the numbers are no whole ones of it.
constexpr auto factor_words = std::to_array<std::string_view>(
    {"tenth", "tenths", "hundredth", "hundredths", "thousandth", "thousandths", "half", "halves", "raw"});

// A line above the numbers with such a word does not say what they are.
constexpr auto doubt_words = std::to_array<std::string_view>(
    {"off",     "disabled",   "no",      "not",      "without", "divide", "divided", "multiply",
     "convert", "conversion", "press",   "rotate",   "raw",     "lsb",    "needs",   "need",
     "failed",  "fail",       "missing", "constant", "switch",  "error"});

// They name nothing.
constexpr auto fillers = std::to_array<std::string_view>(
    {"hz",     "in",         "of",       "the",     "is",       "are",      "and",        "at",    "data",
     "value",  "values",     "val",      "reading", "readings", "axis",     "axes",       "unit",  "units",
     "scaled", "calibrated", "filtered", "per",     "as",       "velocity", "velocities", "vel",   "speed",
     "rate",   "rates",      "sensor",   "filt",    "cal",      "measured", "form",       "output"});

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
bool holds(const Words& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
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
  double scale_dps = 0.0;  // 0: "deg" or "rad", which may be an angle's
};

/// Letters in front of a unit, and what they multiply it with.
struct Multiple {
  std::string_view letters;
  double factor;
};
constexpr std::array multiples{Multiple{"milli", 1e-3}, Multiple{"micro", 1e-6}, Multiple{"centi", 1e-2},
                               Multiple{"m", 1e-3},     Multiple{"u", 1e-6},     Multiple{"c", 1e-2},
                               Multiple{"d", 1e-1},     Multiple{"", 1.0}};

bool take_degrees(Front& front) {
  if (front.take_any({"degrees", "degree", "degs", "deg"})) return true;
  return std::any_of(std::begin(degree_signs), std::end(degree_signs),
                     [&](std::string_view sign) { return front.take(sign); });
}

void skip_gap(Front& front) {
  while (front.take_any({" ", "_"})) {
  }
}

/// "/s", " per second", "_s", "ps", " s^-1", "/min", "/h": seconds; 0: nothing of the kind.
double take_per_time(Front& front) {
  const bool is_joined = Front(front).take("_");
  skip_gap(front);
  if (front.take_any({"s^-1", "s-1"})) return 1.0;
  if (!front.take_any({"/", "per", "p", "."}) && !is_joined) return 0.0;
  skip_gap(front);
  Front hours = front;
  if (hours.take_any({"hours", "hour", "hr", "h"}) && hours.at_word_end()) {
    front = hours;
    return 3600.0;
  }
  Front minutes = front;
  if (minutes.take_any({"minutes", "minute", "min"}) && minutes.at_word_end()) {
    front = minutes;
    return 60.0;
  }
  return front.take_any({"seconds", "second", "secs", "sec", "s"}) && front.at_word_end() ? 1.0 : 0.0;
}

/// One unit's size in degrees; 0: none.
double take_angle(Front& front) {
  if (front.take_any({"radians", "radian", "rads", "rad"})) return dps_of_rad_s;
  if (front.take_any({"revolutions", "revolution", "revs", "rev", "turns", "turn"})) return 360.0;
  return take_degrees(front) ? 1.0 : 0.0;
}

/// "rad/s", "milliradians per second", "deg/min", "rpm"; also "rads" and "degs" of a rate. "rad" and "deg"
/// alone may be those of an angle: they say nothing.
Unit rate_unit(std::string_view text) {
  Front rpm(text);
  if (rpm.take("rpm") && rpm.at_word_end()) return {rpm.at(), 6.0};
  for (const auto& [letters, factor] : multiples) {
    Front front(text);
    if (!front.take(letters)) continue;
    Front dps = front;
    if (dps.take_any({"dps", "o/s"}) && dps.at_word_end()) return {dps.at(), factor};  // o: a degree sign
    const double size_deg = take_angle(front);
    if (size_deg == 0.0) continue;
    Front per = front;
    if (const double time_s = take_per_time(per); time_s > 0) return {per.at(), factor * size_deg / time_s};
    if (!front.at_word_end() || Front(text.substr(front.at())).take("c") || size_deg == 360.0) continue;
    const bool is_short_for_rate = small(text[front.at() - 1]) == 's' && front.at() <= 5;  // "rads", "mdegs"
    return {front.at(), is_short_for_rate ? factor * size_deg : 0.0};
  }
  return {};
}

std::size_t other_unit_length(std::string_view text) {
  Front front(text);
  if (front.take_any({"m/s^2", "m/s2", "m/s/s", "m/s\xC2\xB2", "mg", "ut", "gauss", "hz", "g", "ms", "us",
                      "s", "c", "f", "v", "%"}) &&
      front.at_word_end())
    return front.at();
  front = Front(text);
  return take_degrees(front) && front.take("c") && front.at_word_end() ? front.at() : 0;
}

bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

/// A number that multiplies what stands before it: "deg/s*10", "gx * 1000", "rad/s x 100", "deg/s^2".
bool is_multiplied(std::string_view behind) {
  behind.remove_prefix(std::min(behind.find_first_not_of(" \t"), behind.size()));
  Front front(behind);
  if (!front.take_any({"*", "x", "\xC3\x97", "^", "/"})) return false;
  behind.remove_prefix(front.at());
  behind.remove_prefix(std::min(behind.find_first_not_of(" \t"), behind.size()));
  return !behind.empty() && is_digit(behind[0]);
}

/// A number stands right before: "1e-3 rad/s", "0.1 dps"; or counts of the unit are meant: "LSB/dps". The
/// digits of a name ("MPU6050 dps") are no number.
bool is_counted(std::string_view before) {
  const std::size_t with_blanks = before.size();
  before = before.substr(0, before.find_last_not_of(" \t*") + 1);
  if (before.empty()) return false;
  if (before.back() == '/' || lower(before).ends_with(" per")) return true;
  if (!is_digit(before.back())) return false;
  if (before.size() == with_blanks) return true;  // "gyro500dps"
  const std::size_t begin = before.find_last_not_of("0123456789.eE+-");
  return begin == before.npos || (!is_letter(before[begin]) && before[begin] != '_');
}

/// A unit behind which the line goes on with "=" or ":" is a name: "ms=5".
bool is_name_at(std::string_view behind) {
  const std::size_t at = behind.find_first_not_of(" \t\"'");
  return at != behind.npos && (behind[at] == ':' || behind[at] == '=');
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

/// "gyro500dps": digits that a unit follows are no number of the name.
bool unit_follows_digits(std::string_view text, std::size_t at) {
  const std::size_t behind = text.find_first_not_of("0123456789.", at);
  return behind != text.npos && rate_unit(text.substr(behind)).length > 0;
}

/// Where the unit is one of rates.
bool may_be_rate(Quantity quantity) {
  return quantity == Quantity::none || quantity == Quantity::angle || quantity == Quantity::other;
}

}  // namespace

std::string_view name_of(Quantity quantity) {
  constexpr auto names = std::to_array<std::string_view>(
      {"numbers without a name", "time", "rates", "accelerations", "a magnetic field", "a temperature",
       "angles", "quaternions", "other values"});
  return names[static_cast<std::size_t>(quantity)];
}

std::size_t unit_length(std::string_view text) {
  const Unit rate = rate_unit(text);
  return rate.length > 0 ? rate.length : other_unit_length(text);
}

bool holds_doubt(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = is_letter(text[at]) ? word_end(text, at) : at + 1;
    if (holds(doubt_words, lower(text.substr(at, end - at)))) return true;
    at = end;
  }
  return false;
}

double scale_of_unit(std::string_view text) {
  return rate_unit(text).scale_dps;
}

void WordReader::words(std::string_view text) {
  gap_ = {};
  const std::size_t bracket = text.find_last_of("([)]");  // "(in 0.1 dps)"
  gap_.opens = bracket != text.npos && (text[bracket] == '(' || text[bracket] == '[');
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    const bool is_sign = static_cast<unsigned char>(c) >= 0x80;
    if (!is_letter(c) && !is_sign) {
      if (is_blank(c) || c == ',' || c == ';') gap_.is_joined = false;
      if (c == '{' || c == '[' || c == '(') ++brackets_;
      if (c == '[' && gap_.is_named && at + 2 < text.size() && text[at + 1] >= '0' && text[at + 1] <= '2' &&
          text[at + 2] == ']')
        gap_.axes.push_back(static_cast<std::size_t>(text[at + 1] - '0'));  // "gyro[2]"
      if ((c == '}' || c == ']' || c == ')') && brackets_ > 0) {
        --brackets_;
        gap_.closes = true;
        if (modified_in_ && brackets_ < *modified_in_) modified_in_.reset();
      }
      ++at;
      continue;
    }
    if (const std::size_t length = take_unit(text, at); length > 0) {
      at += length;
      continue;
    }
    const std::size_t end = is_sign ? at + 1 : word_end(text, at);
    const bool in_number = at > 0 && is_digit(text[at - 1]);  // "0x50"
    if (!is_sign && !in_number) {
      const bool was_unknown = std::exchange(gap_.is_unknown, false);
      word({text, at, end});
      gap_.is_last_unknown = gap_.is_unknown;
      gap_.is_unknown |= was_unknown;
    }
    if (gap_.is_named && is_multiplied(text.substr(end))) unit(0.0, "a multiple");
    gap_.is_first_word = false;
    at = end;
  }
}

/// The length of a unit that stands at `at`.
std::size_t WordReader::take_unit(std::string_view text, std::size_t at) {
  const bool is_sign = static_cast<unsigned char>(text[at]) >= 0x80;
  if (!is_sign && !is_word_begin(text, at)) return 0;
  const std::string_view rest = text.substr(at);
  const Unit found = rate_unit(rest);
  if (found.length > 0 && !(is_tail() && is_name_at(rest.substr(found.length)))) {
    const bool has_factor = is_counted(text.substr(0, at)) || is_multiplied(rest.substr(found.length));
    const std::size_t closing = rest.find_first_not_of(" \t", found.length);
    gap_.closes_factor = is_tail() && closing != rest.npos && (rest[closing] == ')' || rest[closing] == ']');
    unit(has_factor ? 0.0 : found.scale_dps, rest.substr(0, found.length));
    return found.length;
  }
  const std::size_t length = other_unit_length(rest);
  const bool is_behind_number =
      is_tail() && text.find_first_not_of(" \t)]}", 0) == at && !is_name_at(rest.substr(length));
  const bool is_acceleration = length > 2 && rest[1] == '/';
  return is_behind_number || is_acceleration ? length : 0;
}

void WordReader::word(const Word& at) {
  const auto [text, begin, end] = at;
  const std::string word = lower(text.substr(begin, end - begin));
  const bool has_digit = end < text.size() && is_digit(text[end]);
  const bool was_angle = gap_.is_named && gap_.quantity == Quantity::angle;
  if (was_angle &&
      (word == "rate" || word == "rates" || word == "vel" || word == "velocity" || word == "speed"))
    return name(Quantity::rate, std::nullopt);  // "yaw rate", "AngVelX"
  if (holds(factor_words, word)) {
    gap_.has_factor = true;
    return;
  }
  if (holds(fillers, word)) return;
  if (word == "vector" && gap_.is_named && gap_.quantity == Quantity::rate)
    return name(Quantity::quaternion, std::nullopt);  // "rotation vector"
  if (word == "x" && has_digit && end + 1 < text.size() && is_digit(text[end + 1]))
    return unit(0.0, "a multiple");  // "x10", which is no axis
  if (word.size() == 1 && axis_of(word[0])) return gap_.axes.push_back(*axis_of(word[0]));
  if (word.size() == 3 && axis_of(word[0]) && axis_of(word[1]) && axis_of(word[2])) {  // "xyz", "zyx"
    for (const char letter : word) gap_.axes.push_back(*axis_of(letter));
    return;
  }
  if (holds(modifiers, word)) {
    gap_.is_modified = true;
    modified_in_ = brackets_ + 1;
    return;
  }
  if (std::optional<Quantity> known = find(known_words, word)) {
    if (*known == Quantity::time && gap_.is_named) return;                                 // "in g's"
    if (*known == Quantity::rate && was_angle && gap_.is_joined) known = Quantity::angle;  // "angleGyroX"
    const bool is_roll = word == "yaw" || word == "pitch" || word == "roll";
    if (is_roll && (gap_.is_named ? gap_.quantity == Quantity::rate : roll_is_rate_)) {
      known = Quantity::rate;  // "gyro roll=1 pitch=2 yaw=3"
      gap_.roll_is_rate = true;
    }
    gap_.is_joined = true;
    const bool is_numbered =
        has_digit || (end + 1 < text.size() && text[end] == '_' && is_digit(text[end + 1]));
    gap_.is_modified |=
        *known == Quantity::rate && is_numbered && !unit_follows_digits(text, end);  // "gyro2"
    if (word == "ypr" || word == "rpy")
      gap_.axes = word == "ypr" ? std::vector<std::size_t>{2, 1, 0} : std::vector<std::size_t>{0, 1, 2};
    if (word == "yaw" || word == "yawrate" || word == "gierrate") return name(*known, 2);
    if (word == "pitch" || word == "pitchrate" || word == "nickrate") return name(*known, 1);
    if (word == "roll" || word == "rollrate") return name(*known, 0);
    return name(*known, std::nullopt);
  }
  const bool is_label =
      gap_.is_first_word && end < text.size() && text[end] == ':';  // "G: 1 2 3", not "Acc in G:"
  if (const auto stem = find(stems, word);
      stem && (axis_behind(text, end) || (word == "q" && has_digit) || (is_label && word.size() == 1)))
    return name(*stem, std::nullopt);
  const std::optional<std::size_t> axis = axis_of(word.back());
  const std::string_view rest = std::string_view(word).substr(0, word.size() - 1);
  if (const auto known = axis ? find(known_words, rest) : std::nullopt) return name(*known, axis);
  if (const auto stem = axis || (word.back() == 'w' && rest == "q") ? find(stems, rest) : std::nullopt)
    return name(*stem, axis);
  if (const auto known =
          axis_of(word[0]) ? find(known_words, std::string_view(word).substr(1)) : std::nullopt)
    return name(*known, axis_of(word[0]));  // "xgyro", "gyroXangle"
  if (word == "lsb" || word == "counts" || word == "count") return unit(0.0, "counts");
  gap_.is_unknown = true;
}

void WordReader::name(Quantity quantity, std::optional<std::size_t> axis) {
  named_[static_cast<std::size_t>(quantity)] = true;
  if (axis) gap_.axes.push_back(*axis);
  gap_.is_named = true;
  gap_.quantity = quantity;
}

void WordReader::begin_group(Quantity quantity) {
  end_group();
  quantity_ = quantity;
  group_ = meanings_.size();
  is_named_ = is_modified_ = axes_named_ = roll_is_rate_ = false;
  scale_dps_ = 0.0;
  unit_.clear();
  axes_.clear();
}

/// A word that nobody knows before several numbers is the line's name, not theirs. Of more than three numbers
/// without names nobody knows which are x, y, z.
void WordReader::end_group() {
  if (quantity_ == Quantity::rate && !axes_named_ && meanings_.size() > group_ + 3)
    for (std::size_t i = group_; i < meanings_.size(); ++i) meanings_[i].axis.reset();
  if (axes_named_)  // "omega_left=1 omega_right=2 gz=3"
    for (std::size_t i = group_; i < meanings_.size(); ++i)
      if (!meanings_[i].axis_named) meanings_[i].axis.reset();
  if (quantity_ != Quantity::other || is_named_ || is_modified_ || axes_named_) return;
  if (meanings_.size() < group_ + 2) return;
  for (std::size_t i = group_; i < meanings_.size(); ++i)
    if (meanings_[i].quantity == Quantity::other) meanings_[i].quantity = Quantity::none;
}

/// Whether what stands between the numbers names something that is no measured rate.
bool WordReader::is_of_something_else() const {
  return gap_.is_modified || (modified_in_ && brackets_ >= *modified_in_);
}

/// A unit right behind numbers is theirs; one behind a name is that of the numbers to come. 0: words that
/// stand where a unit does, but do not say how large it is.
void WordReader::unit(double scale_dps, std::string_view text) {
  const bool is_of_another = gap_.is_named && gap_.is_last_unknown;  // "gx gy gz motor[rpm]"
  if (gap_.has_factor || is_of_another) scale_dps = 0.0;
  if (scale_dps > 0.0 && !is_of_something_else()) {
    named_[static_cast<std::size_t>(Quantity::rate)] = true;
    is_contradicted_ |= said_scale_dps_ > 0.0 && said_scale_dps_ != scale_dps;
    said_scale_dps_ = scale_dps;
    said_unit_ = text;
  }
  if (is_tail()) return unit_behind(scale_dps, text);
  if (!gap_.unit.empty() && gap_.unit != text) scale_dps = 0.0;
  gap_.scale_dps = scale_dps;
  gap_.unit = text;
}

void WordReader::unit_behind(double scale_dps, std::string_view text) {
  const bool says_rate = scale_dps > 0.0 && !is_modified_;
  const bool is_of_last_alone = (was_opened_ && !gap_.closes) ||          // "gz: 3 (500 dps)"
                                (axes_named_ && !meanings_.back().axis);  // "gx gy gz servo: 1 2 3 4 dps"
  gap_.has_unit_behind = true;
  const bool is_list = meanings_.size() == group_ + 3 || axes_named_ || is_named_;
  for (std::size_t i = is_of_last_alone ? meanings_.size() - 1 : group_; i < meanings_.size();
       ++i) {  // "0.01, -0.02, 0.35 rad/s"
    Meaning& meaning = meanings_[i];
    const bool becomes_rate =
        says_rate && may_be_rate(meaning.quantity) && (is_list || meanings_.size() == group_ + 1);
    if (!meaning.unit.empty()) continue;
    if (meaning.quantity != Quantity::rate && !becomes_rate) {
      if (i + 1 == meanings_.size()) meaning.unit = text;  // "90 deg" among others
      continue;
    }
    meaning.quantity = Quantity::rate;
    meaning.scale_dps = scale_dps;
    meaning.unit = text;
  }
}

/// "target gx=1 gy=2 gz=3": names of the same kind and other axes go on with what was named before.
bool WordReader::goes_on_modified() const {
  if (!is_modified_ || !gap_.is_named || gap_.is_unknown || gap_.quantity != modified_ ||
      gap_.axes.size() != 1)
    return false;
  return std::find(modified_axes_.begin(), modified_axes_.end(), gap_.axes.front()) == modified_axes_.end();
}

void WordReader::number() {
  const bool begins_modified = is_of_something_else();
  const bool is_of_other = begins_modified || goes_on_modified();
  if (meanings_.empty()) begins_with_number_ = !gap_.is_named && !gap_.is_unknown && gap_.axes.empty();
  if (is_of_other || (!gap_.is_named && gap_.is_unknown)) {
    begin_group(Quantity::other);
    is_modified_ = is_of_other;
    modified_ = is_of_other && gap_.is_named ? gap_.quantity : Quantity::none;
    if (begins_modified) modified_axes_.clear();
    if (is_of_other && !gap_.axes.empty()) modified_axes_.push_back(gap_.axes.front());
  } else if (gap_.has_unit_behind && is_tail() && !axes_named_ && meanings_.size() >= group_ + 3) {
    begin_group(Quantity::none);  // the list ended with its unit
  } else if (gap_.is_named) {
    if (gap_.quantity != quantity_ || !is_named_ || is_modified_) begin_group(gap_.quantity);
    is_named_ = true;
    roll_is_rate_ = gap_.roll_is_rate;
  }
  if (gap_.closes_factor && was_opened_ && !gap_.opens && is_tail()) drop_factor();
  if (!gap_.unit.empty()) {
    unit_ = gap_.unit;
    scale_dps_ = gap_.scale_dps;
  }
  if (!gap_.axes.empty() || gap_.is_named) axes_ = gap_.axes;
  Meaning meaning{.quantity = quantity_, .is_named = is_named_, .axis = {}, .unit = {}};
  if (!axes_.empty()) {
    meaning.axis = axes_.front();
    meaning.axis_named = axes_named_ = true;
    axes_.erase(axes_.begin());
  }
  const std::size_t order = meanings_.size() - group_;
  if (!axes_named_ && order < 3) meaning.axis = order;
  const bool becomes_rate = scale_dps_ > 0.0 && !is_modified_ && may_be_rate(quantity_);
  if (quantity_ == Quantity::rate || becomes_rate) {
    meaning.quantity = Quantity::rate;
    meaning.scale_dps = scale_dps_;
    meaning.unit = unit_;
  }
  meanings_.push_back(std::move(meaning));
  was_opened_ = gap_.opens;
  if (modified_in_ && brackets_ < *modified_in_) modified_in_.reset();
}

/// Of "gx (0.1 dps): 12" the second number is the rate, the first a part of its unit.
void WordReader::drop_factor() {
  Meaning& factor = meanings_.back();
  if (factor.axis_named) axes_ = {*factor.axis};
  unit_ = factor.unit.empty() ? "a factor" : factor.unit;
  scale_dps_ = 0.0;
  factor = {.quantity = Quantity::other, .axis = {}, .unit = {}};
  group_ = meanings_.size();
}

void WordReader::end() {
  end_group();
  if (begins_with_number_ && gap_.is_named)  // "1 2 3 gyro | 4 5 6 acc": the names stand behind
    for (Meaning& meaning : meanings_) meaning = {.quantity = Quantity::none, .axis = {}, .unit = {}};
  if (gap_.unit.empty() || !gap_.is_named || gap_.quantity != Quantity::rate) return;
  for (Meaning& meaning : meanings_)  // {"gyro":[1,2,3],"units":{"gyro":"rad/s"}}
    if (meaning.quantity == Quantity::rate && meaning.is_named && meaning.unit.empty()) {
      meaning.scale_dps = gap_.scale_dps;
      meaning.unit = gap_.unit;
    }
}

}  // namespace thermorig::sensors
