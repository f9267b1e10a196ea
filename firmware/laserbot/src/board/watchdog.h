// A program that hangs, or whose RAM was disturbed, starts again by itself.
//
// Not by the watchdog's reset on a Nano with the old boot loader (ATmegaBOOT): that one leaves the watchdog on and
// would be reset by it again and again, until somebody unplugs the robot. It is told by what it leaves behind: it is
// the only one that starts a program with the cause of the reset still in MCUSR and its UART on. There the watchdog's
// interrupt starts the program again; that helps as long as interrupts are on.
#pragma once

#include <stdint.h>

namespace watchdog {

// Bits of reset_cause() as in MCUSR.
constexpr uint8_t POWER_ON = 1, RESET_PIN = 2, BROWN_OUT = 4, WATCHDOG = 8;

// Starts it: from now on feed() has to be called every 100 ms.
void begin();

void feed();

// Starts the program again, now.
void restart();

// Why this program has started. Optiboot up to version 4, on every Uno, clears MCUSR: then this is found out from what
// is left in the RAM, and a brown-out counts as a power-on.
uint8_t reset_cause();

// For the motors' tick, with its time in cycles: how long ago feed() was called tells a hanging program from a pressed
// button.
void tick(uint32_t time);

}  // namespace watchdog
