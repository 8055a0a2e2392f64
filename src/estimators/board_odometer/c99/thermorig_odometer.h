/* SPDX-License-Identifier: MIT
 *
 * A heading that does not drift, from a gyro and a thermal camera of 24 x 32 pixels (MLX90640), for small
 * boards: while the rig turns it builds a panorama of its surroundings, and lays every new chess half against
 * it. Needs thermorig_odometer.c beside it; C99 or C++, single precision, no heap, of the C library sqrtf,
 * memset, memcpy and memcmp.
 *
 *   static thermorig_odometer_state state;        all the RAM: THERMORIG_ODOMETER_STATE_BYTES
 *   thermorig_odometer_reset(&state, &rig);       the constants of thermorig_odometer_rig.h
 *   for (;;) {
 *     thermorig_odometer_push_gyro(...);          each sample of the gyro, as it comes
 *     thermorig_odometer_push_frame(...);         each frame of the camera, as it comes
 *     thermorig_odometer_read(...);               whenever it is wanted
 *   }
 *
 * Times are microseconds of one clock of the board, the same for both sensors; it may wrap around.
 */
#ifndef THERMORIG_ODOMETER_H
#define THERMORIG_ODOMETER_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define THERMORIG_ODOMETER_ROWS 24
#define THERMORIG_ODOMETER_COLUMNS 32
#define THERMORIG_ODOMETER_HALF_COLUMNS 16 /* pixels of a row in one chess half */
#define THERMORIG_ODOMETER_BINS 360        /* of the map, a row */
#define THERMORIG_ODOMETER_NODES 24        /* of the map's offsets, 15 degrees apart */
#define THERMORIG_ODOMETER_STATES (4 + THERMORIG_ODOMETER_NODES)
#define THERMORIG_ODOMETER_KNOTS 128 /* of the gyro's path */
#define THERMORIG_ODOMETER_SEARCHED_HALVES 24
#define THERMORIG_ODOMETER_BIASES 121
#define THERMORIG_ODOMETER_CELLS 384 /* of a row of the start's mosaic */
#define THERMORIG_ODOMETER_WINDOW \
  232 /* bins that a half may look at: 115 degrees, and what it sweeps beside */

/* RAM of a state, and what the stack needs at most. */
#define THERMORIG_ODOMETER_STATE_BYTES 35208
#define THERMORIG_ODOMETER_STACK_BYTES 4400

/* What is known of the rig beforehand: `thermorig export` writes it from a profile. */
typedef struct {
  float pitch_deg; /* between neighbouring pixels: 30/32 to 115/32 */
  float direction; /* of growing columns: +1 as angles grow, -1 mirrored */
  int32_t gyro_axis, gyro_sign;
  float gyro_period_s;
  float gyro_time_sigma_s; /* how far the gyro's times may be off */
  float bias_dps, bias_sigma_dps;
  float scale, scale_sigma; /* reading = scale * rate + bias */
  float latency_sigma_s;    /* of the camera against the gyro */
  uint32_t knot_us;         /* between points of the gyro's path: all of them hold two exposures */
} thermorig_odometer_profile;

/* A frame of the camera. */
typedef struct {
  const float* temp_c; /* (24, 32) in degrees Celsius, row by row, as the camera sends it */
  uint32_t fresh;      /* halves that were read anew: bit 0 the even one (row + column), bit 1 the odd one */
  uint32_t begin_us[2], end_us[2]; /* exposure of the even and of the odd half, where fresh */
  float time_sigma_s;              /* of these times, one standard deviation */
} thermorig_odometer_frame;

enum {
  THERMORIG_ODOMETER_STARTING,     /* bias and map are being learnt */
  THERMORIG_ODOMETER_TRACKING,     /* the heading is that of the map, within its sigma */
  THERMORIG_ODOMETER_RELOCALISING, /* where the camera looks in the map is being searched for */
  THERMORIG_ODOMETER_NOT_TRUSTED   /* see the reason */
};

enum {
  THERMORIG_ODOMETER_NONE,
  THERMORIG_ODOMETER_NO_GYRO,     /* no sample for 0.25 s */
  THERMORIG_ODOMETER_GYRO_FROZEN, /* its samples repeat each other bit by bit */
  THERMORIG_ODOMETER_NO_CAMERA,   /* no half that is new for 1 s */
  THERMORIG_ODOMETER_VIEW_DIFFERS /* what the camera shows does not fit the map */
};

typedef struct {
  int32_t state, reason;   /* of the two lists above */
  int32_t turns;           /* whole turns since the map's origin, */
  float heading_deg;       /* and what comes on top: 0 to 360 */
  float heading_sigma_deg; /* against the part of the map that is in view, and of where a new map begins;
                              before there is a map 180 */
  float rate_dps;          /* mean over the exposures that the newest frame shows */
  float rate_sigma_dps;
  float bias_dps, scale; /* of the gyro: reading = scale * rate + bias */
  float latency_s;       /* camera against gyro */
  float nis;             /* innovations of late, squared, by what was expected of them: about 1 */
  uint32_t ignored;      /* samples and frames since the reset of which something is no number */
} thermorig_odometer_output;

/* What follows is the odometer's own: nothing in it is of use to the caller. */

typedef struct {
  uint32_t time_us;
  uint32_t turned; /* integral of the readings in 2^-20 deg; wraps around */
  float rate_dps;
} thermorig_odometer_knot;

typedef struct { /* what the gyro turned by of late, bias and scale not removed */
  thermorig_odometer_knot knot[THERMORIG_ODOMETER_KNOTS];
  uint32_t knots; /* that ever came */
  float last_dps; /* as the newest sample has it */
} thermorig_odometer_gyro_path;

typedef struct { /* whether the gyro's samples are what they should be */
  uint32_t last_us, repeats_since_us;
  float last_rate_dps[3];
  float saturated_s, unseen_deg2; /* a variance: of what nothing measured since the newest frame */
  uint8_t has_sample, was_away;   /* away: since a search on the circle began */
} thermorig_odometer_gyro_watch;

typedef struct { /* what the gyro's axes turned by in a short time */
  float length_s, turned_deg[3];
} thermorig_odometer_gyro_block;

typedef struct { /* how far its noise lets the angle walk: a variance, in a second */
  thermorig_odometer_gyro_block newest, last;
  float walk_deg2;
} thermorig_odometer_gyro_noise;

typedef struct {
  float covariance[THERMORIG_ODOMETER_STATES * (THERMORIG_ODOMETER_STATES + 1) / 2]; /* a lower triangle */
  float value[THERMORIG_ODOMETER_STATES]; /* heading, bias, scale, latency, the map's offsets */
  float moved_deg; /* so far halves and searches have moved the heading off the gyro's, since all fitted */
  uint8_t node[THERMORIG_ODOMETER_NODES];
  uint8_t is_learning; /* the map is being made */
  uint8_t is_open;     /* the map may not close: what is written again is off as the half is by then */
  uint8_t has_begun;   /* it has a time: */
  int32_t turns;
  uint32_t now_us, now_turned; /* as the gyro's path has it then */
} thermorig_odometer_heading_filter;

typedef struct {                                                          /* the newest chess half */
  float temp_k[THERMORIG_ODOMETER_ROWS][THERMORIG_ODOMETER_HALF_COLUMNS]; /* about the reference */
  uint32_t parity, begin_us, end_us;
  float time_sigma_s;
} thermorig_odometer_half_reading;

typedef struct {                                                               /* of either half */
  int16_t offset[2][THERMORIG_ODOMETER_ROWS][THERMORIG_ODOMETER_HALF_COLUMNS]; /* 1/4096 K */
  uint8_t variance[2][THERMORIG_ODOMETER_ROWS][THERMORIG_ODOMETER_HALF_COLUMNS];
  float learnt[2]; /* halves that they were learnt from */
} thermorig_odometer_pixel_model;

typedef struct {                                                  /* the map */
  int16_t temp[THERMORIG_ODOMETER_ROWS][THERMORIG_ODOMETER_BINS]; /* 1/256 K about the reference */
  uint8_t variance[THERMORIG_ODOMETER_ROWS]
                  [THERMORIG_ODOMETER_BINS]; /* 4 bits each of exponent and mantissa */
} thermorig_odometer_panorama;

typedef struct { /* of a row of the map: over all bins of a window before */
  int32_t temp[THERMORIG_ODOMETER_WINDOW + 1];
  uint32_t variance[THERMORIG_ODOMETER_WINDOW + 1];
} thermorig_odometer_row_sums;

typedef struct {                 /* for the heading in the map */
  float log[360];                /* of the probabilities */
  float turned_deg, azimuth_deg; /* since the first half; of the newest, as the gyro has it */
  int32_t halves;
} thermorig_odometer_circle_search;

typedef struct {
  float sum, squares, count;
} thermorig_odometer_cell;

typedef struct { /* for the bias, before there is a map */
  int16_t temp[THERMORIG_ODOMETER_SEARCHED_HALVES][THERMORIG_ODOMETER_ROWS][THERMORIG_ODOMETER_HALF_COLUMNS];
  int16_t error[2][THERMORIG_ODOMETER_ROWS][THERMORIG_ODOMETER_HALF_COLUMNS]; /* of the pixels */
  uint32_t turned[THERMORIG_ODOMETER_SEARCHED_HALVES], time_us[THERMORIG_ODOMETER_SEARCHED_HALVES];
  uint8_t parity[THERMORIG_ODOMETER_SEARCHED_HALVES];
  uint16_t cell_of[THERMORIG_ODOMETER_SEARCHED_HALVES][THERMORIG_ODOMETER_COLUMNS];
  thermorig_odometer_cell cell[THERMORIG_ODOMETER_CELLS];
  float variance[THERMORIG_ODOMETER_BIASES];
  int32_t kept, tried; /* halves that ever came; biases, -1: none before the next halves */
} thermorig_odometer_bias_search;

typedef struct { /* filter and map together, and the half that is laid against it */
  thermorig_odometer_half_reading half;
  thermorig_odometer_heading_filter filter;
  thermorig_odometer_pixel_model pixels;
  union {
    struct {
      thermorig_odometer_panorama panorama;
      union { /* no row is looked at while the heading is searched for */
        thermorig_odometer_row_sums sums;
        thermorig_odometer_circle_search circle;
      } by;
    } map;
    thermorig_odometer_bias_search search;
  } of;
  uint32_t noise;
  float reference_c,
      common_c;     /* what temperatures are differences from; what the newest half had in common */
  float in_map_deg; /* sigma of the heading against the map that is in view */
  int32_t halves;
} thermorig_odometer_tracker;

typedef struct {
  thermorig_odometer_profile profile;
  thermorig_odometer_gyro_watch watch;
  thermorig_odometer_gyro_noise noise;
  thermorig_odometer_gyro_path path;
  thermorig_odometer_tracker tracker;
  /* the newest frame */
  uint32_t last_half_us, half_begin_us[2], frame_begin_us, frame_end_us;
  float rate_dps, rate_change_dps;
  /* what goes on */
  int32_t phase, pass, covered, to_trust;
  uint32_t pass_since_us, unfit_since_us, locating_since_us;
  float begun_bias_dps, begun_scale, begun_latency_s;
  uint16_t judged, far;       /* halves of the pass; those that lay far from where they were expected */
  float nis, lean, found_dps; /* the speed at which a search found the heading */
  float origin_deg2;          /* a variance: of where the map begins in the first one that was tracked in */
  uint32_t ignored;
  uint8_t has_seen, has_origin, has_tracked, is_unfit, is_doubted, is_explained;
} thermorig_odometer_state;

/* At the start: forgets everything. */
void thermorig_odometer_reset(thermorig_odometer_state* state, const thermorig_odometer_profile* profile);

/* A sample of the gyro: deg/s about its three axes, as read. `saturated`: not 0 at the end of its range. One
 * with a rate that is no number, or beyond 10000 deg/s, is ignored and counted. */
void thermorig_odometer_push_gyro(thermorig_odometer_state* state, uint32_t time_us, const float rate_dps[3],
                                  int saturated);

/* A frame of the camera, once the gyro's samples up to the end of its exposure were pushed: without them it
 * is passed over. Pixels that are no temperatures (NaN, or beyond -60 to 400 degrees) are left out. A frame
 * whose time_sigma_s is no number, or negative, is ignored and counted. */
void thermorig_odometer_push_frame(thermorig_odometer_state* state, const thermorig_odometer_frame* frame);

/* What is known at a time that is not before the newest frame's exposure ended: beyond it the gyro tells. */
void thermorig_odometer_read(const thermorig_odometer_state* state, uint32_t time_us,
                             thermorig_odometer_output* output);

#ifdef __cplusplus
}
#endif

#endif
