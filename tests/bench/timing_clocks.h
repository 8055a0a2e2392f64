// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "timing_figures.h"

namespace thermorig::bench {

/// How long and how often.
struct TableSize {
  std::size_t seeds = 25;
  std::uint64_t first_seed =
      5001;  // the clocks' settings were chosen on seeds below 100: these are new to them
  double seconds = 180.0;
  double long_seconds = 10'000.0;  // of the servo's clock
};

/// Errors of sample times by link, load and stream, of every baseline and of ours; bounds; the servo's clock.
void add_sample_times(const TableSize& size, std::vector<Figure>& figures);

/// The servo's clock over one long recording, on CDC and FTDI.
void add_long_servo_clock(const TableSize& size, std::vector<Figure>& figures);

/// 30 s without the camera.
void add_outage(const TableSize& size, std::vector<Figure>& figures);

}  // namespace thermorig::bench
