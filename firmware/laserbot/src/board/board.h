// The robot's hardware on an Arduino Uno: motors, laser and light sensor. All pins and timers are in board.cpp.
#pragma once

#include "../motion/movement.h"

namespace board {

// Makes the pins safe (laser off, coils off), then starts the interrupts.
void begin();

// Replaces the target of both motors. They run by interrupt, and stop by interrupt 320 ms after the last call.
void drive(const Movement &movement);

void laser(bool on);

// Whether light has begun to fall on the sensor since the last call.
bool take_light_edge();

// Whether light falls on the sensor now.
bool light();

}  // namespace board
