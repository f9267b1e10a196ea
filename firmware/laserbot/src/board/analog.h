// The Arduino's own voltage and the battery's, measured once a second. It never waits.
#pragma once

#include <stdint.h>

namespace analog {

void begin();

// To be called in each turn of the loop; `now` in ms, may wrap.
void update(uint32_t now);

// mV, of AVCC: the chip's own reference of 1.1 V (10 % exact) is measured against it. 0: not measured yet.
uint16_t supply();

// mV, of a battery on A0 behind a divider of 20 and 10 kOhm; 0: no divider.
uint16_t battery();

}  // namespace analog
