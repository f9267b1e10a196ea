#include "analog.h"

#include <avr/io.h>

namespace {

constexpr uint8_t AGAINST_AVCC = _BV(REFS0);
constexpr uint8_t REFERENCE = AGAINST_AVCC | 0x0e;  // the 1.1 V
constexpr uint8_t BATTERY = AGAINST_AVCC | 0;       // A0
constexpr uint8_t BATTERY_PIN = _BV(PC0);
constexpr uint8_t ADC_ON = _BV(ADEN) | _BV(ADPS2) | _BV(ADPS1) | _BV(ADPS0);  // 125 kHz

constexpr uint32_t REFERENCE_MV = 1100;
constexpr uint16_t STEPS = 1024;
constexpr uint8_t DIVIDER = 3;

// With the pull-up on an open pin shows the supply. The divider's 10 kOhm pull it lower, whatever the battery.
constexpr uint16_t OPEN = STEPS - STEPS / 16;

constexpr uint32_t EVERY_MS = 1000;
constexpr uint32_t SETTLE_MS = 3;

enum class Step : uint8_t { REFERENCE, OPEN, BATTERY, WAIT };

Step step;
bool converting;
uint32_t since;
uint16_t supply_mv;
uint16_t battery_mv;

void go_to(Step next, uint8_t input, uint32_t now) {
  step = next;
  since = now;
  converting = false;
  if (next == Step::OPEN) {
    PORTC |= BATTERY_PIN;
  } else {
    PORTC &= ~BATTERY_PIN;
  }
  ADMUX = input;
}

}  // namespace

namespace analog {

void begin() {
  DDRC &= ~BATTERY_PIN;
  ADCSRB = 0;
  ADCSRA = ADC_ON;
  go_to(Step::REFERENCE, REFERENCE, 0);
}

void update(uint32_t now) {
  if (step == Step::WAIT) {
    if (now - since >= EVERY_MS) go_to(Step::REFERENCE, REFERENCE, now);
    return;
  }
  if (!converting) {
    if (now - since < SETTLE_MS) return;
    ADCSRA = ADC_ON | _BV(ADSC);
    converting = true;
    return;
  }
  if (ADCSRA & _BV(ADSC)) return;
  const uint16_t value = ADC;
  switch (step) {
    case Step::REFERENCE:
      supply_mv = value > 0 ? REFERENCE_MV * STEPS / value : 0;
      go_to(Step::OPEN, BATTERY, now);
      break;
    case Step::OPEN:
      if (value >= OPEN) battery_mv = 0;
      go_to(value >= OPEN ? Step::WAIT : Step::BATTERY, BATTERY, now);
      break;
    default:
      battery_mv = static_cast<uint32_t>(value) * supply_mv / STEPS * DIVIDER;
      go_to(Step::WAIT, BATTERY, now);
      break;
  }
}

uint16_t supply() { return supply_mv; }

uint16_t battery() { return battery_mv; }

}  // namespace analog
