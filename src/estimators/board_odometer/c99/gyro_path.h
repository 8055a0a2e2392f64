/* SPDX-License-Identifier: MIT */
#pragma once

#include "numbers.h"

/* What the gyro has turned by, bias and scale not removed, over the last two exposures and a little more. */
typedef thermorig_odometer_gyro_path gyro_path;
typedef thermorig_odometer_knot gyro_knot;

#define KNOTS THERMORIG_ODOMETER_KNOTS

/* The same while a chess half was exposed: enough to know the mean heading and its spread for any bias and
 * scale. */
typedef struct {
  uint32_t mean_us, mean_turned;
  float length_s, turned_deg;
  float variance_s2, variance_deg2, covariance;
  float change_dps; /* of the reading, from the first third to the last */
  float across_dps; /* from one end to the other */
} exposed_turn;

static const gyro_knot* knot_at(const gyro_path* path, uint32_t place) {
  return &path->knot[place % KNOTS];
}

static uint32_t first_knot(const gyro_path* path) {
  return path->knots > KNOTS ? path->knots - KNOTS : 0u;
}

/* At any time; after the newest sample its rate goes on, and before the oldest that is kept its was. */
static gyro_knot path_until(const gyro_path* path, uint32_t time_us) {
  uint32_t later = path->knots;
  gyro_knot at;
  float step_s, slope;
  const gyro_knot *a, *b;
  while (later > first_knot(path) && (int32_t)(knot_at(path, later - 1u)->time_us - time_us) > 0) --later;
  if (later == first_knot(path) || later == path->knots) {
    at = *knot_at(path, later == path->knots ? later - 1u : later);
    step_s = seconds_between(at.time_us, time_us);
    at.turned += steps_of(at.rate_dps * step_s);
    at.time_us = time_us;
    return at;
  }
  a = knot_at(path, later - 1u);
  b = knot_at(path, later);
  step_s = seconds_between(a->time_us, time_us);
  slope = (b->rate_dps - a->rate_dps) / seconds_between(a->time_us, b->time_us);
  at.time_us = time_us;
  at.turned = a->turned + steps_of((a->rate_dps + 0.5f * slope * step_s) * step_s);
  at.rate_dps = a->rate_dps + slope * step_s;
  return at;
}

static void path_over(const gyro_path* path, uint32_t begin_us, uint32_t end_us, exposed_turn* turn) {
  enum { POINTS = 24, THIRD = POINTS / 3 };
  const gyro_knot first = path_until(path, begin_us), last = path_until(path, end_us);
  const uint32_t length_us = end_us - begin_us;
  float sum = 0.0f, squares = 0.0f, products = 0.0f, first_deg = 0.0f, last_deg = 0.0f, third_s;
  turn->mean_us = begin_us + length_us / 2u;
  turn->length_s = 1e-6f * (float)length_us;
  turn->turned_deg = degrees_between(first.turned, last.turned);
  turn->across_dps = last.rate_dps - first.rate_dps;
  turn->variance_s2 = 0.0f;
  for (int i = 0; i < POINTS; ++i) {
    const float off_s = turn->length_s * (((float)i + 0.5f) / (float)POINTS - 0.5f);
    const uint32_t time_us = turn->mean_us + (uint32_t)(int32_t)(1e6f * off_s);
    const float deg = degrees_between(first.turned, path_until(path, time_us).turned);
    sum += deg;
    squares += deg * deg;
    products += deg * off_s;
    turn->variance_s2 += off_s * off_s / (float)POINTS;
    if (i == THIRD) first_deg = deg;
    if (i == POINTS - 1 - THIRD) last_deg = deg;
  }
  sum /= (float)POINTS;
  turn->mean_turned = first.turned + steps_of(sum);
  turn->variance_deg2 = squares / (float)POINTS - sum * sum;
  turn->covariance = products / (float)POINTS;
  third_s = turn->length_s * ((float)THIRD + 0.5f) / (float)POINTS;
  turn->change_dps = (turn->turned_deg - last_deg - first_deg) / third_s;
}

/* The newest knot moves along until it is `knot_us` from the one before. */
static void add_to_path(gyro_path* path, uint32_t time_us, float rate_dps, float step_s, uint32_t knot_us) {
  gyro_knot next;
  const gyro_knot* last = path->knots > 0u ? knot_at(path, path->knots - 1u) : 0;
  next.time_us = time_us;
  next.rate_dps = rate_dps;
  next.turned = 0u;
  if (last) next.turned = last->turned + steps_of(0.5f * (path->last_dps + rate_dps) * step_s);
  path->last_dps = rate_dps;
  if (path->knots > 1u && last->time_us - knot_at(path, path->knots - 2u)->time_us < knot_us) --path->knots;
  path->knot[path->knots++ % KNOTS] = next;
  if (path->knots > 0x80000000u) path->knots -= 0x40000000u; /* places stay: a multiple of KNOTS */
}
