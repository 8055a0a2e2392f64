/* SPDX-License-Identifier: MIT
 * What a call takes on QEMU's MPS2 board: instructions and stack. */
#ifndef MEASURE_H
#define MEASURE_H

#include <stdint.h>

/* CMSDK APB timer 0 (ARM DDI 0479), 25 MHz, counting down. QEMU runs with `-icount shift=0`, an instruction a
 * nanosecond: a tick is 40 instructions. */
#define TIMER_CONTROL (*(volatile uint32_t*)0x40000000u)
#define TIMER_VALUE (*(volatile uint32_t*)0x40000004u)
#define INSTRUCTIONS_PER_TICK 40u

#ifndef PAINTED_WORDS
#define PAINTED_WORDS 1024 /* what is looked at of the stack */
#endif
#define PAINT 0xA5A5A5A5u

static inline uint32_t* stack_pointer(void) {
  uint32_t* sp;
  __asm volatile("mov %0, sp" : "=r"(sp));
  return sp;
}

static inline void begin_measuring(void) {
  volatile uint32_t* word = stack_pointer() - PAINTED_WORDS;
  for (int i = 0; i < PAINTED_WORDS; ++i) word[i] = PAINT;
  TIMER_CONTROL = 0;
  TIMER_VALUE = 0xFFFFFFFFu;
  TIMER_CONTROL = 1;
}

static inline uint32_t instructions_since(void) {
  return (0xFFFFFFFFu - TIMER_VALUE) * INSTRUCTIONS_PER_TICK;
}

static inline uint32_t stack_bytes_since(void) {
  const volatile uint32_t* word = stack_pointer() - PAINTED_WORDS;
  uint32_t untouched = 0;
  while (untouched < PAINTED_WORDS && word[untouched] == PAINT) ++untouched;
  return (PAINTED_WORDS - untouched) * 4u;
}

#endif
