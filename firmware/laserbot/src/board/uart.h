// The UART to the Raspberry Pi. The core's Serial has room for 63 bytes to send and waits when they are used up; the
// first part of an answer to a topic request has 187. This one has room for 255 and never waits, so the loop always
// runs on. Sending is rosserial/port.h.
#pragma once

#include <stdint.h>

namespace uart {

void begin();

// Whether there is a byte.
bool waiting();

// The same; takes it.
bool read(uint8_t &byte);

// Bytes that were lost because nobody took them in time, since the start.
uint16_t overruns();

// Whether the registers are as begin() has left them.
bool sound();

}  // namespace uart
