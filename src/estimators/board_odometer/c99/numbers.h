/* SPDX-License-Identifier: MIT */
#pragma once

#include <math.h>
#include <string.h>

#include "thermorig_odometer.h"

#define MAP_STEPS 256.0f        /* of the map, a kelvin */
#define PIXEL_STEPS 4096.0f     /* of a pixel's error, a kelvin */
#define VARIANCE_STEPS 16384.0f /* of a variance, a kelvin squared */
#define TURNED_STEPS 1048576.0f /* of the gyro's path, a degree */

static float square(float x) {
  return x * x;
}

static float least(float a, float b) {
  return a < b ? a : b;
}

static float most(float a, float b) {
  return a > b ? a : b;
}

static float size_of(float x) {
  return x < 0.0f ? -x : x;
}

static float root(float x) {
  return sqrtf(most(0.0f, x));
}

static int32_t floor_of(float x) {
  const int32_t whole = (int32_t)x;
  return (float)whole > x ? whole - 1 : whole;
}

/* Of what is not above 0, within 5e-6: libraries' expf differ in the last bit, and boards should not. */
static float power_of_e(float x) {
  const float twos = most(-80.0f, x) * 1.44269504f;
  const int32_t whole = floor_of(twos);
  const float y = (twos - (float)whole) * 0.69314718f;
  const uint32_t bits = (uint32_t)(whole + 127) << 23; /* 2 to the power of `whole` */
  float scale, series = 1.0f;
  if (x < -80.0f) return 0.0f;
  memcpy(&scale, &bits, sizeof scale);
  for (int i = 7; i > 0; --i) series = 1.0f + y / (float)i * series;
  return scale * series;
}

/* An angle between 0 and 360. */
static float around(float deg) {
  const float rest = deg - 360.0f * (float)floor_of(deg / 360.0f);
  return rest >= 360.0f ? rest - 360.0f : most(0.0f, rest);
}

/* An angle between -180 and 180. */
static float apart(float deg) {
  return around(deg + 180.0f) - 180.0f;
}

static float seconds_between(uint32_t from_us, uint32_t to_us) {
  return 1e-6f * (float)(int32_t)(to_us - from_us);
}

static float degrees_between(uint32_t from, uint32_t to) {
  return (float)(int32_t)(to - from) / TURNED_STEPS;
}

/* Numerical Recipes' linear congruential generator. What is kept in few bits is rounded at random: then many
 * small changes add up as they should. */
static uint32_t next_noise(uint32_t* noise) {
  *noise = *noise * 1664525u + 1013904223u;
  return *noise;
}

/* `x` may be beyond any whole number. */
static int32_t rounded(float x, uint32_t noise, int32_t limit) {
  const float between = (float)(noise >> 16) / 65536.0f;
  if (!(x > (float)-limit)) return -limit;
  return x < (float)limit ? floor_of(x + between) : limit;
}

/* Degrees as a part of the gyro's path: more than a thousand at once are of a gyro that was away. */
static uint32_t steps_of(float deg) {
  return (uint32_t)(int32_t)(least(1000.0f, most(-1000.0f, deg)) * TURNED_STEPS);
}

/* A variance in 8 bits, 4 of exponent and 4 of mantissa; 0 stands for what nothing has seen. */
static uint32_t variance_of(uint8_t code) {
  return code == 0 ? 0u : (16u + (code & 15u)) << (code >> 4);
}

static uint8_t code_of(float variance, uint32_t noise) {
  const float steps = least(1015807.0f, most(17.0f, variance * VARIANCE_STEPS)); /* codes 1 to 255 */
  uint32_t bits;
  memcpy(&bits, &steps, sizeof bits);
  bits = ((bits + (noise >> 13)) >> 19) - (131u << 4);
  return (uint8_t)(bits > 255u ? 255u : bits);
}
