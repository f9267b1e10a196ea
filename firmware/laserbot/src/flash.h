// Constants that stay in the flash: the RAM is small, and what is not in it cannot be disturbed. On this machine (host
// tests) they are ordinary constants.
#pragma once

#ifdef __AVR__
#include <avr/pgmspace.h>
#else
#include <stdint.h>
#include <string.h>
#define PROGMEM
#define pgm_read_byte(address) (*reinterpret_cast<const uint8_t *>(address))
#define memcpy_P memcpy
#define strlen_P strlen
#endif
