// LaserBot Battle: the robot's Arduino Uno. Takes commands from the Raspberry Pi over rosserial, drives two stepper
// motors and the IR laser, and reports hits.
#include <Arduino.h>
#include <avr/sleep.h>

#include "src/board/board.h"
#include "src/board/uart.h"
#include "src/ir/emitter.h"
#include "src/ir/hit_detector.h"
#include "src/motion/movement.h"
#include "src/robot_msg.h"
#include "src/rosserial/client.h"

static void on_command(const uint8_t *payload, uint16_t length);

static Uart uart;
static Emitter emitter;
static HitDetector hits;
static rosserial::Client client(
    uart, rosserial::Topic{125, "response", "std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e"},
    rosserial::Topic{100, "command", "laser_bot_battle/Robot_msg", "aa81278360e1bdd1ffce0a4efe0ae199"}, on_command);

static void on_command(const uint8_t *payload, uint16_t length) {
  if (length != ROBOT_MSG_LENGTH) return;
  const RobotMsg command = decode_robot_msg(payload);
  board::drive(movement_of(command.linear_x, command.angular_z));
  if (command.shoot) emitter.shoot();
}

void setup() {
  board::begin();
  uart.begin();
  set_sleep_mode(SLEEP_MODE_IDLE);
}

void loop() {
  const uint32_t now = millis();
  uint8_t byte;
  while (uart.read(byte)) client.receive(byte, now);
  board::laser(emitter.update(now));
  if (hits.update(board::take_light_edge(), board::light(), now)) client.publish_empty();
  client.spin(now);
  // Until the next interrupt: the motors' tick comes every 0.2 ms, a byte or an edge of light wakes at once.
  sleep_mode();
}
