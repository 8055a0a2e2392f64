// SPDX-License-Identifier: MIT
#include "found_ports.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "print/output.h"
#include "print/text_columns.h"
#include "thermorig/io/port.h"

namespace thermorig::app {

namespace {

using rig::PortFinding;

std::string role_text(const PortFinding& finding) {
  if (finding.role) return std::string(name_of(*finding.role));
  return finding.problem.empty() ? "unknown" : "closed";
}

std::string health_text(const PortFinding& finding) {
  if (!finding.problem.empty()) return "-";
  if (!finding.role) return "-";
  if (finding.rate_hz <= 0) return "answers";
  return fmt::format("{:.1f} /s", finding.rate_hz);
}

std::string baud_text(const PortFinding& finding) {
  return finding.role && finding.baud > 0 ? std::to_string(finding.baud) : "-";
}

std::string table_text(const std::vector<PortFinding>& findings) {
  Table table({"role", "port", "usb", ">baud", ">rate", "how known"});
  for (const PortFinding& finding : findings) {
    const std::string& usb = finding.info.usb_path;
    table.add({role_text(finding), finding.info.path, usb.empty() ? "-" : usb, baud_text(finding),
               health_text(finding), finding.problem.empty() ? finding.how : finding.problem});
  }
  return table.text();
}

nlohmann::json json_of(const PortFinding& finding) {
  nlohmann::json object{{"port", finding.info.path},         {"description", finding.info.description},
                        {"usb_path", finding.info.usb_path}, {"usb_id", finding.info.usb_id},
                        {"serial", finding.info.serial},     {"baud", finding.baud},
                        {"rate_hz", finding.rate_hz},        {"how", finding.how},
                        {"problem", finding.problem},        {"advice", finding.advice}};
  object["role"] = finding.role ? nlohmann::json(name_of(*finding.role)) : nlohmann::json();
  if (finding.role == Device::gyro) object["gyro_protocol"] = finding.protocol;
  if (finding.role == Device::servo) object["servo_protocol"] = finding.protocol;
  if (finding.text_format) object["text_format"] = format_json(*finding.text_format);
  return object;
}

std::vector<std::string> missing_roles(const std::vector<PortFinding>& findings) {
  std::vector<std::string> missing;
  for (Device device : all_devices)
    if (std::none_of(findings.begin(), findings.end(),
                     [&](const auto& finding) { return finding.role == device; }))
      missing.emplace_back(name_of(device));
  return missing;
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

/// The lines of [gyro] and [gyro.text] that a person has to fill in, with what is proposed.
std::string profile_lines(const PortFinding& finding) {
  const sensors::TextFormat& format = *finding.text_format;
  const TextColumns& columns = format.columns;
  std::string text = "        [gyro]\n        protocol = \"text\"\n        [gyro.text]\n";
  text += fmt::format("        prefix = {}\n", nlohmann::json(printable(columns.prefix)).dump());
  for (std::size_t axis = 0; axis < 3; ++axis)
    text += fmt::format("        {}_column = {}{}\n", "xyz"[axis], columns.rate[axis],
                        format.rates_known ? "" : "  # a guess");
  const char* const scales =
      format.is_counts ? "1/131 = 0.00763359, 1/65.5 = 0.0152672, 1/32.8 = 0.0304878, 1/16.4 = 0.0609756"
                       : "1 for deg/s, 57.2958 for rad/s";
  text += format.scale_known ? fmt::format("        scale_dps = {:.6g}\n", columns.scale_dps)
                             : fmt::format("        scale_dps = ?  # {}\n", scales);
  if (columns.time >= 0)
    text += fmt::format("        time_column = {}\n        time_unit_s = {:g}\n", columns.time,
                        columns.time_unit_s);
  return text;
}

/// How the lines of a text gyro are read and why; what they do not say, a person has to.
std::string text_gyro_text(const PortFinding& finding, const RigProfile& profile) {
  if (!finding.text_format || !finding.role) return "";
  const sensors::TextFormat& format = *finding.text_format;
  std::string text = fmt::format("\nnote  the gyro on {} prints lines such as:\n        {}\n",
                                 printable(finding.info.path), printable(format.sample_line));
  text += fmt::format("      why: {}\n", printable(assumptions_text(format)));
  for (const std::string& remark : format.remarks) text += fmt::format("      {}\n", printable(remark));
  const bool is_other = columns_text(profile.gyro.text) != columns_text(format.columns);
  if (profile.gyro.protocol == finding.protocol && is_other)
    return text + fmt::format("      the profile says otherwise, and is kept: {}\n",
                              printable(columns_text(profile.gyro.text)));
  if (format.is_known())
    return text + fmt::format("      taken: {}\n", printable(columns_text(format.columns)));
  return text +
         fmt::format("      not taken: {}\n      fill in the profile:\n{}", sensors::open_question(format),
                     profile_lines(finding)) +
         "      or, on a terminal: ports --save NAME asks for one turn by hand\n";
}

/// What a port sends that cannot be recorded, and what to do about it.
std::string advice_text(const PortFinding& finding) {
  if (finding.advice.empty()) return "";
  return fmt::format("\nnote  {} sends {}\n  try: {}\n", printable(finding.info.path), printable(finding.how),
                     printable(finding.advice));
}

/// Which roles are missing, and what a person can do about it, by what was seen of the ports.
std::string missing_text(const FoundPorts& found) {
  if (found.missing.empty()) return "";
  const auto is_closed = [](const PortFinding& finding) { return !finding.problem.empty(); };
  const bool any_closed = std::any_of(found.findings.begin(), found.findings.end(), is_closed);
  const char* advice = any_closed ? "thermorig doctor (says why a port cannot be opened)"
                                  : "check its power, and that its cable carries data; `thermorig look PORT` "
                                    "shows what an unknown board sends";
  return fmt::format("\nmissing  {}\n  try: {}\n", joined(found.missing), advice);
}

/// What to type next, for copy and paste. Another gyro protocol than the usual one can only be said in a
/// profile.
std::string command_with_ports(const FoundPorts& found) {
  if (!found.saved.name.empty())
    return "thermorig record --environment kitchen --rig " + printable(found.saved.name);
  if (found.profile.gyro.protocol != GyroProfile().protocol) return "thermorig ports --save bench";
  return fmt::format(
      "thermorig record --environment kitchen --camera {0} --gyro {1} --servo {2}\n"
      "save  thermorig ports {0} {1} {2} --save bench",
      printable(found.profile.camera.link.port), printable(found.profile.gyro.link.port),
      printable(found.profile.servo.link.port));
}

}  // namespace

std::vector<io::PortInfo> ports_to_hear(const std::vector<std::string>& named) {
  std::vector<io::PortInfo> listed = io::list_ports();
  if (named.empty()) return listed;
  std::vector<io::PortInfo> ports;
  for (const std::string& name : named) {
    const std::string path = io::resolve_port(name);
    const auto known =
        std::find_if(listed.begin(), listed.end(), [&](const auto& port) { return port.path == path; });
    ports.push_back(known == listed.end() ? io::PortInfo{.path = path} : *known);
  }
  return ports;
}

FoundPorts found_ports(std::vector<PortFinding> findings, const RigProfile& profile, SavedProfile saved) {
  const auto role_first = [](const PortFinding& finding) {
    return finding.role ? index_of(*finding.role) : device_count;
  };
  std::stable_sort(findings.begin(), findings.end(),
                   [&](const auto& a, const auto& b) { return role_first(a) < role_first(b); });
  FoundPorts found;
  found.missing = missing_roles(findings);
  found.profile = rig::apply_findings(profile, findings, found.ambiguous);
  found.findings = std::move(findings);
  found.saved = std::move(saved);
  return found;
}

ExitCode FoundPorts::code() const {
  if (is_whole_rig()) return ExitCode::ok;
  const bool is_barred = std::any_of(findings.begin(), findings.end(), [](const PortFinding& finding) {
    return finding.code == ExitCode::no_permission;
  });
  return is_barred ? ExitCode::no_permission : ExitCode::device_missing;
}

std::string text_of(const FoundPorts& found) {
  std::string text = table_text(found.findings);
  for (const std::string& sentence : found.ambiguous)
    text += fmt::format("\nnote  {}\n", printable(sentence));
  for (const PortFinding& finding : found.findings)
    text += text_gyro_text(finding, found.profile) + advice_text(finding);
  text += missing_text(found);
  if (!found.saved.name.empty()) text += fmt::format("\nsaved {}\n", printable(found.saved.file.string()));
  if (!found.is_whole_rig()) return text;  // there is nothing yet to record with
  return text + fmt::format("{}next  {}\n", found.saved.name.empty() ? "\n" : "", command_with_ports(found));
}

nlohmann::json json_of(const FoundPorts& found) {
  nlohmann::json ports = nlohmann::json::array();
  for (const PortFinding& finding : found.findings) ports.push_back(json_of(finding));
  nlohmann::json object{{"ports", ports}, {"missing", found.missing}, {"ambiguous", found.ambiguous}};
  object["saved"] = found.saved.name.empty() ? nlohmann::json() : nlohmann::json(found.saved.file.string());
  return object;
}

}  // namespace thermorig::app
