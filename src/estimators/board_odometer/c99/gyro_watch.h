/* SPDX-License-Identifier: MIT */
#pragma once

#include "numbers.h"

/* Tells a gyro that is frozen, that sets itself to zero at rest, or that was away, from one that lives: noise
 * never repeats itself for long. */
typedef thermorig_odometer_gyro_watch gyro_watch;

#define LONGEST_GYRO_GAP_S 0.25f
#define SATURATED_DPS 15.0f /* what a reading at the end of its range may be off */
#define FROZEN_S 0.3f

static int repeats_itself(const gyro_watch* watch) {
  return watch->has_sample && seconds_between(watch->repeats_since_us, watch->last_us) >= FROZEN_S;
}

/* One that sets itself to zero at rest has taken its bias off. */
static int is_zeroed(const gyro_watch* watch) {
  return repeats_itself(watch) && watch->last_rate_dps[0] == 0.0f && watch->last_rate_dps[1] == 0.0f &&
         watch->last_rate_dps[2] == 0.0f;
}

static int is_frozen(const gyro_watch* watch) {
  return repeats_itself(watch) && !is_zeroed(watch);
}

/* What a shaft may have turned by beside a straight line through both ends of a time in which nothing
 * measured it: it may have left its speed and come back to it. */
static float unseen_deg(float gap_s) {
  return least(2000.0f * gap_s * gap_s / 16.0f, 200.0f * gap_s);
}

/* A sample, `step_s` after the one before. */
static void watch_sample(gyro_watch* watch, uint32_t time_us, const float rate_dps[3], int saturated,
                         float step_s, float period_s) {
  const float lost_s = step_s > 1.5f * period_s ? step_s - period_s : 0.0f, unseen = unseen_deg(lost_s);
  /* Bit by bit. NOLINTNEXTLINE(bugprone-suspicious-memory-comparison) */
  if (!watch->has_sample || memcmp(watch->last_rate_dps, rate_dps, sizeof watch->last_rate_dps) != 0)
    watch->repeats_since_us = time_us;
  memcpy(watch->last_rate_dps, rate_dps, sizeof watch->last_rate_dps);
  watch->last_us = time_us;
  watch->has_sample = 1;
  watch->saturated_s = saturated ? watch->saturated_s + step_s : 0.0f;
  watch->unseen_deg2 += unseen * unseen + 2.0f * SATURATED_DPS * SATURATED_DPS * watch->saturated_s * step_s;
  if (lost_s > LONGEST_GYRO_GAP_S || is_frozen(watch)) watch->was_away = 1;
}
