// Pin            port       use
// 2              PD2, INT0  light sensor, low = light (pull-up on)
// 3              PD3        laser, low = on
// 4, 5, 6, 7     PD4..PD7   right motor, IN1..IN4
// 8, 9, 10, 11   PB0..PB3   left motor, IN1..IN4
//
// Timer 0 belongs to the core (millis), timer 1 makes the motors' tick.
#include "board.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

#include "../motion/drive.h"

namespace {

constexpr uint8_t SENSOR = _BV(PD2);
constexpr uint8_t LASER = _BV(PD3);
constexpr uint8_t LEFT_COILS = 0x0f;   // of port B
constexpr uint8_t RIGHT_COILS = 0xf0;  // of port D

constexpr uint16_t TICK_CYCLES = F_CPU / TICKS_PER_SECOND;
static_assert(F_CPU % TICKS_PER_SECOND == 0, "the tick must be exact, or the motors' speed is not");

Drive motors;
volatile bool light_edge = false;

}  // namespace

ISR(TIMER1_COMPA_vect) {
  if (motors.tick()) {
    PORTB = (PORTB & ~LEFT_COILS) | motors.left_coils();
    PORTD = (PORTD & ~RIGHT_COILS) | motors.right_coils() << 4;
  }
  EIMSK |= _BV(INT0);
}

// INT0 comes before every other interrupt: a sensor that oscillates could stop the motors' tick and the UART for ever.
// So it is masked until the next tick; an edge meanwhile is latched by the hardware and served then.
ISR(INT0_vect) {
  light_edge = true;
  EIMSK &= ~_BV(INT0);
}

namespace board {

void begin() {
  PORTD |= LASER | SENSOR;  // the laser's pin has to be high before it becomes an output
  DDRD = (DDRD & ~SENSOR) | LASER | RIGHT_COILS;
  DDRB |= LEFT_COILS;

  EICRA = _BV(ISC01);  // falling edge
  TCCR1A = 0;
  TCCR1B = _BV(WGM12) | _BV(CS10);  // count to OCR1A at the CPU's clock
  TCNT1 = 0;
  OCR1A = TICK_CYCLES - 1;
  TIMSK1 = _BV(OCIE1A);
}

void drive(const Movement &movement) {
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { motors.command(movement); }
}

// Single-instruction writes (sbi, cbi): the tick writes the other bits of this port.
void laser(bool on) {
  if (on) {
    PORTD &= ~LASER;
  } else {
    PORTD |= LASER;
  }
}

bool take_light_edge() {
  if (!light_edge) return false;
  light_edge = false;
  return true;
}

bool light() { return (PIND & SENSOR) == 0; }

}  // namespace board
