// Two packets of one shooter within its cooldown are one shot: the second has come by way of a wall.
#pragma once

#include <stdint.h>

class Repeats {
 public:
  // Whether a packet of `shooter` at `now` (ms, may wrap) is a new shot. Its cooldown is `cooldown` ms; a 32nd of it is
  // allowed for clocks that differ.
  bool is_new(uint8_t shooter, uint16_t cooldown, uint32_t now) {
    const uint32_t least = cooldown - cooldown / 32;
    Entry *place = &entries_[0];
    for (Entry &entry : entries_) {
      if (entry.shooter == shooter && now - entry.at < least) return false;
      if (entry.shooter == shooter || entry.shooter == NOBODY) {
        place = &entry;
        break;
      }
      if (now - entry.at > now - place->at) place = &entry;
    }
    place->shooter = shooter;
    place->at = now;
    return true;
  }

 private:
  // A packet lasts 20 ms and more, so in 500 ms no more shooters can be heard.
  static constexpr uint8_t SHOOTERS = 24;
  static constexpr uint8_t NOBODY = 0xff;

  struct Entry {
    uint8_t shooter = NOBODY;
    uint32_t at = 0;
  };

  Entry entries_[SHOOTERS];
};
