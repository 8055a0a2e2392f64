/* SPDX-License-Identifier: MIT */
#ifndef THERMORIG_PULSE_H
#define THERMORIG_PULSE_H

#include "motion.h"

/* Width of the pulse for the commanded angle (of a continuous servo: rate), in ticks of 1/16 us. */
uint16_t pulse_ticks(const struct servo_configure* servo, const struct motion* motion);

#endif
