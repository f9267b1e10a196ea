// laser_bot_battle/Setup: how the robot is to shoot and to be hit. On the wire: int8 ID, uint8 team, uint8 mode,
// uint16 cooldown, uint8 damage.
#pragma once

#include <stdint.h>

constexpr uint16_t SETUP_LENGTH = 6;

enum Mode : uint8_t { PLAIN = 0, CODED = 1 };

struct Setup {
  uint8_t id;    // 0 to 127
  uint8_t team;  // 0 to 3
  Mode mode;
  uint16_t cooldown;  // ms
  uint8_t damage;     // 0 to 15
};

// `bytes` has SETUP_LENGTH bytes. Returns false and leaves `setup` as it is if a value makes no sense.
inline bool decode_setup(const uint8_t *bytes, Setup &setup) {
  if (bytes[0] > 127 || bytes[1] > 3 || bytes[2] > CODED || bytes[5] > 15) return false;
  setup =
      Setup{bytes[0], bytes[1], static_cast<Mode>(bytes[2]), static_cast<uint16_t>(bytes[3] | bytes[4] << 8), bytes[5]};
  return true;
}

// The setup in force. A wrong bit in it would not mend itself, and the robot would shoot under another's name: so it is
// kept twice.
class KeptSetup {
 public:
  KeptSetup() { keep(Setup{NOBODY, 0, PLAIN, DEFAULT_COOLDOWN_MS, 0}); }

  void keep(const Setup &setup) {
    setup_ = setup;
    check_ = inverse(setup);
  }
  const Setup &get() const { return setup_; }

  // False: the RAM was disturbed.
  bool sound() const {
    return opposite(setup_.id, check_.id) && opposite(setup_.team, check_.team) && opposite(setup_.mode, check_.mode) &&
           (setup_.cooldown ^ check_.cooldown) == 0xffff && opposite(setup_.damage, check_.damage);
  }

  static constexpr uint8_t NOBODY = 0xff;  // no light carries this ID
  static constexpr uint16_t DEFAULT_COOLDOWN_MS = 500;

 private:
  static bool opposite(uint8_t value, uint8_t check) { return (value ^ check) == 0xff; }

  static Setup inverse(const Setup &setup) {
    return Setup{static_cast<uint8_t>(~setup.id), static_cast<uint8_t>(~setup.team),
                 static_cast<Mode>(~setup.mode & 0xff), static_cast<uint16_t>(~setup.cooldown),
                 static_cast<uint8_t>(~setup.damage)};
  }

  Setup setup_;
  Setup check_;
};
