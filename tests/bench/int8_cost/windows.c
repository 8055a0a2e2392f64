/* SPDX-License-Identifier: MIT
 * Frames to speeds by an exported network, as firmware would. In, for each frame: 1.0 where a new run begins
 * (else 0.0), the gyro's mean, 768 temperatures. Out: frames of the window, 0.0 where it is not full, fused
 * speed, thermal speed. All are floats in this machine's order. */
#include <stdio.h>

#include "network.h"

static network_state state;

int main(void) {
  float in[2 + 24 * 32];
  network_reset(&state);
  while (fread(in, sizeof in, 1, stdin) == 1) {
    network_output speed = {0};
    float out[3];
    if (in[0] != 0.0f) network_reset(&state);
    out[0] = network_push(&state, in + 2, in[1], &speed) ? (float)NETWORK_FRAMES : 0.0f;
    out[1] = speed.fusion_dps;
    out[2] = speed.thermal_dps;
    if (fwrite(out, sizeof out, 1, stdout) != 1) return 1;
  }
  return 0;
}
