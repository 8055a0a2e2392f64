// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>

#include "gain_fit.h"

namespace thermorig::fit {

/// Over which angle, in degrees, the speed of a positional servo repeats most, in what `fit` leaves of the
/// gyro. A gear wheel off its centre does that, and a head out of balance once a turn. None where nothing
/// stands out of the noise that `fit` has not got already, for a continuous servo, and where less than two
/// periods or more than 30 turns were passed.
std::optional<double> strongest_ripple_deg(const ShaftEvidence& evidence, const GainFit& fit);

/// Where in a ripple an angle of the shaft lies.
struct RipplePhase {
  RipplePhase(double angle_deg, double period_deg);
  double cosine, sine;
};

/// How far a ripple of size 1 turns the shaft on the way between two angles: cosine and sine.
std::array<double, 2> ripple_turned_deg(const RipplePhase& from, const RipplePhase& to, double period_deg);

}  // namespace thermorig::fit
