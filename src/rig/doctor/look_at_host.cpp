// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "thermorig/io/files/holder.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/doctor/host_facts.h"

namespace thermorig::doctor {

namespace {

namespace fs = std::filesystem;

/// The first line of a small file of the system, without its end; empty if it cannot be read.
std::string first_line(const fs::path& file) {
  std::string line;
  std::ifstream in(file);
  std::getline(in, line);
  return line;
}

/// At most the first 4096 lines of a file; none if it cannot be read.
std::vector<std::string> lines_of(const fs::path& file) {
  constexpr std::size_t most = 4096;
  std::vector<std::string> lines;
  std::ifstream in(file);
  for (std::string line; lines.size() < most && std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> pieces;
  std::istringstream in(text);
  for (std::string piece; std::getline(in, piece, at);) pieces.push_back(piece);
  return pieces;
}

/// One file of udev rules.
struct RuleFile {
  fs::path path;                   // as the system knows it, without the root
  std::vector<std::string> lines;  // without comments
};

bool is_rule(const std::string& line) {
  const auto first = line.find_first_not_of(" \t");
  return first != std::string::npos && line[first] != '#';
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// The rules in force: a file in /etc or /run stands for one of the same name in /usr/lib.
std::vector<RuleFile> udev_rules(const fs::path& root) {
  std::map<std::string, fs::path> by_name;  // later folders win: udev(7), "Rules files"
  for (const char* folder : {"lib/udev/rules.d", "usr/lib/udev/rules.d", "usr/local/lib/udev/rules.d",
                             "run/udev/rules.d", "etc/udev/rules.d"}) {
    std::error_code missing;
    for (fs::directory_iterator file(root / folder, missing), end; !missing && file != end;
         file.increment(missing))
      if (file->path().extension() == ".rules")
        by_name[file->path().filename().string()] = fs::path(folder) / file->path().filename();
  }
  std::vector<RuleFile> rules;
  for (const auto& [name, path] : by_name) {
    std::error_code unknown;
    if (!fs::is_regular_file(root / path, unknown)) continue;  // a link to /dev/null: switched off
    RuleFile file{"/" / path, lines_of(root / path)};
    std::erase_if(file.lines, [](const std::string& line) { return !is_rule(line); });
    rules.push_back(std::move(file));
  }
  return rules;
}

/// Whether a rule names a USB device: "1a86" and after it "7523", as idVendor and idProduct or as PRODUCT.
bool names_device(const std::string& rule, const std::string& usb_id) {
  const std::string text = lower(rule);
  const auto colon = usb_id.find(':');
  const auto vendor = text.find(usb_id.substr(0, colon));
  if (vendor == std::string::npos) return false;
  return text.find(usb_id.substr(colon + 1), vendor + colon) != std::string::npos;
}

// Adapters that these rigs are made with and that brltty's rules claim: CH340 and CP210x.
constexpr std::array<const char*, 2> braille_like_ids{"1a86:7523", "10c4:ea60"};

std::optional<long> number(const std::string& text) {
  long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end != text.data() ? std::optional(value) : std::nullopt;
}

/// Who this process is, as /proc says it.
struct Process {
  long user = -1;
  std::set<long> groups;
};

Process this_process(const fs::path& root) {
  Process process;
  for (const std::string& line : lines_of(root / "proc/self/status")) {
    std::istringstream words(line);
    std::string key;
    long value = 0;
    words >> key;
    if (key == "Uid:") {
      words >> value >> process.user;  // the effective one is the second
    } else if (key == "Gid:") {
      words >> value >> value;
      process.groups.insert(value);
    } else if (key == "Groups:") {
      while (words >> value) process.groups.insert(value);
    }
  }
  return process;
}

std::string user_name(const fs::path& root, long user) {
  for (const std::string& line : lines_of(root / "etc/passwd")) {
    const auto fields = split(line, ':');
    if (fields.size() > 2 && number(fields[2]) == user) return fields[0];
  }
  return {};
}

void look_at_groups(const fs::path& root, const Process& process, HostFacts& facts) {
  facts.is_root = process.user == 0;
  facts.user = user_name(root, process.user);
  for (const std::string& line : lines_of(root / "etc/group")) {
    const auto fields = split(line, ':');
    if (fields.size() < 3 || (fields[0] != "dialout" && fields[0] != "uucp")) continue;
    if (facts.serial_group == "dialout") continue;  // Debian has both; the ports are dialout's
    facts.serial_group = fields[0];
    facts.in_group = process.groups.count(number(fields[2]).value_or(-1)) > 0;
    const auto members = fields.size() > 3 ? split(fields[3], ',') : std::vector<std::string>();
    facts.group_file_names_user = std::find(members.begin(), members.end(), facts.user) != members.end();
  }
}

/// By owner, group and mode; the real system is asked itself, since access lists count as well.
bool may_open(const fs::path& root, const fs::path& port, const Process& process) {
  if (root == "/") return access(port.c_str(), R_OK | W_OK) == 0;
  struct stat status {};
  if (stat((root / port.relative_path()).c_str(), &status) != 0) return false;
  if (process.user == 0) return true;
  if (process.user == static_cast<long>(status.st_uid)) return (status.st_mode & 0600U) == 0600U;
  if (process.groups.count(static_cast<long>(status.st_gid)) > 0) return (status.st_mode & 0060U) == 0060U;
  return (status.st_mode & 0006U) == 0006U;
}

/// The folder of a USB device in /sys that `device` lies in; empty if there is none.
fs::path usb_device_of(const fs::path& device) {
  std::error_code missing;
  fs::path folder = fs::canonical(device, missing);
  if (missing) return {};
  for (; folder.has_relative_path(); folder = folder.parent_path())
    if (fs::exists(folder / "idVendor", missing)) return folder;
  return {};
}

std::string usb_id_of(const fs::path& usb_device) {
  return first_line(usb_device / "idVendor") + ":" + first_line(usb_device / "idProduct");
}

bool suspends(const fs::path& usb_device) {
  const auto delay_ms = number(first_line(usb_device / "power/autosuspend_delay_ms"));
  return first_line(usb_device / "power/control") == "auto" && delay_ms.value_or(0) >= 0;
}

/// Whether udev has marked this port or its device: the database that `udevadm info` shows.
bool modem_manager_ignores(const fs::path& root, const std::string& name) {
  const std::string number = first_line(root / "sys/class/tty" / name / "dev");  // "188:0"
  for (const std::string& line : lines_of(root / "run/udev/data" / ("c" + number)))
    if (line == "E:ID_MM_PORT_IGNORE=1" || line == "E:ID_MM_DEVICE_IGNORE=1") return true;
  return false;
}

std::string group_name(const fs::path& root, long group) {
  for (const std::string& line : lines_of(root / "etc/group")) {
    const auto fields = split(line, ':');
    if (fields.size() > 2 && number(fields[2]) == group) return fields[0];
  }
  return {};
}

/// What the device tree says of a small computer's own bus, or the driver of an MCP2221 of all of them.
std::optional<double> bus_hz(const fs::path& root, const fs::path& adapter) {
  std::ifstream in(adapter / "of_node/clock-frequency", std::ios::binary);
  std::array<char, 4> bytes{};
  if (in.read(bytes.data(), bytes.size())) {
    double hz = 0.0;
    for (const char byte : bytes) hz = 256.0 * hz + static_cast<unsigned char>(byte);
    return hz;
  }
  if (first_line(adapter / "name").find("MCP2221") == std::string::npos) return std::nullopt;
  const auto khz = number(first_line(root / "sys/module/hid_mcp2221/parameters/i2c_clk_freq"));
  return khz ? std::optional(1e3 * static_cast<double>(*khz)) : std::nullopt;
}

void look_at_bus(const fs::path& root, PortFacts& facts) {
  const fs::path path(facts.asked.path);
  struct stat status {};
  if (stat((root / path.relative_path()).c_str(), &status) == 0 && status.st_gid != 0)
    facts.bus_group = group_name(root, static_cast<long>(status.st_gid));
  std::error_code missing;
  const fs::path adapter = fs::canonical(root / "sys/class/i2c-dev" / path.filename() / "device", missing);
  if (missing) return;
  facts.bus_is_bridge = first_line(adapter / "name").find("MCP2221") != std::string::npos;
  facts.bus_hz = bus_hz(root, adapter);
}

PortFacts look_at_port(const fs::path& root, const AskedPort& asked, const Process& process) {
  PortFacts facts{.asked = asked};
  const fs::path path(asked.path);
  const std::string name = path.filename();
  std::error_code missing;
  facts.exists = fs::exists(root / path.relative_path(), missing);
  facts.is_bus = io::is_i2c_bus(asked.path);
  if (!facts.exists) return facts;
  facts.may_open = may_open(root, path, process);
  if (facts.is_bus) {
    look_at_bus(root, facts);
    return facts;
  }
  facts.holder = files::other_holder_of(asked.path, files::Use::any, root / "proc");
  const fs::path device = root / "sys/class/tty" / name / "device";
  const fs::path usb_device = usb_device_of(device);
  if (usb_device.empty()) return facts;
  facts.usb_id = usb_id_of(usb_device);
  facts.usb_device = "/" / usb_device.lexically_relative(fs::canonical(root, missing));
  facts.driver = fs::read_symlink(device / "driver", missing).filename();
  if (const auto timer = number(first_line(root / "sys/bus/usb-serial/devices" / name / "latency_timer")))
    facts.latency_timer_ms = static_cast<int>(*timer);
  facts.may_suspend = suspends(usb_device);
  facts.modem_manager_ignores = modem_manager_ignores(root, name);
  return facts;
}

std::vector<AskedPort> usb_ports(const fs::path& root) {
  std::vector<AskedPort> ports;
  std::error_code missing;
  for (fs::directory_iterator port(root / "sys/class/tty", missing), end; !missing && port != end;
       port.increment(missing)) {
    const std::string name = port->path().filename();
    if (!name.starts_with("ttyUSB") && !name.starts_with("ttyACM")) continue;
    ports.push_back({"/dev/" + name, std::nullopt});
  }
  std::sort(ports.begin(), ports.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  return ports;
}

void look_at_rules(const fs::path& root, HostFacts& facts) {
  const std::vector<RuleFile> rules = udev_rules(root);
  const auto has = [&](std::string_view name) {
    return std::any_of(rules.begin(), rules.end(),
                       [&](const RuleFile& file) { return file.path.filename() == name; });
  };
  facts.has_port_rules = has("60-thermorig.rules");
  facts.braille_kept_off = has("91-thermorig-brltty.rules");
  for (const RuleFile& file : rules) {
    const std::string name = file.path.filename();
    if (name.find("brltty") == std::string::npos || name.starts_with("91-thermorig")) continue;
    for (const char* id : braille_like_ids)
      if (std::any_of(file.lines.begin(), file.lines.end(),
                      [id](const std::string& rule) { return names_device(rule, id); })) {
        facts.braille_rule = file.path;
        facts.braille_adapters.emplace_back(id);
      }
  }
}

bool has_port(const fs::path& usb_device) {
  std::error_code error;
  for (fs::recursive_directory_iterator entry(usb_device, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->path().filename().string().starts_with("tty")) return true;
  return false;
}

void look_for_lost_adapters(const fs::path& root, HostFacts& facts) {
  std::error_code missing;
  for (fs::directory_iterator device(root / "sys/bus/usb/devices", missing), end; !missing && device != end;
       device.increment(missing)) {
    const fs::path folder = fs::canonical(device->path(), missing);
    if (missing || !fs::exists(folder / "idVendor", missing)) continue;
    const std::string id = usb_id_of(folder);
    const bool is_claimed = std::find(facts.braille_adapters.begin(), facts.braille_adapters.end(), id) !=
                            facts.braille_adapters.end();
    if (is_claimed && !has_port(folder)) facts.adapters_without_port.push_back(id);
  }
}

bool runs(const fs::path& root, const std::string& command) {
  std::error_code missing;
  for (fs::directory_iterator process(root / "proc", missing), end; !missing && process != end;
       process.increment(missing))
    if (first_line(process->path() / "comm") == command) return true;
  return false;
}

bool is_on_battery(const fs::path& root) {
  bool has_mains = false;
  bool plugged_in = false;
  std::error_code missing;
  for (fs::directory_iterator supply(root / "sys/class/power_supply", missing), end;
       !missing && supply != end; supply.increment(missing)) {
    if (first_line(supply->path() / "type") != "Mains") continue;
    has_mains = true;
    plugged_in = plugged_in || first_line(supply->path() / "online") == "1";
  }
  return has_mains && !plugged_in;
}

/// A variable of this process's environment, as it was when the process began.
std::optional<std::string> variable(const fs::path& root, const std::string& name) {
  std::ifstream in(root / "proc/self/environ", std::ios::binary);
  for (std::string entry; std::getline(in, entry, '\0');)
    if (entry.starts_with(name + "=")) return entry.substr(name.size() + 1);
  return std::nullopt;
}

void look_at_plugins(const fs::path& root, HostFacts& facts) {
  facts.plugin_path = variable(root, "HDF5_PLUGIN_PATH");
  if (!facts.plugin_path) return;
  std::error_code missing;
  facts.plugin_path_exists = fs::is_directory(root / fs::path(*facts.plugin_path).relative_path(), missing);
}

void look_at_processor(const fs::path& root, HostFacts& facts) {
  facts.clock_source = first_line(root / "sys/devices/system/clocksource/clocksource0/current_clocksource");
  const fs::path frequency = root / "sys/devices/system/cpu/cpu0/cpufreq";
  facts.governor = first_line(frequency / "scaling_governor");
  const std::string driver = first_line(frequency / "scaling_driver");
  facts.governor_is_active_driver = driver.starts_with("intel_pstate") || driver.starts_with("amd-pstate");
}

}  // namespace

HostFacts look_at_host(const fs::path& root, const std::vector<AskedPort>& asked) {
  HostFacts facts;
  const Process process = this_process(root);
  look_at_groups(root, process, facts);
  for (const AskedPort& port : asked.empty() ? usb_ports(root) : asked)
    facts.ports.push_back(look_at_port(root, port, process));
  look_at_rules(root, facts);
  look_for_lost_adapters(root, facts);
  facts.modem_manager = runs(root, "ModemManager");
  look_at_processor(root, facts);
  facts.on_battery = is_on_battery(root);
  look_at_plugins(root, facts);
  return facts;
}

}  // namespace thermorig::doctor
