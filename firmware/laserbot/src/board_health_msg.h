// laser_bot_battle/BoardHealth on the wire: its fields in this order, without padding.
#pragma once

#include <stdint.h>

#include "rosserial/frame.h"
#include "setup_msg.h"

constexpr uint8_t BOARD_HEALTH_LENGTH = 31;

// It is published so often.
constexpr uint32_t HEALTH_MS = 1000;

struct BoardHealth {
  uint8_t major;
  uint8_t minor;
  uint16_t hash;
  uint8_t reset_cause;
  Mode mode;
  bool deaf;
  uint32_t uptime;      // s
  uint16_t supply;      // mV
  uint16_t battery;     // mV; 0: no divider on A0
  uint16_t loop_max;    // us
  uint16_t round_trip;  // us; 0: none yet
  uint16_t serial_errors;
  uint16_t resyncs;
  uint16_t overruns;
  uint16_t packets;
  uint16_t bad_packets;
  uint16_t shots;
};

inline void write(rosserial::FrameWriter &frame, const BoardHealth &health) {
  frame.u8(health.major);
  frame.u8(health.minor);
  frame.u16(health.hash);
  frame.u8(health.reset_cause);
  frame.u8(health.mode);
  frame.u8(health.deaf);
  frame.u32(health.uptime);
  frame.u16(health.supply);
  frame.u16(health.battery);
  frame.u16(health.loop_max);
  frame.u16(health.round_trip);
  frame.u16(health.serial_errors);
  frame.u16(health.resyncs);
  frame.u16(health.overruns);
  frame.u16(health.packets);
  frame.u16(health.bad_packets);
  frame.u16(health.shots);
}
