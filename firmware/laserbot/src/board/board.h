// The robot's motors and LED on an Arduino Uno, and the clock of all that is finer than a millisecond.
#pragma once

#include <stdint.h>

#include "../motion/movement.h"

namespace board {

// Makes the pins safe (coils off), then starts the motors' tick.
void begin();

// Replaces the target of both motors. They run by interrupt, and stop by interrupt 320 ms after the last call.
void drive(const Movement &movement);

void led(bool on);

// CPU cycles since the start, 16 a microsecond; wraps after 268 s.
uint32_t cycles();

// Whether the registers are as begin() has left them and the tick comes; to be called in each turn of the loop.
bool sound();

// The next tick interrupts, even if the motors do not need it. To be called with interrupts off.
void need_tick();

// Sleeps until the next interrupt. Called with interrupts off, it returns with interrupts on: one that comes between
// the caller's last look and the sleep ends the sleep.
void sleep();

// At once: coils and light off, no more interrupts.
void shut_down();

}  // namespace board
