/* SPDX-License-Identifier: MIT
 * Runs the exported odometer over a recording that board_odometer.cpp wrote (input.bin) and writes what it
 * says of each frame (output.bin). ODOMETER, ODOMETER_HEADER and ODOMETER_RIG come from the compiler's
 * command line. */
#include ODOMETER_HEADER
#include ODOMETER_RIG

#include <stdio.h>

#ifdef MEASURED
#include "cortex_m/measure.h"
#endif

#define PASTE(a, b) a##b
#define NAME(a, b) PASTE(a, b)
#define OWN(word) NAME(ODOMETER, word)

static OWN(_state) state;
static float temp_c[24 * 32];

struct said {
  OWN(_output) output;
  uint32_t instructions, stack_bytes; /* of the frame, and of the samples before it */
};

static void begin(void) {
#ifdef MEASURED
  begin_measuring();
#endif
}

static void end(struct said* said) {
#ifdef MEASURED
  const uint32_t stack_bytes = stack_bytes_since();
  said->instructions += instructions_since();
  if (stack_bytes > said->stack_bytes) said->stack_bytes = stack_bytes;
#else
  (void)said;
#endif
}

int main(void) {
  FILE *in = fopen("input.bin", "rb"), *out = fopen("output.bin", "wb");
  static struct said said;
  uint32_t kind;
  if (!in || !out) return 1;
  OWN(_reset)(&state, &OWN(_rig));
  while (fread(&kind, sizeof kind, 1, in) == 1) {
    if (kind == 1u) {
      struct {
        uint32_t time_us;
        float rate_dps[3];
        uint32_t saturated;
      } sample;
      if (fread(&sample, sizeof sample, 1, in) != 1) return 1;
      begin();
      OWN(_push_gyro)(&state, sample.time_us, sample.rate_dps, (int)sample.saturated);
      end(&said);
    } else {
      struct {
        uint32_t fresh, begin_us[2], end_us[2], read_us;
        float time_sigma_s;
      } times;
      OWN(_frame) frame;
      if (fread(&times, sizeof times, 1, in) != 1 || fread(temp_c, sizeof temp_c, 1, in) != 1) return 1;
      frame.temp_c = temp_c;
      frame.fresh = times.fresh;
      for (int half = 0; half < 2; ++half) {
        frame.begin_us[half] = times.begin_us[half];
        frame.end_us[half] = times.end_us[half];
      }
      frame.time_sigma_s = times.time_sigma_s;
      begin();
      OWN(_push_frame)(&state, &frame);
      OWN(_read)(&state, times.read_us, &said.output);
      end(&said);
      if (fwrite(&said, sizeof said, 1, out) != 1) return 1;
      said.instructions = said.stack_bytes = 0u;
    }
  }
  printf("state %lu\n", (unsigned long)sizeof state);
  return fclose(out) == 0 ? 0 : 1;
}
