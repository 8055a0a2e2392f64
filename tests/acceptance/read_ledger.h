/* SPDX-License-Identifier: MIT */
/* What read() gave a program from each pseudo terminal: shared memory between a test and the program that it
 * starts with read_ledger.c preloaded. Written after each read() has returned and before the program sees it,
 * so it survives a kill. */
#ifndef THERMORIG_READ_LEDGER_H
#define THERMORIG_READ_LEDGER_H

#include <stdint.h>

#define READ_LEDGER_VARIABLE "THERMORIG_READ_LEDGER" /* names the file */
#define READ_LEDGER_PORTS 1024                       /* /dev/pts/0 to 1023 */

struct read_ledger_port {
  uint64_t bytes;      /* that all reads gave */
  uint64_t last_bytes; /* that the last one gave */
};

struct read_ledger {
  struct read_ledger_port ports[READ_LEDGER_PORTS];
};

#endif
