// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/learning/interchange/sink.h"
#include "thermorig/network/acquisition.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::interchange {

/// Which windows: Nf frames, pixels averaged Nr x Nr.
struct WindowShape {
  int frames = 3;     // Nf, 1 to 6
  int reduction = 1;  // Nr, 1 to 3
};

/// A row a frame: the numbers of `samples`, and `temperature` (N, 24, 32) in degrees Celsius. Throws as the
/// sink does.
void write_rows_npz(const session::Session& session, Sink& sink);

/// The windows that a training sees: `images` (W, Nf, H, W') in degrees Celsius, `label_dps`,
/// `corrected_dps`, `shaft_dps`, `gyro_dps`, `last`, `middle_s`; `measured_dps` where something measured the
/// shaft. `acquisition` is made of `session`. Returns how many. Throws as the sink does.
std::size_t write_windows_npz(const session::Session& session, const network::Acquisition& acquisition,
                              WindowShape shape, Sink& sink);

}  // namespace thermorig::interchange
