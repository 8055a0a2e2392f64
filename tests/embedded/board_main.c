/* SPDX-License-Identifier: MIT
 * Runs an exported network on frames that a small generator makes, as boards.cpp makes them too, and prints
 * what it says; then on the first window again, at once; then on frames that no camera should send.
 * NETWORK_HEADER, NETWORK_NAME, FRAMES_A_WINDOW and FRAMES_TO_PUSH come from the compiler's command line. */
#include NETWORK_HEADER

#include <math.h>
#include <stdio.h>
#include <string.h>

#ifdef MEASURED
#include "cortex_m/measure.h"
#endif

#define PASTE(a, b) a##b
#define NAME(a, b) PASTE(a, b)
#define LOWER(word) NAME(NETWORK_NAME, word)

#define FRAME (24 * 32)

static LOWER(_state) state;
static float temp_c[FRAME];
static float first_window_c[FRAMES_A_WINDOW * FRAME];
static uint32_t random_state = 1u;

/* Numerical Recipes' linear congruential generator; its upper bits. */
static float random_between(float least, float most) {
  random_state = random_state * 1664525u + 1013904223u;
  return least + (most - least) * ((float)(random_state >> 16) / 65536.0f);
}

static int push(float gyro_dps, LOWER(_output) * output) {
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

static void print(const char* what, const LOWER(_output) * output) {
  printf("%s %.9g %.9g %.9g\n", what, (double)output->fusion_dps, (double)output->thermal_dps,
         (double)output->gain);
}

/* They make no window. */
static void push_spoiled_frames(void) {
  const float spoiled[4] = {NAN, INFINITY, -INFINITY, 3e38f};
  for (int i = 0; i < 4 * FRAMES_A_WINDOW; ++i) {
    LOWER(_output) output;
    for (int pixel = 0; pixel < FRAME; ++pixel) temp_c[pixel] = spoiled[(i + pixel) % 4];
    if (push(spoiled[i % 4], &output)) print("window", &output);
  }
}

int main(void) {
  LOWER(_output) output;
  float gyro_total_dps = 0.0f;
  printf("state %lu\n", (unsigned long)sizeof state);
  LOWER(_reset)(&state);
  for (int frame = 0; frame < FRAMES_TO_PUSH; ++frame) {
    const float gyro_dps = random_between(-200.0f, 200.0f);
    for (int pixel = 0; pixel < FRAME; ++pixel) temp_c[pixel] = random_between(10.0f, 30.0f);
    if (frame < FRAMES_A_WINDOW) {
      memcpy(first_window_c + frame * FRAME, temp_c, sizeof temp_c);
      gyro_total_dps += gyro_dps;
    }
    if (push(gyro_dps, &output)) print("window", &output);
  }
  LOWER(_estimate)(&state, first_window_c, gyro_total_dps / (float)FRAMES_A_WINDOW, &output);
  print("again", &output);
  push_spoiled_frames();
  printf("end\n");
  return 0;
}
