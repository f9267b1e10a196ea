// Counters of the health message: they stand still at their largest value.
#pragma once

#include <stdint.h>

inline void count(uint16_t &counter) {
  if (counter < UINT16_MAX) ++counter;
}
