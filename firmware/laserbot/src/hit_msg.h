// laser_bot_battle/Hit on the wire: uint8 shooter, uint8 team, uint8 damage.
#pragma once

#include <stdint.h>

constexpr uint8_t HIT_LENGTH = 3;

struct Hit {
  uint8_t shooter;  // 0 to 127
  uint8_t team;     // 0 to 3
  uint8_t damage;   // code of MilesTag II's table, 0 to 15
};
