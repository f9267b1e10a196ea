// A shot of coded light: a packet of MilesTag II, see docs/protocol-light.md.
#pragma once

#include <stdint.h>

#include "../hit_msg.h"

constexpr uint16_t HEADER_US = 2400;  // of carrier, then a space
constexpr uint16_t ONE_US = 1200;     // of carrier, then a space
constexpr uint16_t ZERO_US = 600;     // of carrier, then a space
constexpr uint16_t SPACE_US = 600;    // of darkness
constexpr uint8_t PACKET_BITS = 14;

// The longest packet, and some time for the first mark to begin.
constexpr uint32_t PACKET_MS = 30;

// 0, 7 bits of the shooter's ID, 2 of its team, 4 of the damage code: bit 13 is sent first.
inline uint16_t packet_bits(const Hit &shot) {
  return static_cast<uint16_t>((shot.shooter & 0x7f) << 6 | (shot.team & 3) << 4 | (shot.damage & 15));
}

inline Hit hit_of(uint16_t bits) {
  return Hit{static_cast<uint8_t>(bits >> 6 & 0x7f), static_cast<uint8_t>(bits >> 4 & 3),
             static_cast<uint8_t>(bits & 15)};
}

// The marks and spaces of one packet, one after the other.
class Envelope {
 public:
  void start(uint16_t bits) {
    bits_ = bits;
    next_ = 0;
  }

  // Starts the next mark or space; returns its length in us, 0: the packet has ended. carrier() tells which it is.
  uint16_t next() {
    if (next_ >= ENDS) return 0;
    const uint8_t part = next_++;
    if (!carrier()) return part + 1 < ENDS ? SPACE_US : 0;
    if (part == 0) return HEADER_US;
    const bool one = bits_ >> (PACKET_BITS - part / 2) & 1;
    return one ? ONE_US : ZERO_US;
  }

  bool carrier() const { return next_ & 1; }

 private:
  static constexpr uint8_t ENDS = 2 * (PACKET_BITS + 1);  // the header and each bit are a mark and a space

  uint16_t bits_ = 0;
  uint8_t next_ = ENDS;
};
