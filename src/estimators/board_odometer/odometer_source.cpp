// SPDX-License-Identifier: MIT
#include "thermorig/estimators/board_odometer/odometer_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "board_profile.h"
#include "odometer_text.h"

namespace thermorig::board_odometer {

namespace {

constexpr std::string_view prefix = "thermorig_odometer";

/// The shortest decimals that read back as the same float.
std::string number(float value) {
  const std::string text = fmt::format("{}", value);
  return text + (text.find_first_of(".e") == std::string::npos ? ".0f" : "f");
}

std::string since(const std::string& measured_utc) {
  return measured_utc.empty() ? "an assumption" : "measured " + embedded::comment_safe(measured_utc);
}

std::string rig_text(const RigProfile& rig, const thermorig_odometer_profile& board) {
  const GyroProfile& gyro = rig.gyro;
  return fmt::format(
             "/* SPDX-License-Identifier: MIT\n"
             " *\n"
             " * The rig of the profile \"{}\", for {}.h. Written by thermorig {}. */\n"
             "#ifndef {}_RIG_H\n"
             "#define {}_RIG_H\n\n"
             "#include \"{}.h\"\n\n"
             "static const {}_profile {}_rig = {{\n",
             embedded::comment_safe(rig.name), prefix, THERMORIG_VERSION, "THERMORIG_ODOMETER",
             "THERMORIG_ODOMETER", prefix, prefix, prefix) +
         fmt::format("    {}, /* degrees between neighbouring pixels */\n", number(board.pitch_deg)) +
         fmt::format("    {}, /* azimuth of growing columns: {} */\n", number(board.direction),
                     since(rig.camera.orientation_measured_utc)) +
         fmt::format("    {}, {}, /* axis of the gyro, and its sign */\n", board.gyro_axis, board.gyro_sign) +
         fmt::format("    {}, {}, /* s between its samples; how far their times may be off */\n",
                     number(board.gyro_period_s), number(board.gyro_time_sigma_s)) +
         fmt::format("    {}, {}, /* its bias and that one's sigma in later sessions, deg/s: {} */\n",
                     number(board.bias_dps), number(board.bias_sigma_dps), since(gyro.bias_measured_utc)) +
         fmt::format("    {}, {}, /* its scale: {} */\n", number(board.scale), number(board.scale_sigma),
                     since(gyro.scale_measured_utc)) +
         fmt::format("    {}, /* s, sigma of the camera's latency against the gyro */\n",
                     number(board.latency_sigma_s)) +
         fmt::format("    {}u, /* us between the points of the gyro's path */\n", board.knot_us) +
         "};\n\n#endif\n";
}

/// odometer_c with its parts in the places where they are first included: one file to add to a firmware.
class OneFile {
 public:
  OneFile() { add(std::string(odometer_c), ""); }
  const std::string& text() const { return text_; }

 private:
  void add(const std::string& text, std::string title) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (line == "#pragma once" || line == "/* SPDX-License-Identifier: MIT */") continue;
      if (line.starts_with("#include ")) {
        include(line);
        continue;
      }
      if (line.empty() && text_.ends_with("\n\n")) continue;  // beside what was left out
      if (!line.empty() && !title.empty()) {
        text_ += "/* ---- " + title + " ---- */\n\n";
        title.clear();
      }
      text_ += line + "\n";
    }
  }

  void include(const std::string& line) {
    if (!included_.insert(line).second) return;
    const auto& parts = odometer_parts();
    const auto part = std::find_if(parts.begin(), parts.end(), [&](const OdometerPart& one) {
      return line == fmt::format("#include \"{}.h\"", one.name);
    });
    if (part == parts.end()) {
      text_ += line + "\n";
      return;
    }
    std::string title(part->name);
    std::replace(title.begin(), title.end(), '_', ' ');
    add(std::string(part->text), title);
  }

  std::set<std::string> included_;
  std::string text_;
};

}  // namespace

OdometerSource odometer_source(const RigProfile& rig, const std::string& name) {
  embedded::require_name(name);
  const std::string constants = rig_text(rig, board_profile(rig));
  OdometerSource source;
  source.files.push_back({name + ".h", embedded::renamed(odometer_h, prefix, name)});
  source.files.push_back({name + ".c", embedded::renamed(OneFile().text(), prefix, name)});
  source.files.push_back({name + "_rig.h", embedded::renamed(constants, prefix, name)});
  source.state_bytes = THERMORIG_ODOMETER_STATE_BYTES;
  source.stack_bytes = THERMORIG_ODOMETER_STACK_BYTES;
  return source;
}

}  // namespace thermorig::board_odometer
