// A number that tells one program from another.
#pragma once

#include <stdint.h>

namespace program {

// CRC-16 (polynomial 0xa001, start 0xffff, as in Modbus) of the program in the flash, all bytes of laserbot.hex. Some
// of it is reckoned at each call; 0 until it is done.
uint16_t hash();

}  // namespace program
