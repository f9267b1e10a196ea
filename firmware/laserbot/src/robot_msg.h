// laser_bot_battle/Robot_msg on the wire: int8 linear_x, int8 angular_z, bool shoot.
#pragma once

#include <stdint.h>

constexpr uint16_t ROBOT_MSG_LENGTH = 3;

struct RobotMsg {
  int8_t linear_x;
  int8_t angular_z;
  bool shoot;
};

// `bytes` has ROBOT_MSG_LENGTH bytes.
inline RobotMsg decode_robot_msg(const uint8_t *bytes) {
  return RobotMsg{static_cast<int8_t>(bytes[0]), static_cast<int8_t>(bytes[1]), bytes[2] != 0};
}
