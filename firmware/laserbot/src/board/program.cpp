#include "program.h"

#include <avr/pgmspace.h>
#include <util/crc16.h>

extern char __data_load_end;  // by the linker: the end of all that is in the flash

namespace {

constexpr uint8_t BYTES_PER_CALL = 32;  // 60 us

uint16_t next;
uint16_t crc = 0xffff;

}  // namespace

namespace program {

uint16_t hash() {
  const uint16_t end = reinterpret_cast<uint16_t>(&__data_load_end);
  for (uint8_t bytes = BYTES_PER_CALL; bytes > 0 && next < end; --bytes)
    crc = _crc16_update(crc, pgm_read_byte(next++));
  return next < end ? 0 : crc;
}

}  // namespace program
