/* SPDX-License-Identifier: MIT
 * Runs an exported network on windows that a small generator makes, as boards.cpp makes them too, and prints what
 * it says. NETWORK_HEADER, and the names below, come from the command line of the compiler. */
#include NETWORK_HEADER

#include <stdio.h>

#define PASTE(a, b) a##b
#define NAME(a, b) PASTE(a, b)
#define LOWER(word) NAME(NETWORK_NAME, word)

#define FRAME (24 * 32)

static uint32_t random_state = 1u;

/* Numerical Recipes' linear congruential generator; its upper bits. */
static float random_between(float least, float most) {
  random_state = random_state * 1664525u + 1013904223u;
  return least + (most - least) * ((float)(random_state >> 16) / 65536.0f);
}

static LOWER(_state) state;
static float temp_c[FRAME];

int main(void) {
  int frame, pixel;
  printf("state %lu\n", (unsigned long)sizeof state);
  LOWER(_reset)(&state);
  for (frame = 0; frame < FRAMES_TO_PUSH; ++frame) {
    LOWER(_output) output;
    const float gyro_dps = random_between(-200.0f, 200.0f);
    for (pixel = 0; pixel < FRAME; ++pixel) temp_c[pixel] = random_between(10.0f, 30.0f);
    if (LOWER(_push)(&state, temp_c, gyro_dps, &output))
      printf("%.9g %.9g %.9g\n", (double)output.fusion_dps, (double)output.thermal_dps, (double)output.gain);
  }
  printf("end\n");
  return 0;
}
