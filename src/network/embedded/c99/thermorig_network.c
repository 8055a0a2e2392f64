/* SPDX-License-Identifier: MIT
 *
@facts@
 *
 *   window (Nf, H, W) -> 6 filters 5x5, ReLU, max-pool 2x2 -> 16 filters 5x5, ReLU -> features
 *   features -> 120 ReLU -> 80 ReLU -> 1                          speed from images
 *   features -> 120 ReLU -> 1 sigmoid                             Kg
 *   fusion = Kg * speed from images + (1 - Kg) * gyro
 */
#include "thermorig_network.h"

#include <float.h>
#include <math.h>

#include "thermorig_network_weights.h"

#define FRAMES THERMORIG_NETWORK_FRAMES
#define KERNEL THERMORIG_NETWORK_KERNEL
#define PIXELS THERMORIG_NETWORK_PIXELS
#define POOLED THERMORIG_NETWORK_POOLED
#define PLANE2 THERMORIG_NETWORK_PLANE2
#define FEATURES (THERMORIG_NETWORK_FILTERS2 * PLANE2)
#define HIDDEN1 THERMORIG_NETWORK_HIDDEN1
#define HIDDEN2 THERMORIG_NETWORK_HIDDEN2

typedef thermorig_network_state network_state;
typedef thermorig_network_value network_value;

/* The caller's memory is as large as the header says. */
typedef char network_state_size_is_as_stated[sizeof(network_state) == THERMORIG_NETWORK_STATE_BYTES ? 1 : -1];

#if THERMORIG_NETWORK_INTEGER
typedef int32_t network_sum; /* at most 192 products of 15 and 7 bits: below 2^30 */
#define VALUE_MAX 32767.0f   /* of an activation */
#if THERMORIG_NETWORK_BY_WINDOW
#define STEPS_A_DEVIATION 8191.0f /* of a scaled window: 4 deviations either way */
#else
#define STEPS_PER_DEGREE 256.0f /* frames are kept about the training mean, 128 degrees either way */
#endif
#else
typedef float network_sum;
#endif

/* Planes (rows, columns) that a 5x5 kernel slides over, with `padding` zeros around them. */
typedef struct {
  const network_value* plane[6];
  int planes, rows, columns, padding;
} image;

static float relu(float x) {
  return x > 0.0f ? x : 0.0f;
}

static network_sum dot(const network_value* values, const network_weight* weights, int count) {
  network_sum total = 0;
  const int fours = count - count % 4;
  for (int i = 0; i < fours; i += 4) /* four a turn: less to count */
    total += (network_sum)values[i] * (network_sum)weights[i] +
             (network_sum)values[i + 1] * (network_sum)weights[i + 1] +
             (network_sum)values[i + 2] * (network_sum)weights[i + 2] +
             (network_sum)values[i + 3] * (network_sum)weights[i + 3];
  for (int i = fours; i < count; ++i) total += (network_sum)values[i] * (network_sum)weights[i];
  return total;
}

/* A whole row of the kernel. */
static network_sum dot_kernel_row(const network_value* values, const network_weight* weights) {
  return (network_sum)values[0] * (network_sum)weights[0] + (network_sum)values[1] * (network_sum)weights[1] +
         (network_sum)values[2] * (network_sum)weights[2] + (network_sum)values[3] * (network_sum)weights[3] +
         (network_sum)values[4] * (network_sum)weights[4];
}

/* What a sum of products stands for, with the bias of its row: `scale` is that of the activations. */
static float real_of(float total, float scale, const network_layer* layer, int row) {
#if THERMORIG_NETWORK_INT8
  return total * (scale * layer->scale[row]) + layer->bias[row];
#else
  return total * scale + layer->bias[row];
#endif
}

#if THERMORIG_NETWORK_INTEGER
static int16_t rounded(float x) {
  if (!(x > -VALUE_MAX)) return (int16_t)-VALUE_MAX;
  if (!(x < VALUE_MAX)) return (int16_t)VALUE_MAX;
  return (int16_t)(x < 0.0f ? x - 0.5f : x + 0.5f);
}
#endif

/* Outputs of a layer (0 or above) as inputs of the next: an activation times `scale` is the real value. */
static const network_value* values_of(const float* real, int count, network_value* store, float* scale) {
#if THERMORIG_NETWORK_INTEGER
  float most = 0.0f;
  for (int i = 0; i < count; ++i)
    if (real[i] > most) most = real[i];
  const float steps = most > 0.0f ? VALUE_MAX / most : 0.0f;
  for (int i = 0; i < count; ++i) store[i] = rounded(real[i] * steps);
  *scale = most / VALUE_MAX;
  return store;
#else
  (void)count;
  (void)store;
  *scale = 1.0f;
  return real;
#endif
}

/* The mean of a block of the camera's pixels, in degrees. */
static float block_mean(const float* temp_c, int row, int column) {
  const int size = THERMORIG_NETWORK_REDUCTION;
  float total = 0.0f;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      total += temp_c[(row * size + y) * THERMORIG_NETWORK_CAMERA_COLUMNS + THERMORIG_NETWORK_CROP_LEFT +
                      column * size + x];
  return total / (float)(size * size);
}

#if THERMORIG_NETWORK_BY_WINDOW
#define ROWS THERMORIG_NETWORK_ROWS
#define COLUMNS THERMORIG_NETWORK_COLUMNS
#define ROUNDS 4
#define OUTLIER 3.0f          /* deviations from its row: does not count */
#define LEAST_DEVIATION 0.01f /* degrees */
#define MOST_DEVIATIONS 4.0f  /* that are left of a pixel */

static const float* degrees_of(const network_state* state, int frame) {
  return state->degrees[(state->next + frame) % FRAMES];
}

/* What of a row, in all frames, is within `limit` of `mean`: how many pixels, and the sums of what they are
 * above it and of the squares of that. */
typedef struct {
  float count, sum, squares;
} row_sums;

static row_sums sums_of_row(const network_state* state, int row, float mean, float limit) {
  row_sums sums = {0.0f, 0.0f, 0.0f};
  for (int i = 0; i < FRAMES; ++i) {
    const float* values = degrees_of(state, i) + row * COLUMNS;
    for (int x = 0; x < COLUMNS; ++x) {
      const float off = values[x] - mean;
      if (!(off <= limit && off >= -limit)) continue;
      sums.count += 1.0f;
      sums.sum += off;
      sums.squares += off * off;
    }
  }
  return sums;
}

static network_value scaled(float deviations) {
  const float x = deviations > MOST_DEVIATIONS    ? MOST_DEVIATIONS
                  : deviations < -MOST_DEVIATIONS ? -MOST_DEVIATIONS
                                                  : deviations;
#if THERMORIG_NETWORK_INTEGER
  return rounded(x * STEPS_A_DEVIATION);
#else
  return x;
#endif
}

/* The ring's frames, oldest first, to `frame`: each row less its mean, all over one deviation. */
static void scale_window(network_state* state) {
  float mean[ROWS], deviation = FLT_MAX / OUTLIER;
  for (int row = 0; row < ROWS; ++row) {
    const float first = degrees_of(state, 0)[row * COLUMNS]; /* near the mean: no digit is lost */
    mean[row] = first + sums_of_row(state, row, first, FLT_MAX).sum / (float)(FRAMES * COLUMNS);
  }
  for (int round = 0; round < ROUNDS; ++round) {
    float count = 0.0f, squares = 0.0f;
    for (int row = 0; row < ROWS; ++row) {
      const row_sums sums = sums_of_row(state, row, mean[row], OUTLIER * deviation);
      const float shift = sums.count > 0.0f ? sums.sum / sums.count : 0.0f;
      mean[row] += shift;
      count += sums.count;
      squares += sums.squares - sums.count * shift * shift;
    }
    deviation = count > 0.0f && squares > 0.0f ? sqrtf(squares / count) : 0.0f;
    if (deviation < LEAST_DEVIATION) deviation = LEAST_DEVIATION;
  }
  for (int i = 0; i < FRAMES; ++i)
    for (int place = 0; place < PIXELS; ++place)
      state->frame[i][place] = scaled((degrees_of(state, i)[place] - mean[place / COLUMNS]) / deviation);
}
#else
/* One pixel of the input, less the training data's mean, in its deviations. */
static network_value prepared(float degrees) {
#if THERMORIG_NETWORK_INTEGER
  return rounded((degrees - temp_mean_c) * STEPS_PER_DEGREE);
#else
  return (degrees - temp_mean_c) / temp_deviation_c;
#endif
}
#endif

/* A filter's sum of products with its upper left corner at (top, left) of the padded image. */
static network_sum filter_at(const image* in, const network_weight* weights, int top, int left) {
  /* the part of the kernel that lies on the planes, not on the zeros around them */
  const int y0 = top - in->padding, x0 = left - in->padding;
  const int first_y = y0 < 0 ? -y0 : 0, first_x = x0 < 0 ? -x0 : 0;
  const int end_y = y0 + KERNEL > in->rows ? in->rows - y0 : KERNEL;
  const int end_x = x0 + KERNEL > in->columns ? in->columns - x0 : KERNEL;
  const int whole = first_x == 0 && end_x == KERNEL;
  network_sum total = 0;
  for (int p = 0; p < in->planes; ++p)
    for (int y = first_y; y < end_y; ++y) {
      const network_value* values = in->plane[p] + (y0 + y) * in->columns + x0;
      const network_weight* row = weights + (p * KERNEL + y) * KERNEL;
      total += whole ? dot_kernel_row(values, row) : dot(values + first_x, row + first_x, end_x - first_x);
    }
  return total;
}

/* First convolution, ReLU and max-pooling of one filter. The largest of the four sums gives the largest
 * output, for scales are above 0; an odd last row or column is dropped. */
static void pooled_filter(const image* window, float scale, int filter, float* out) {
  const network_weight* weights = conv1.weights + filter * FRAMES * KERNEL * KERNEL;
  for (int row = 0; row < THERMORIG_NETWORK_POOLED_ROWS; ++row)
    for (int column = 0; column < THERMORIG_NETWORK_POOLED_COLUMNS; ++column) {
      network_sum most = filter_at(window, weights, 2 * row, 2 * column);
      for (int corner = 1; corner < 4; ++corner) {
        const network_sum next = filter_at(window, weights, 2 * row + corner / 2, 2 * column + corner % 2);
        if (next > most) most = next;
      }
      *out++ = relu(real_of((float)most, scale, &conv1, filter));
    }
}

/* Second convolution and ReLU of one filter. */
static void plane_of_filter(const image* pooled, float scale, int filter, float* out) {
  const network_weight* weights = conv2.weights + filter * THERMORIG_NETWORK_FILTERS1 * KERNEL * KERNEL;
  for (int row = 0; row < THERMORIG_NETWORK_ROWS2; ++row)
    for (int column = 0; column < THERMORIG_NETWORK_COLUMNS2; ++column)
      *out++ = relu(real_of((float)filter_at(pooled, weights, row, column), scale, &conv2, filter));
}

/* Adds what the features of one filter bring to the sums of a head's first layer. */
static void add_features(const network_value* plane, float scale, const network_weight* weights,
                         float* totals) {
  for (int row = 0; row < HIDDEN1; ++row)
    totals[row] += (float)dot(plane, weights + row * FEATURES, PLANE2) * scale;
}

/* The window's frames, oldest first. */
static image window_of(const network_state* state) {
  image window = {{0}, FRAMES, THERMORIG_NETWORK_ROWS, THERMORIG_NETWORK_COLUMNS, THERMORIG_NETWORK_PADDING1};
#if THERMORIG_NETWORK_BY_WINDOW
  for (int i = 0; i < FRAMES; ++i) window.plane[i] = state->frame[i];
#else
  for (int i = 0; i < FRAMES; ++i) window.plane[i] = state->frame[(state->next + i) % FRAMES];
#endif
  return window;
}

/* First convolution to `pooled`. */
static void convolve_window(network_state* state) {
  const image window = window_of(state);
#if THERMORIG_NETWORK_INTEGER && THERMORIG_NETWORK_BY_WINDOW
  const float scale = 1.0f / STEPS_A_DEVIATION;
#elif THERMORIG_NETWORK_INTEGER
  const float scale = 1.0f / (STEPS_PER_DEGREE * temp_deviation_c);
#else
  const float scale = 1.0f;
#endif
  for (int filter = 0; filter < THERMORIG_NETWORK_FILTERS1; ++filter)
    pooled_filter(&window, scale, filter, state->pooled + filter * POOLED);
}

#if THERMORIG_NETWORK_INTEGER
#define POOLED_STORE state->pooled_value
#define PLANE_STORE state->plane_value
#else
#define POOLED_STORE 0
#define PLANE_STORE 0
#endif

/* Second convolution and the heads' first layers, filter by filter: the features are never all in memory. */
static void convolve_pooled(network_state* state) {
  float scale;
  const network_value* values =
      values_of(state->pooled, THERMORIG_NETWORK_FILTERS1 * POOLED, POOLED_STORE, &scale);
  image pooled = {{0},
                  THERMORIG_NETWORK_FILTERS1,
                  THERMORIG_NETWORK_POOLED_ROWS,
                  THERMORIG_NETWORK_POOLED_COLUMNS,
                  THERMORIG_NETWORK_PADDING2};
  for (int p = 0; p < THERMORIG_NETWORK_FILTERS1; ++p) pooled.plane[p] = values + p * POOLED;
  for (int row = 0; row < HIDDEN1; ++row) state->speed[row] = state->other[row] = 0.0f;
  for (int filter = 0; filter < THERMORIG_NETWORK_FILTERS2; ++filter) {
    float plane_scale;
    plane_of_filter(&pooled, scale, filter, state->plane);
    const network_value* plane = values_of(state->plane, PLANE2, PLANE_STORE, &plane_scale);
    add_features(plane, plane_scale, speed1.weights + filter * PLANE2, state->speed);
#if THERMORIG_NETWORK_FUSION
    add_features(plane, plane_scale, gain1.weights + filter * PLANE2, state->other);
#endif
  }
}

/* Scales, biases and ReLU of a head's first layer. */
static void finish_first(const network_layer* layer, float* totals) {
  for (int row = 0; row < HIDDEN1; ++row) totals[row] = relu(real_of(totals[row], 1.0f, layer, row));
}

/* A row of a head's later layers, whose weights are float32 in either kind. */
static float row_of(const float* values, const float* weights, int count, float bias) {
  float total = 0.0f;
  for (int i = 0; i < count; ++i) total += values[i] * weights[i];
  return total + bias;
}

/* The speed that the images tell, normalised. */
static float thermal_speed(network_state* state) {
  finish_first(&speed1, state->speed);
  for (int row = 0; row < HIDDEN2; ++row)
    state->other[row] = relu(row_of(state->speed, speed2_weights + row * HIDDEN1, HIDDEN1, speed2_bias[row]));
  return row_of(state->other, speed3_weights, HIDDEN2, speed3_bias[0]);
}

/* Kg. */
static float gain_of(network_state* state) {
#if THERMORIG_NETWORK_FUSION
  finish_first(&gain1, state->other);
  return 1.0f / (1.0f + expf(-row_of(state->other, gain2_weights, HIDDEN1, gain2_bias[0])));
#else
  (void)state;
  return 1.0f;
#endif
}

/* The mean of the window's frames. */
static float gyro_of(const network_state* state) {
  float total = 0.0f;
  for (int i = 0; i < FRAMES; ++i) total += state->gyro_dps[(state->next + i) % FRAMES];
  return total / (float)FRAMES;
}

static void run_network(network_state* state, float gyro_dps, thermorig_network_output* output) {
#if THERMORIG_NETWORK_BY_WINDOW
  const float scale_dps = label_scale_dps * (frame_period_s / THERMORIG_NETWORK_PERIOD_S);
  scale_window(state);
#else
  const float scale_dps = label_scale_dps;
#endif
  convolve_window(state);
  convolve_pooled(state);
  const float gain = gain_of(state); /* first: the speed head uses its memory again */
  const float thermal = thermal_speed(state);
  output->thermal_dps = thermal * scale_dps;
  output->gain = gain;
#if THERMORIG_NETWORK_FUSION
  output->fusion_dps = gain * output->thermal_dps + (1.0f - gain) * gyro_dps;
#else
  (void)gyro_dps;
  output->fusion_dps = output->thermal_dps;
#endif
}

static void add_frame(network_state* state, const float* temp_c, float gyro_dps) {
#if THERMORIG_NETWORK_BY_WINDOW
  float* frame = state->degrees[state->next];
#else
  network_value* frame = state->frame[state->next];
#endif
  for (int row = 0; row < THERMORIG_NETWORK_ROWS; ++row)
    for (int column = 0; column < THERMORIG_NETWORK_COLUMNS; ++column)
#if THERMORIG_NETWORK_BY_WINDOW
      *frame++ = block_mean(temp_c, row, column);
#else
      *frame++ = prepared(block_mean(temp_c, row, column));
#endif
  state->gyro_dps[state->next] = gyro_dps;
  state->next = (state->next + 1) % FRAMES;
  if (state->count < FRAMES) ++state->count;
}

void thermorig_network_reset(thermorig_network_state* state) {
  state->next = 0;
  state->count = 0;
}

static int is_number(float value) {
  return value <= FLT_MAX && value >= -FLT_MAX; /* not so for infinity and NaN */
}

static int is_sound(const float* temp_c, float gyro_dps) {
  for (int i = 0; i < THERMORIG_NETWORK_CAMERA_ROWS * THERMORIG_NETWORK_CAMERA_COLUMNS; ++i)
    if (!is_number(temp_c[i])) return 0;
  return !THERMORIG_NETWORK_FUSION || is_number(gyro_dps);
}

int thermorig_network_push(thermorig_network_state* state, const float* temp_c, float gyro_dps,
                           thermorig_network_output* output) {
  if (!is_sound(temp_c, gyro_dps)) {
    thermorig_network_reset(state);
    return 0;
  }
  add_frame(state, temp_c, gyro_dps);
  if (state->count < FRAMES) return 0;
  run_network(state, gyro_of(state), output);
  return 1;
}

void thermorig_network_estimate(thermorig_network_state* state, const float* temp_c, float gyro_dps,
                                thermorig_network_output* output) {
  thermorig_network_reset(state);
  for (int i = 0; i < FRAMES; ++i)
    add_frame(state, temp_c + i * THERMORIG_NETWORK_CAMERA_ROWS * THERMORIG_NETWORK_CAMERA_COLUMNS, gyro_dps);
  run_network(state, gyro_dps, output);
}
