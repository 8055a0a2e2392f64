// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace thermorig::doctor {

/// One file of udev rules.
struct RuleFile {
  std::filesystem::path path;      // as the system knows it, without the root
  std::vector<std::string> lines;  // without comments
};

/// The rules in force: a file in /etc or /run stands for one of the same name in /usr/lib.
std::vector<RuleFile> udev_rules(const std::filesystem::path& root);

/// Whether a rule names a USB device: "1a86" and after it "7523", as idVendor and idProduct or as PRODUCT.
bool names_device(const std::string& rule, const std::string& usb_id);

}  // namespace thermorig::doctor
