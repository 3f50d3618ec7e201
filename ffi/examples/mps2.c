/* The emulated board as a machine for the examples: QEMU's mps2-an386, a Cortex-M4F. No C library is needed. */

#include <stdint.h>

#include "machine.h"

int main(void);
void reset(void);

/* Of the linker script. */
extern uint32_t data_source[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];

static void halt(void) {
  for (;;) {
  }
}

static const struct {
  uint32_t *stack;
  void (*handlers[15])(void);
} vectors __attribute__((section(".vectors"), used)) = {
    stack_top,
    {reset, halt, halt, halt, halt, halt, 0, 0, 0, 0, halt, halt, 0, halt, halt},
};

/* A CMSDK UART. */
struct uart {
  volatile uint32_t data, state, control, interrupts, baud_divider;
};

#define UART0 ((struct uart *)0x40004000)

void machine_write(const char *bytes, size_t length) {
  for (size_t i = 0; i < length; i++) {
    while (UART0->state & 1u) {
    }
    UART0->data = (uint8_t)bytes[i];
  }
}

/* Ends the emulator by semihosting: SYS_EXIT_EXTENDED. */
static void leave(uint32_t code) {
  const uint32_t why[2] = {0x20026, code};
  register uint32_t operation __asm__("r0") = 0x20;
  register const uint32_t *argument __asm__("r1") = why;
  __asm__ volatile("bkpt 0xAB" : : "r"(operation), "r"(argument) : "memory");
}

void reset(void) {
  /* The FPU is off after a reset. */
  *(volatile uint32_t *)0xE000ED88 |= 0xFu << 20;
  __asm__ volatile("dsb\nisb" ::: "memory");
  const uint32_t *source = data_source;
  for (uint32_t *word = data_begin; word < data_end; word++) {
    *word = *source++;
  }
  for (uint32_t *word = bss_begin; word < bss_end; word++) {
    *word = 0;
  }
  UART0->baud_divider = 217;
  UART0->control = 1;
  leave((uint32_t)main());
  halt();
}
