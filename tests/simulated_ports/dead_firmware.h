// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "thermorig/core/error.h"
#include "thermorig/simulation/firmware.h"

namespace thermorig {

/// A micro-controller whose process has died.
class DeadFirmware : public simulation::Firmware {
 public:
  void receive(std::uint8_t, std::int64_t) override {}
  simulation::FirmwareOutput run_until(std::int64_t) override {
    throw Error(ExitCode::failed, "the simulated micro-controller stopped", "", "");
  }
  std::string description() const override { return "dead"; }
};

}  // namespace thermorig
