// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace thermorig::rig {

/// The commands that flash the servo's firmware onto a board on that port: of an Uno or Nano, then of a Nano
/// with the old boot loader. `image`: the firmware's file.
std::vector<std::string> flash_commands(const std::string& port, const std::string& image);

struct FlashOptions {
  std::string port;
  std::string image;                                 // Intel HEX
  std::function<void(const std::string& line)> say;  // each command before it is run
  int attempts = 3;                                  // to be heard by a boot loader, at each speed
  std::string avrdude = "avrdude";
};

/// Runs flash_commands() one after another until one has flashed the board and read the image back. A boot
/// loader that is not heard costs avrdude 6 s an attempt; of the ten that it makes by itself it gets
/// `attempts`. SIGINT, SIGTERM and SIGHUP end avrdude first.
///
/// Throws Error: failed (no avrdude, no boot loader, another chip, an image that is not whole on the board),
/// device_missing and no_permission (the port), interrupted. Each says what the board holds then.
void flash_firmware(const FlashOptions& options);

}  // namespace thermorig::rig
