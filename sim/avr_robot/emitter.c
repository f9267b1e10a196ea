#include "emitter.h"

#include <simavr/avr_extint.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_timer.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_io.h>

enum {
	EMITTER_PIN = 3, /* PD3 */
	EMITTER_INT = 1, /* PD3 is INT1's pin, too */
	CARRIER_HZ = 38000,
	TOLERANCE_HZ = CARRIER_HZ / 20, /* 5 %: beyond that receivers hardly see it */
	/* of the ATmega328P's timer 2: */
	TCCR2A = 0xb0,
	TCCR2B = 0xb1,
	OCR2A = 0xb3,
	COM2B = 0x30,
	WGM2_LOW = 0x03,
	WGM2_HIGH = 0x08,
	CS2 = 0x07,
};

/* Cycles of the timer's clock from one pulse on OC2B to the next; 0: none in this mode. */
static unsigned pulse_period(uint8_t control_a, uint8_t control_b, uint8_t compare_a)
{
	const bool has_top = control_b & WGM2_HIGH;

	switch (control_a & WGM2_LOW) {
	case 0: return has_top ? 0 : 2 * 256; /* normal: toggles once a round */
	case 1: return 2 * (has_top ? compare_a : 255); /* phase correct: up and down */
	case 2: return has_top ? 0 : 2 * (compare_a + 1u); /* CTC */
	default: return has_top ? compare_a + 1u : 256; /* fast */
	}
}

static bool is_carrier(const avr_t *avr)
{
	static const unsigned prescalers[] = {0, 1, 8, 32, 64, 128, 256, 1024};
	const uint8_t control_a = avr->data[TCCR2A], control_b = avr->data[TCCR2B];
	const uint64_t period =
		(uint64_t)prescalers[control_b & CS2] * pulse_period(control_a, control_b, avr->data[OCR2A]);

	if (!(control_a & COM2B) || period == 0)
		return false;
	return avr->frequency >= (CARRIER_HZ - TOLERANCE_HZ) * period &&
	       avr->frequency <= (CARRIER_HZ + TOLERANCE_HZ) * period;
}

static void note(struct emitter *emitter)
{
	if (emitter->edges_length < EMITTER_EDGES)
		emitter->edges[emitter->edges_length++] =
			(struct carrier_edge){.cycle = emitter->avr->cycle, .on = emitter->carrier};
}

static void update(struct emitter *emitter)
{
	avr_t *avr = emitter->avr;
	const bool plain = emitter->output && !emitter->level && !(avr->data[TCCR2A] & COM2B);
	const bool carrier = emitter->output && is_carrier(avr);

	if (plain != emitter->plain) {
		emitter->plain = plain;
		trace_event(emitter->trace, avr->cycle, "beam %d", plain);
	}
	if (carrier != emitter->carrier) {
		emitter->carrier = carrier;
		trace_event(emitter->trace, avr->cycle, "carrier %d", carrier);
		emitter->last_edge = avr->cycle;
		emitter->in_packet = true;
		note(emitter);
	}
}

/* after the write */
static void timer_written(avr_irq_t *irq, uint32_t value, void *param)
{
	(void)irq;
	(void)value;
	update(param);
}

/* simavr lets the timer write into PORTD, which a real one overrides only while it has the pin. */
static void take_pin_from_timer(avr_t *avr)
{
	avr_unconnect_irq(avr_io_getirq(avr, (uint32_t)AVR_IOCTL_TIMER_GETIRQ('2'), TIMER_IRQ_OUT_COMP + AVR_TIMER_COMPB),
	                  avr_io_getirq(avr, (uint32_t)AVR_IOCTL_IOPORT_GETIRQ('D'), EMITTER_PIN));
}

/* While its pin is low simavr would look at INT1 in each cycle, ten times the work, though nobody enables it. */
static void ignore_interrupt(avr_t *avr)
{
	avr_extint_set_strict_lvl_trig(avr, EMITTER_INT, 0);
}

void emitter_init(struct emitter *emitter, avr_t *avr, struct trace *trace)
{
	*emitter = (struct emitter){.avr = avr, .trace = trace};
	for (avr_io_addr_t address = TCCR2A; address <= OCR2A; address++)
		if (address != TCCR2B + 1) /* the counter itself says nothing */
			avr_irq_register_notify(avr_iomem_getirq(avr, address, NULL, AVR_IOMEM_IRQ_ALL), timer_written, emitter);
	take_pin_from_timer(avr);
	ignore_interrupt(avr);
}

void emitter_reset(struct emitter *emitter)
{
	take_pin_from_timer(emitter->avr);
	ignore_interrupt(emitter->avr);
	update(emitter);
}

void emitter_drive(struct emitter *emitter, uint8_t level, uint8_t output)
{
	emitter->level = level >> EMITTER_PIN & 1;
	emitter->output = output >> EMITTER_PIN & 1;
	update(emitter);
}

void emitter_confirm(struct emitter *emitter)
{
	if (!emitter->in_packet)
		return;
	emitter->in_packet = emitter->avr->cycle - emitter->last_edge < PACKET_DARKNESS;
	note(emitter); /* also what ends the packet */
}

void emitter_clear_edges(struct emitter *emitter)
{
	emitter->edges_length = 0;
}
