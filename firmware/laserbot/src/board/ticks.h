// The clock of timer 1 and its ticks, for interrupts: they must not wait for each other.
#pragma once

#include <avr/io.h>
#include <stdint.h>

#include "../motion/stepper.h"

namespace board {

constexpr uint16_t TICK_CYCLES = F_CPU / TICKS_PER_SECOND;
static_assert(F_CPU % TICKS_PER_SECOND == 0, "the tick must be exact, or the motors' speed is not");

// Cycles that are enough to set the time of an interrupt before it comes.
constexpr uint16_t SETTING_CYCLES = 200;

// When the last tick was due, in cycles since the start. Timer 1 counts on from there.
extern volatile uint32_t tick_time;

// Cycles from then to the next interrupt, a multiple of TICK_CYCLES: while both motors stand, the ticks between have
// nothing to do.
extern volatile uint16_t tick_gap;

// Only while interrupts are off: somebody needs the next tick at its time.
inline void hurry() {
  const uint16_t longest = tick_gap;
  if (longest == TICK_CYCLES) return;
  const uint16_t last = tick_time;
  const uint16_t passed = TCNT1 - last + SETTING_CYCLES;
  uint16_t gap = TICK_CYCLES;
  while (gap < longest && gap < passed) gap += TICK_CYCLES;
  tick_gap = gap;
  OCR1A = last + gap;
}

// Only while interrupts are off: bytes of the timer and of the time must fit together.
inline uint32_t cycles_in_interrupt() {
  const uint32_t tick = tick_time;
  return tick + static_cast<uint16_t>(TCNT1 - static_cast<uint16_t>(tick));
}

}  // namespace board
