// SPDX-License-Identifier: MIT
#include "udev_rules.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "system_text.h"

namespace thermorig::doctor {

namespace {

namespace fs = std::filesystem;

bool is_rule(const std::string& line) {
  const auto first = line.find_first_not_of(" \t");
  return first != std::string::npos && line[first] != '#';
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

std::vector<RuleFile> udev_rules(const fs::path& root) {
  std::map<std::string, fs::path> by_name;  // later folders win: udev(7), "Rules files"
  for (const char* folder :
       {"lib/udev/rules.d", "usr/lib/udev/rules.d", "run/udev/rules.d", "etc/udev/rules.d"}) {
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

bool names_device(const std::string& rule, const std::string& usb_id) {
  const std::string text = lower(rule);
  const auto colon = usb_id.find(':');
  const auto vendor = text.find(usb_id.substr(0, colon));
  if (vendor == std::string::npos) return false;
  return text.find(usb_id.substr(colon + 1), vendor + colon) != std::string::npos;
}

}  // namespace thermorig::doctor
