// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "output.h"
#include "profile_path.h"
#include "text_columns.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/detect.h"
#include "thermorig/rig/profile_file.h"

namespace thermorig::app {

namespace {

using rig::PortFinding;

/// The ports that were named, described as far as the system knows them; without names all that it lists.
std::vector<io::PortInfo> ports_to_hear(const std::vector<std::string>& named) {
  const std::vector<io::PortInfo> listed = io::list_ports();
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
                        {"problem", finding.problem}};
  object["role"] = finding.role ? nlohmann::json(name_of(*finding.role)) : nlohmann::json();
  if (finding.role == Device::gyro) object["gyro_protocol"] = finding.gyro_protocol;
  if (finding.text_format) object["text_format"] = format_json(*finding.text_format);
  return object;
}

/// An existing profile keeps everything but the ports: people edit these files.
RigProfile profile_to_save(const std::filesystem::path& path, const std::vector<PortFinding>& findings,
                           std::vector<std::string>& ambiguous) {
  RigProfile profile;
  profile.name = path.stem().string();
  if (std::filesystem::exists(path)) profile = rig::read_profile(path);
  return rig::apply_findings(profile, findings, ambiguous);
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
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// Text does not say what its columns are: how they were read is shown, to be checked by a person.
void print_text_gyro(const PortFinding& finding, const RigProfile& profile) {
  if (!finding.text_format) return;
  const sensors::TextFormat& format = *finding.text_format;
  print("\nnote  the gyro on {} prints lines such as: {}\n", printable(finding.info.path),
        printable(format.sample_line));
  print("      taken: {}\n", printable(columns_text(format.columns)));
  print("      why: {}\n", printable(assumptions_text(format)));
  if (columns_text(profile.gyro.text) != columns_text(format.columns))
    print("      the profile says otherwise, and is kept: {}\n", printable(columns_text(profile.gyro.text)));
  print("      check scale and columns: [gyro.text] in the profile\n");
}

/// What to type next, for copy and paste. Another gyro protocol than the usual one can only be said in a
/// profile.
std::string command_with_ports(const PortsOptions& options, const RigProfile& profile) {
  if (!options.save.empty()) return "thermorig record --environment kitchen --rig " + printable(options.save);
  if (profile.gyro.protocol != GyroProfile().protocol) return "thermorig ports --save bench";
  return fmt::format(
      "thermorig record --environment kitchen --camera {} --gyro {} --servo {}\nsave  thermorig ports --save "
      "bench",
      printable(profile.camera.link.port), printable(profile.gyro.link.port),
      printable(profile.servo.link.port));
}

void print_text(const PortsOptions& options, const std::vector<PortFinding>& findings,
                const RigProfile& profile, const std::vector<std::string>& ambiguous) {
  print("{}", table_text(findings));
  for (const std::string& sentence : ambiguous) print("\nnote  {}\n", printable(sentence));
  for (const PortFinding& finding : findings) print_text_gyro(finding, profile);
  const std::vector<std::string> missing = missing_roles(findings);
  if (!missing.empty()) print("\nmissing  {}\n", joined(missing));
  if (!options.save.empty()) print("\nsaved {}\n", printable(profile_path(options.save).string()));
  if (!missing.empty() || !ambiguous.empty()) return;  // there is nothing yet to record with
  print("{}next  {}\n", options.save.empty() ? "\n" : "", command_with_ports(options, profile));
}

void print_result_json(const PortsOptions& options, const std::vector<PortFinding>& findings,
                       const std::vector<std::string>& ambiguous) {
  nlohmann::json ports = nlohmann::json::array();
  for (const PortFinding& finding : findings) ports.push_back(json_of(finding));
  nlohmann::json object{{"ports", ports}, {"missing", missing_roles(findings)}, {"ambiguous", ambiguous}};
  object["saved"] =
      options.save.empty() ? nlohmann::json() : nlohmann::json(profile_path(options.save).string());
  print_json(object);
}

}  // namespace

ExitCode run(const PortsOptions& options) {
  const std::vector<io::PortInfo> ports = ports_to_hear(options.extra);
  if (ports.empty())
    throw Error(ExitCode::device_missing, "this machine has no serial port", "",
                "plug the devices in; without hardware: thermorig simulate");
  if (!options.json) {
    print("listening to {} port{} for up to 6 s ...\n\n", ports.size(), ports.size() == 1 ? "" : "s");
    flush_output();
  }
  std::vector<PortFinding> findings = rig::identify_devices(ports);
  const auto role_first = [](const PortFinding& finding) {
    return finding.role ? index_of(*finding.role) : device_count;
  };
  std::stable_sort(findings.begin(), findings.end(),
                   [&](const auto& a, const auto& b) { return role_first(a) < role_first(b); });
  std::vector<std::string> ambiguous;
  const auto file = options.save.empty() ? std::filesystem::path() : profile_path(options.save);
  const RigProfile profile = profile_to_save(file, findings, ambiguous);
  if (!file.empty()) rig::write_profile(file, profile);
  if (options.json)
    print_result_json(options, findings, ambiguous);
  else
    print_text(options, findings, profile, ambiguous);
  return missing_roles(findings).empty() && ambiguous.empty() ? ExitCode::ok : ExitCode::device_missing;
}

}  // namespace thermorig::app
