/* What the examples need of a machine: where bytes go, and a drive in memory. */

#ifndef MACHINE_H
#define MACHINE_H

#include <stddef.h>

/* Sends bytes to whoever watches. */
void machine_write(const char *bytes, size_t length);

/* The drive, which drive.S takes in. */
extern const unsigned char drive_begin[];
extern const unsigned char drive_end[];

#endif
