// LaserBot Battle: the robot's Arduino. Takes commands from the Raspberry Pi over rosserial, drives two stepper motors
// and the IR emitter, and reports hits and how it is.
#include <Arduino.h>

#include "src/board/analog.h"
#include "src/board/board.h"
#include "src/board/light.h"
#include "src/board/program.h"
#include "src/board/uart.h"
#include "src/board/watchdog.h"
#include "src/board_health_msg.h"
#include "src/identify.h"
#include "src/ir/deafness.h"
#include "src/ir/decoder.h"
#include "src/ir/emitter.h"
#include "src/ir/hit_detector.h"
#include "src/ir/repeats.h"
#include "src/motion/drive.h"
#include "src/motion/movement.h"
#include "src/robot_msg.h"
#include "src/rosserial/client.h"
#include "src/setup_msg.h"
#include "src/version.h"

static rosserial::Client client;
static KeptSetup kept;
static Emitter emitter;
static HitDetector hits;
static Decoder decoder;
static Repeats repeats;
static Deafness deafness;
static Identify identify;

static bool commanded = false;  // a command came less than DEAD_MAN_MS ago
static uint32_t commanded_at = 0;
static bool firing = false;
static bool deaf = false;
static uint16_t shots = 0;
static uint16_t last_edge = 0;
static uint32_t health_at = 0;
static uint32_t loop_max = 0;  // cycles

static void on_command(const RobotMsg &command, uint32_t now) {
  commanded = true;
  commanded_at = now;
  identify.leave_wheels();
  board::drive(movement_of(command.linear_x, command.angular_z));
  if (command.shoot) emitter.shoot(ShotTimes(kept.get()), now);
}

static void on_setup(const Setup &setup) {
  if (setup.mode != kept.get().mode) {
    emitter.stop();
    decoder.reset();
    hits.reset();
  }
  kept.keep(setup);
}

static void on_message(uint32_t now) {
  const uint8_t *payload = client.payload();
  const uint16_t length = client.length();
  Setup setup;
  switch (client.topic()) {
    case rosserial::COMMAND:
      if (length == ROBOT_MSG_LENGTH) on_command(decode_robot_msg(payload), now);
      break;
    case rosserial::SETUP:
      if (length == SETUP_LENGTH && decode_setup(payload, setup)) on_setup(setup);
      break;
    case rosserial::IDENTIFY:
      identify.start(!commanded, now);
      break;
  }
}

static void listen(const rosserial::Now &now) {
  uint8_t byte;
  while (client.message(now)) on_message(now.ms);
  while (uart::read(byte)) {
    client.receive(byte, now);
    while (client.message(now)) on_message(now.ms);
  }
}

static void shoot(uint32_t now) {
  const Setup &setup = kept.get();
  const bool fired = firing;
  firing = emitter.update(ShotTimes(setup), now);
  if (firing == fired) return;
  if (firing) count(shots);
  if (firing && setup.mode == CODED) {
    light::send(packet_bits(Hit{setup.id, setup.team, setup.damage}));
  } else {
    light::emit(firing);
  }
}

static void on_packet(uint32_t now) {
  const Setup &setup = kept.get();
  const Hit hit = decoder.hit();
  if (hit.shooter != setup.id && repeats.is_new(hit.shooter, setup.cooldown, now)) client.publish_hit(hit);
}

static void look(uint32_t now) {
  bool edges = false, lost = false;
  light::Edge edge;
  while (light::take_edge(edge, lost)) {
    edges = true;
    if (kept.get().mode != CODED) continue;
    if (lost || firing) decoder.spoil();
    if (!firing && decoder.feed(!edge.light, (edge.at - last_edge) & light::TIME_MASK)) on_packet(now);
    last_edge = edge.at;
  }
  const bool light = light::seen();
  deaf = deafness.update(edges, light, now);
  if (kept.get().mode == CODED) {
    if (firing) decoder.reset();
    if (!light && decoder.dark((light::clock() - last_edge) & light::TIME_MASK)) on_packet(now);
  } else if (hits.update(edges, light, firing, now)) {
    client.publish_response();
  }
}

static void tell_health(uint32_t now) {
  const uint16_t hash = program::hash();
  if (!client.configured()) health_at = now;
  if (now - health_at < HEALTH_MS || hash == 0) return;
  BoardHealth health;
  health.major = VERSION_MAJOR;
  health.minor = VERSION_MINOR;
  health.hash = hash;
  health.reset_cause = watchdog::reset_cause();
  health.mode = kept.get().mode;
  health.deaf = deaf;
  health.uptime = now / 1000;
  health.supply = analog::supply();
  health.battery = analog::battery();
  const uint32_t loop_us = loop_max / (F_CPU / 1000000);
  health.loop_max = loop_us < UINT16_MAX ? loop_us : UINT16_MAX;
  health.round_trip = client.round_trip();
  health.serial_errors = client.parser().errors();
  health.resyncs = client.parser().resyncs();
  health.overruns = uart::overruns();
  health.packets = decoder.packets();
  health.bad_packets = decoder.bad();
  health.shots = shots;
  if (!client.publish_board(health, rosserial::Now(now, 0))) return;
  health_at = now;
  loop_max = 0;
}

// Sleeps until there is something to do: a byte, an edge of light or the next millisecond. Within a packet of light it
// is the next tick at the latest: the packet's end is no edge, and has to be told soon.
static void rest(uint32_t now) {
  const bool in_packet = decoder.begun();
  do {
    noInterrupts();
    if (uart::waiting() || light::waiting() || millis() != now) {
      interrupts();
      return;
    }
    if (in_packet) board::need_tick();
    board::sleep();
  } while (!in_packet);
}

void setup() {
  light::begin();
  board::begin();
  uart::begin();
  analog::begin();
  watchdog::begin();
  client.announce();
}

void loop() {
  const uint32_t began = board::cycles();
  const uint32_t now = millis();
  const rosserial::Now both(now, micros());
  if (now - commanded_at >= DEAD_MAN_MS) commanded = false;
  listen(both);
  shoot(now);
  look(now);
  if (identify.update(now)) board::drive(movement_of(0, identify.turn()));
  board::led(identify.led());
  analog::update(now);
  client.spin(both);
  tell_health(now);

  if (!board::sound() || !light::sound() || !uart::sound() || !kept.sound()) watchdog::restart();
  watchdog::feed();
  const uint32_t took = board::cycles() - began;
  if (took > loop_max) loop_max = took;
  rest(now);
}
