/* SPDX-License-Identifier: MIT */
#pragma once

#include "numbers.h"

/* How far a gyro's noise lets its angle walk, heard on the two axes across the shaft: along it a servo's
 * jerks would count as noise. By means over a tenth of a second: what is faster averages out. */
typedef thermorig_odometer_gyro_noise gyro_noise;
typedef thermorig_odometer_gyro_block gyro_block;

#define BLOCK_S 0.1f
#define LEARNING_SHARE 0.05f
#define EVEN_DPS 5.0f    /* a shaft whose speed changes by more shows on the other axes */
#define MOST_DPS2 100.0f /* of one change: beyond, a reading is broken */

static int is_whole(const gyro_block* block) {
  return block->length_s > 0.0f && block->length_s < 2.0f * BLOCK_S;
}

static float change_dps(const gyro_noise* noise, int axis) {
  return noise->newest.turned_deg[axis] / noise->newest.length_s -
         noise->last.turned_deg[axis] / noise->last.length_s;
}

static void learn_noise(gyro_noise* noise, int32_t shaft) {
  float squares = 0.0f;
  if (size_of(change_dps(noise, (int)shaft)) > EVEN_DPS) return;
  for (int axis = 0; axis < 3; ++axis)
    if (axis != shaft) squares += square(change_dps(noise, axis));
  if (!(squares < MOST_DPS2)) squares = MOST_DPS2; /* no number too */
  /* Two axes, and the noise of two blocks in each change. */
  noise->walk_deg2 += LEARNING_SHARE * (0.25f * squares * noise->newest.length_s - noise->walk_deg2);
}

/* A sample, `step_s` after the one before. `shaft`: the gyro's axis along it. */
static void hear_sample(gyro_noise* noise, const float rate_dps[3], int32_t shaft, float step_s) {
  gyro_block* newest = &noise->newest;
  newest->length_s += step_s;
  for (int axis = 0; axis < 3; ++axis) newest->turned_deg[axis] += step_s * rate_dps[axis];
  if (newest->length_s < BLOCK_S) return;
  if (is_whole(&noise->last) && is_whole(newest)) learn_noise(noise, shaft);
  noise->last = *newest;
  memset(newest, 0, sizeof *newest);
}
