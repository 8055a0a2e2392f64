/* SPDX-License-Identifier: MIT
 *
@facts@
 *
 * Needs thermorig_network.c and thermorig_network_weights.h beside it; C99 or C++, no heap, no library but <math.h>.
 *
 *   static thermorig_network_state state;            the network's RAM: THERMORIG_NETWORK_STATE_BYTES
 *   thermorig_network_output speed;
 *   thermorig_network_reset(&state);                 at the start, and whenever a frame was lost
 *   for (;;) {
 *     ... the next frame of the camera, and the mean of the gyro's samples over its exposure ...
 *     if (thermorig_network_push(&state, temp_c, gyro_dps, &speed)) use(speed.fusion_dps);
 *   }
 */
#ifndef THERMORIG_NETWORK_H
#define THERMORIG_NETWORK_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the camera sends. */
#define THERMORIG_NETWORK_CAMERA_ROWS 24
#define THERMORIG_NETWORK_CAMERA_COLUMNS 32

/* The network's input: a window of frames, each averaged over blocks of neighbouring pixels. */
#define THERMORIG_NETWORK_FRAMES @frames@ /* Nf, frames a window */
#define THERMORIG_NETWORK_REDUCTION @reduction@ /* Nr, a block is Nr x Nr pixels */
#define THERMORIG_NETWORK_CROP_LEFT @crop_left@ /* columns dropped at the left, where blocks do not fill the row */
#define THERMORIG_NETWORK_ROWS @rows@ /* H */
#define THERMORIG_NETWORK_COLUMNS @columns@ /* W */
#define THERMORIG_NETWORK_FUSION @fusion@ /* 1: with the gyro; 0: thermal-only, no gain head */

/* Its layers. */
#define THERMORIG_NETWORK_KERNEL 5 /* both convolutions: 5 x 5 */
#define THERMORIG_NETWORK_PADDING1 @padding1@ /* zeros around the input of the first */
#define THERMORIG_NETWORK_PADDING2 @padding2@ /* and of the second */
#define THERMORIG_NETWORK_FILTERS1 6
#define THERMORIG_NETWORK_POOLED_ROWS @pooled_rows@ /* after the first convolution and max-pooling 2 x 2 */
#define THERMORIG_NETWORK_POOLED_COLUMNS @pooled_columns@
#define THERMORIG_NETWORK_FILTERS2 16
#define THERMORIG_NETWORK_ROWS2 @rows2@ /* after the second convolution */
#define THERMORIG_NETWORK_COLUMNS2 @columns2@
#define THERMORIG_NETWORK_HIDDEN1 120 /* first layer of the speed head, and of the gain head */
#define THERMORIG_NETWORK_HIDDEN2 80 /* second layer of the speed head */

#define THERMORIG_NETWORK_INT8 @int8@ /* 1: weights in 8 bits with a scale a row; 0: float32 */

/* 1: the sums of products are those of whole numbers, 16-bit activations times 8-bit weights: for cores without a
 * floating-point unit, and faster on many that have one. 0: activations are float. */
#ifndef THERMORIG_NETWORK_INTEGER
#define THERMORIG_NETWORK_INTEGER THERMORIG_NETWORK_INT8
#endif
#if THERMORIG_NETWORK_INTEGER && !THERMORIG_NETWORK_INT8
#error "whole numbers need the weights in 8 bits"
#endif

/* Flash that the constants take, and RAM of a state. The stack needs less than THERMORIG_NETWORK_STACK_BYTES more. */
#define THERMORIG_NETWORK_CONSTANT_BYTES @constant_bytes@
#if THERMORIG_NETWORK_INTEGER
#define THERMORIG_NETWORK_STATE_BYTES @integer_state_bytes@
#else
#define THERMORIG_NETWORK_STATE_BYTES @float_state_bytes@
#endif
#define THERMORIG_NETWORK_STACK_BYTES 512

#define THERMORIG_NETWORK_PIXELS (THERMORIG_NETWORK_ROWS * THERMORIG_NETWORK_COLUMNS)
#define THERMORIG_NETWORK_POOLED (THERMORIG_NETWORK_POOLED_ROWS * THERMORIG_NETWORK_POOLED_COLUMNS)
#define THERMORIG_NETWORK_PLANE2 (THERMORIG_NETWORK_ROWS2 * THERMORIG_NETWORK_COLUMNS2)

/* An activation: what goes into a layer. */
#if THERMORIG_NETWORK_INTEGER
typedef int16_t thermorig_network_value;
#else
typedef float thermorig_network_value;
#endif

/* All memory that the network needs; the caller's, and nothing in it is of use to the caller. */
typedef struct {
  thermorig_network_value frame[THERMORIG_NETWORK_FRAMES][THERMORIG_NETWORK_PIXELS]; /* prepared; a ring */
  float gyro_dps[THERMORIG_NETWORK_FRAMES];                                          /* of these frames */
  int32_t next;                                                                      /* where the next frame goes */
  int32_t count;                                                                     /* frames in the ring */
  float pooled[THERMORIG_NETWORK_FILTERS1 * THERMORIG_NETWORK_POOLED]; /* (6, rows, columns) */
  float plane[THERMORIG_NETWORK_PLANE2];                               /* one filter of the second convolution */
  float speed[THERMORIG_NETWORK_HIDDEN1];                              /* first layer of the speed head */
  float other[THERMORIG_NETWORK_HIDDEN1]; /* first layer of the gain head; then the speed head's second */
#if THERMORIG_NETWORK_INTEGER
  int16_t pooled_value[THERMORIG_NETWORK_FILTERS1 * THERMORIG_NETWORK_POOLED]; /* `pooled` in 16 bits */
  int16_t plane_value[THERMORIG_NETWORK_PLANE2 > THERMORIG_NETWORK_HIDDEN1 ? THERMORIG_NETWORK_PLANE2
                                                                            : THERMORIG_NETWORK_HIDDEN1];
#endif
} thermorig_network_state;

/* What the network says of a window. */
typedef struct {
  float fusion_dps;  /* azimuth speed from images and gyro, deg/s; thermal-only: that from images */
  float thermal_dps; /* azimuth speed from images alone, deg/s */
  float gain;        /* Kg, 0..1: how much the images count against the gyro; thermal-only: 1 */
} thermorig_network_output;

/* Forgets all frames. A window must not span a gap: call this too when a frame was lost or is not to be trusted. */
void thermorig_network_reset(thermorig_network_state *state);

/* The next frame of the camera: `temp_c` (24, 32) in degrees Celsius, row by row as the camera sends it, all finite;
 * `gyro_dps` the mean of the gyro's samples over the frame's exposure, in deg/s (thermal-only: ignored).
 * Returns 1 and fills `output` when it and the frames before it make a window, else 0. Stride 1: once the first
 * window is full, each further frame makes one. */
int thermorig_network_push(thermorig_network_state *state, const float *temp_c, float gyro_dps,
                           thermorig_network_output *output);

/* A window at once: `temp_c` (Nf, 24, 32), oldest frame first; `gyro_dps` the mean over the window. What the state
 * held before is forgotten. */
void thermorig_network_estimate(thermorig_network_state *state, const float *temp_c, float gyro_dps,
                                thermorig_network_output *output);

#ifdef __cplusplus
}
#endif

#endif
