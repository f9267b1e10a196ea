#include "watchdog.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/wdt.h>

#include "board.h"

namespace {

constexpr uint8_t PERIOD = WDTO_120MS;

// Times are in units of 256 cycles, 16 us, and wrap after 1 s.
constexpr uint16_t HUNGRY = 78000 / 16;  // the watchdog's clock is 10 % exact

// GPIOR0 keeps its bits when the program starts again without a reset.
constexpr uint8_t STARTED = _BV(0);
constexpr uint8_t OLD_BOOTLOADER = _BV(1);

// Not cleared at the start.
struct Left {
  uint8_t mcusr;
  uint8_t ucsr0b;
  uint8_t gpior0;
  uint16_t magic;
  volatile uint16_t now;  // the last tick
  volatile uint16_t fed;  // the last one before the watchdog was fed
};
Left left __attribute__((section(".noinit")));

constexpr uint16_t MAGIC = 0x5aa5;

uint8_t cause;

uint8_t find_cause() {
  if (left.gpior0 & STARTED) return watchdog::WATCHDOG;
  if (left.mcusr != 0) return left.mcusr;
  if (left.magic != MAGIC) return watchdog::POWER_ON;
  return left.now - left.fed >= HUNGRY ? watchdog::WATCHDOG : watchdog::RESET_PIN;
}

}  // namespace

// Before everything else: after its reset the watchdog is on and has 16 ms.
extern "C" void save_reset_cause() __attribute__((naked, used, section(".init3")));
void save_reset_cause() {
  left.mcusr = MCUSR;
  left.ucsr0b = UCSR0B;
  left.gpior0 = GPIOR0;
  MCUSR = 0;
  wdt_disable();
}

ISR(WDT_vect) { watchdog::restart(); }

namespace watchdog {

void begin() {
  cause = find_cause();
  if (left.mcusr != 0 && left.ucsr0b != 0) GPIOR0 |= OLD_BOOTLOADER;
  GPIOR0 |= STARTED;
  left.magic = MAGIC;
  left.now = left.fed = 0;
  const uint8_t mode = GPIOR0 & OLD_BOOTLOADER ? _BV(WDIE) : _BV(WDE);
  const uint8_t interrupts = SREG;
  cli();
  wdt_reset();
  WDTCSR = _BV(WDCE) | _BV(WDE);
  WDTCSR = mode | PERIOD;
  SREG = interrupts;
}

void feed() {
  wdt_reset();
  const uint8_t interrupts = SREG;
  cli();
  left.fed = left.now;
  SREG = interrupts;
}

void restart() {
  board::shut_down();
  left.fed = left.now - HUNGRY;
  if (GPIOR0 & OLD_BOOTLOADER) {
    wdt_disable();
    asm volatile("jmp 0");
  }
  wdt_enable(WDTO_15MS);
  while (true) {
  }
}

uint8_t reset_cause() { return cause; }

void tick(uint32_t time) { left.now = time >> 8; }

}  // namespace watchdog
