/* SPDX-License-Identifier: MIT */
/* What a thermal sensor of Melexis has in its memory, framed for a stream of bytes: see mlx_raw.md. For C99
   and C++: a sketch may include it. */
#ifndef THERMORIG_MLX_RAW_H
#define THERMORIG_MLX_RAW_H

#include <stddef.h>
#include <stdint.h>

/* A message: mark, kind, number of words, words, check sum. All numbers have their most significant byte
   first, as they come over the sensor's bus. */
#define MLX_RAW_MARK_0 0x4DU
#define MLX_RAW_MARK_1 0x58U
#define MLX_RAW_HEADER_BYTES 5U
#define MLX_RAW_SUM_BYTES 2U

#define MLX_RAW_EEPROM ((uint8_t)'E')
#define MLX_RAW_NEW_DATA ((uint8_t)'N')
#define MLX_RAW_HALF ((uint8_t)'H')
#define MLX_RAW_IMAGE ((uint8_t)'I')
#define MLX_RAW_TOO_SLOW ((uint8_t)'S')

#define MLX_RAW_EEPROM_WORDS 832U
#define MLX_RAW_NEW_DATA_WORDS 1U
#define MLX_RAW_HALF_WORDS 834U
#define MLX_RAW_IMAGE_WORDS 770U
#define MLX_RAW_TOO_SLOW_WORDS 2U

/* The command to a bridge: these bytes, a digit 0 to 7 (the sensor's register of the rate) or '-' (as it is),
 * LF. */
#define MLX_RAW_COMMAND "MXR"

/* How many words a message of that kind has; 0: there is no such kind. */
static inline uint16_t mlx_raw_words(uint8_t kind) {
  switch (kind) {
    case MLX_RAW_EEPROM:
      return MLX_RAW_EEPROM_WORDS;
    case MLX_RAW_NEW_DATA:
      return MLX_RAW_NEW_DATA_WORDS;
    case MLX_RAW_HALF:
      return MLX_RAW_HALF_WORDS;
    case MLX_RAW_IMAGE:
      return MLX_RAW_IMAGE_WORDS;
    case MLX_RAW_TOO_SLOW:
      return MLX_RAW_TOO_SLOW_WORDS;
    default:
      return 0U;
  }
}

/* Bytes of a whole message with so many words. */
static inline size_t mlx_raw_size(uint16_t words) {
  return MLX_RAW_HEADER_BYTES + 2U * (size_t)words + MLX_RAW_SUM_BYTES;
}

/* CRC-16/XMODEM (polynomial 1021, start 0) of the header and the words. */
static inline uint16_t mlx_raw_sum(uint16_t sum, const uint8_t* bytes, size_t count) {
  size_t i;
  for (i = 0; i < count; ++i) {
    uint8_t x = (uint8_t)((uint8_t)(sum >> 8U) ^ bytes[i]);
    x = (uint8_t)(x ^ (uint8_t)(x >> 4U));
    sum = (uint16_t)((uint16_t)(sum << 8U) ^ (uint16_t)((uint16_t)x << 12U) ^ (uint16_t)((uint16_t)x << 5U) ^
                     x);
  }
  return sum;
}

/* Writes mark, kind and number of words; MLX_RAW_HEADER_BYTES. */
static inline void mlx_raw_header(uint8_t* out, uint8_t kind, uint16_t words) {
  out[0] = MLX_RAW_MARK_0;
  out[1] = MLX_RAW_MARK_1;
  out[2] = kind;
  out[3] = (uint8_t)(words >> 8U);
  out[4] = (uint8_t)(words & 0xFFU);
}

#endif
