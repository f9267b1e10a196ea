// Pin            port       use
// 2              PD2, INT0  light sensor: light.cpp
// 3              PD3, OC2B  emitter: light.cpp
// 4, 5, 6, 7     PD4..PD7   right motor, IN1..IN4
// 8, 9, 10, 11   PB0..PB3   left motor, IN1..IN4
// 13             PB5        LED
// A0             PC0        battery: analog.cpp
//
// Timer 0 belongs to the core (millis). Timer 1 counts CPU cycles; compare A makes the motors' tick, compare B the
// marks and spaces of a shot. Timer 2 makes the carrier.
#include "board.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <util/atomic.h>

#include "../motion/drive.h"
#include "light.h"
#include "ticks.h"
#include "watchdog.h"

namespace {

constexpr uint8_t LEFT_COILS = 0x0f;   // of port B
constexpr uint8_t RIGHT_COILS = 0xf0;  // of port D
constexpr uint8_t LED = _BV(PB5);

// While both motors stand: 1 ms.
constexpr uint16_t RESTING_GAP = 5 * board::TICK_CYCLES;

// Turns of the loop without a tick that are too many. Each interrupt makes one; there are some 20 in 1 ms at most.
constexpr uint8_t TURNS_WITHOUT_TICK = 200;

Drive motors;
uint8_t turns = 0;  // of the loop since the last tick that it has seen
uint8_t tick_seen = 0;

}  // namespace

namespace board {
volatile uint32_t tick_time = 0;
volatile uint16_t tick_gap = TICK_CYCLES;
}  // namespace board

ISR(TIMER1_COMPA_vect) {
  const bool resting = motors.at_rest();
  const uint16_t gap = resting ? RESTING_GAP : board::TICK_CYCLES;
  const uint32_t time = board::tick_time + board::tick_gap;
  board::tick_time = time;
  board::tick_gap = gap;
  OCR1A = static_cast<uint16_t>(time) + gap;
  watchdog::tick(time);
  light::tick();
  if (!resting && motors.tick()) {
    const uint8_t left = (PORTB & ~LEFT_COILS) | motors.left_coils();
    const uint8_t right = (PORTD & ~RIGHT_COILS) | motors.right_coils() << 4;
    PORTB = left;
    PORTD = right;
  }
}

namespace board {

void begin() {
  PORTB &= ~(LEFT_COILS | LED);
  PORTD &= ~RIGHT_COILS;
  DDRD |= RIGHT_COILS;
  DDRB |= LEFT_COILS | LED;

  TCCR1A = 0;
  TCCR1B = _BV(CS10);  // free, at the CPU's clock
  TCNT1 = 0;
  OCR1A = TICK_CYCLES;
  TIFR1 = _BV(OCF1A) | _BV(OCF1B);
  TIMSK1 = _BV(OCIE1A);
  set_sleep_mode(SLEEP_MODE_IDLE);
}

void drive(const Movement &movement) {
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    motors.command(movement);
    hurry();
  }
}

// Single-instruction writes (sbi, cbi): the tick writes the other bits of this port.
void led(bool on) {
  if (on) {
    PORTB |= LED;
  } else {
    PORTB &= ~LED;
  }
}

uint32_t cycles() {
  uint32_t now = 0;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { now = cycles_in_interrupt(); }
  return now;
}

bool sound() {
  const uint8_t tick = tick_time;
  if (tick != tick_seen) turns = 0;
  tick_seen = tick;
  return ++turns < TURNS_WITHOUT_TICK && (SREG & _BV(SREG_I)) && TCCR1A == 0 && TCCR1B == _BV(CS10) &&
         (TIMSK1 & ~_BV(OCIE1B)) == _BV(OCIE1A) && (DDRB & (LEFT_COILS | LED)) == (LEFT_COILS | LED) &&
         (DDRD & RIGHT_COILS) == RIGHT_COILS && TIMSK0 == _BV(TOIE0) && TCCR0A == (_BV(WGM01) | _BV(WGM00)) &&
         TCCR0B == (_BV(CS01) | _BV(CS00));
}

void need_tick() { hurry(); }

void sleep() {
  sleep_enable();
  sei();
  sleep_cpu();
  sleep_disable();
}

void shut_down() {
  cli();
  PORTB &= ~LEFT_COILS;
  PORTD &= ~RIGHT_COILS;
  light::emit(false);
}

}  // namespace board
