/* SPDX-License-Identifier: MIT */
#include "pulse.h"

uint16_t pulse_ticks(const struct servo_configure* servo, const struct motion* motion) {
  const int32_t middle =
      (int32_t)(((uint32_t)servo->pulse_min_us + servo->pulse_max_us) * SERVO_TICKS_PER_US / 2U);
  const int32_t width = (int32_t)((uint32_t)(servo->pulse_max_us - servo->pulse_min_us) * SERVO_TICKS_PER_US);
  const int32_t value = servo->kind == SERVO_KIND_CONTINUOUS ? motion_rate_cdps(motion) : motion->angle_cdeg;
  const int32_t span = (int32_t)servo->span;
  /* |value| <= span / 2 and width <= 4000: SERVO_LIMIT_SPAN keeps this within 32 bits. */
  const int32_t scaled = value * width + (value < 0 ? -span / 2 : span / 2);
  return (uint16_t)(middle + scaled / span);
}
