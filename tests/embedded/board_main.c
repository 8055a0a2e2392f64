/* SPDX-License-Identifier: MIT
 * Runs an exported network on frames that a small generator makes, as boards.cpp makes them too, and prints what it
 * says. NETWORK_HEADER, NETWORK_NAME and FRAMES_TO_PUSH come from the compiler's command line. */
#include NETWORK_HEADER

#include <stdio.h>

#ifdef MEASURED
#include "cortex_m/measure.h"
#endif

#define PASTE(a, b) a##b
#define NAME(a, b) PASTE(a, b)
#define LOWER(word) NAME(NETWORK_NAME, word)

#define FRAME (24 * 32)

static LOWER(_state) state;
static float temp_c[FRAME];
static uint32_t random_state = 1u;

/* Numerical Recipes' linear congruential generator; its upper bits. */
static float random_between(float least, float most) {
  random_state = random_state * 1664525u + 1013904223u;
  return least + (most - least) * ((float)(random_state >> 16) / 65536.0f);
}

static int push(float gyro_dps, LOWER(_output) *output) {
#ifdef MEASURED
  int full;
  uint32_t instructions, stack_bytes;
  begin_measuring();
  full = LOWER(_push)(&state, temp_c, gyro_dps, output);
  instructions = instructions_since();
  stack_bytes = stack_bytes_since();
  if (full) printf("took %lu %lu\n", (unsigned long)instructions, (unsigned long)stack_bytes);
  return full;
#else
  return LOWER(_push)(&state, temp_c, gyro_dps, output);
#endif
}

int main(void) {
  printf("state %lu\n", (unsigned long)sizeof state);
  LOWER(_reset)(&state);
  for (int frame = 0; frame < FRAMES_TO_PUSH; ++frame) {
    LOWER(_output) output;
    const float gyro_dps = random_between(-200.0f, 200.0f);
    for (int pixel = 0; pixel < FRAME; ++pixel) temp_c[pixel] = random_between(10.0f, 30.0f);
    if (push(gyro_dps, &output))
      printf("window %.9g %.9g %.9g\n", (double)output.fusion_dps, (double)output.thermal_dps, (double)output.gain);
  }
  printf("end\n");
  return 0;
}
