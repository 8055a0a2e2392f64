/* SPDX-License-Identifier: MIT
 * Start of a program on a Cortex-M of ARM's MPS2 board, as QEMU has it; the C library talks by semihosting.
 */
#include <stdint.h>

void stack_top(void); /* an address of the linker script, never called */
void _start(void);    /* the C library's: clears .bss, calls main */
void reset(void);
void fault(void);

#define CPACR (*(volatile uint32_t*)0xE000ED88u) /* ARMv7-M Architecture Reference Manual, B3.2.20 */

void reset(void) {
#if defined(__ARM_FP)
  CPACR |= 0xFu << 20; /* full access to the floating-point unit */
  __asm volatile("dsb\n isb");
#endif
  _start();
}

/* SYS_EXIT with ADP_Stopped_RunTimeErrorUnknown: QEMU ends with a failure instead of waiting for ever. */
void fault(void) {
  __asm volatile("movs r0, #0x18\n ldr r1, =0x20023\n bkpt 0xAB");
}

__attribute__((section(".vectors"), used)) static void (*const vectors[16])(void) = {
    stack_top, reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, fault, 0, fault, fault};
