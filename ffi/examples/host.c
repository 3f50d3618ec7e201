/* This computer as a machine for the examples. */

#include <stdio.h>

#include "machine.h"

void machine_write(const char *bytes, size_t length) {
  fwrite(bytes, 1, length, stdout);
}
