/* What tests say when something is not as it should be. */

#ifndef EXPECT_H
#define EXPECT_H

#include <stdio.h>
#include <stdlib.h>

#define EXPECT(holds)                                            \
  do {                                                           \
    if (!(holds)) {                                              \
      printf("%s:%d: not so: %s\n", __FILE__, __LINE__, #holds); \
      exit(1);                                                   \
    }                                                            \
  } while (0)

#endif
