/* SPDX-License-Identifier: MIT */
#include "pulse.h"

/* How far the pulse lies above its minimum, in halves of a centidegree (per second): 0..2 * span. */
static uint32_t place(const struct servo_configure* servo, const struct motion* motion) {
  const int32_t value = servo->kind == SERVO_KIND_CONTINUOUS ? motion_rate_cdps(motion) : motion->angle_cdeg;
  return (uint32_t)(2 * value + (int32_t)servo->span);
}

/* Whole microseconds first, then the rest in ticks, to which the micro-degrees beyond the centidegree belong:
 * so everything stays within 32 bits. SERVO_LIMIT_SPAN: place <= 2e6, and the pulses span at most 2000 us. */
uint16_t pulse_ticks(const struct servo_configure* servo, const struct motion* motion) {
  const uint32_t range_us = (uint32_t)servo->pulse_max_us - servo->pulse_min_us;
  const uint32_t steps = 2U * servo->span;
  const uint32_t scaled = place(servo, motion) * range_us;
  const uint32_t beyond_udeg = servo->kind == SERVO_KIND_CONTINUOUS ? 0U : motion->angle_udeg;
  const uint32_t beyond = 2U * beyond_udeg * range_us / ((uint32_t)MOTION_UDEG_PER_CDEG / SERVO_TICKS_PER_US);
  const uint32_t rest = scaled % steps * SERVO_TICKS_PER_US + beyond;
  const uint32_t whole_us = servo->pulse_min_us + scaled / steps;
  return (uint16_t)(whole_us * SERVO_TICKS_PER_US + (rest + servo->span) / steps);
}
