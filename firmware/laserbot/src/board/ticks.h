// The clock of timer 1, for interrupts: they must not wait for each other.
#pragma once

#include <avr/io.h>
#include <stdint.h>

namespace board {

// When the last tick was due, in cycles since the start. Timer 1 counts on from there.
extern volatile uint32_t tick_time;

// Only while interrupts are off: bytes of the timer and of the time must fit together.
inline uint32_t cycles_in_interrupt() {
  const uint32_t tick = tick_time;
  return tick + static_cast<uint16_t>(TCNT1 - static_cast<uint16_t>(tick));
}

}  // namespace board
