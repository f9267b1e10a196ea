#include "receiver.h"

#include "emitter.h"

#include <inttypes.h>
#include <string.h>

#include <simavr/avr_ioport.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_cycle_timers.h>
#include <simavr/sim_interrupts.h>
#include <simavr/sim_io.h>

DEFINE_FIFO(avr_int_vector_p, avr_int_pending);

enum {
	SENSOR_PIN = 2,  /* PD2 */
	INT0_VECTOR = 1, /* of the ATmega328P */
	CYCLES_PER_MS = 16000,
	LIGHT_DELAY = 4 * CYCLES_PER_MS,
	PAUSE = 15 * CYCLES_PER_MS,     /* no protocol is dark for so long within a packet */
	LONGEST_MARK = 50 * CYCLES_PER_MS,
	LENGTHENING = CYCLES_PER_MS / 20, /* of a mark, by a demodulator */
	LAMP_HALF = 5 * CYCLES_PER_MS,
};

static avr_cycle_count_t something_is_due(avr_t *avr, avr_cycle_count_t when, void *param);

static void drive_pin(struct receiver *receiver)
{
	/* Without the "external" level simavr takes the pull-up's at every write to the port, even in the dark. */
	avr_ioport_external_t level = {
		.name = 'D',
		.mask = 1u << SENSOR_PIN,
		.value = receiver->light ? 0 : 1u << SENSOR_PIN,
	};
	avr_ioctl(receiver->avr, (uint32_t)AVR_IOCTL_IOPORT_SET_EXTERNAL('D'), &level);
	avr_raise_irq(receiver->pin, !receiver->light);
}

static void update(struct receiver *receiver)
{
	bool light = !receiver->demodulates && (receiver->plain || (receiver->lamp && receiver->lamp_phase));

	for (unsigned source = 0; source < LIGHT_SOURCES; source++)
		light |= receiver->sources[source].on;
	if (light == receiver->light)
		return;
	receiver->light = light;
	trace_event(receiver->trace, receiver->avr->cycle, "light %d", light);
	drive_pin(receiver);
}

/* ---- light whose time is known --------------------------------------------------------------------------------- */

/* When something happens next; 0: nothing. */
static uint64_t next_due(const struct receiver *receiver)
{
	const uint64_t lamp = receiver->lamp ? receiver->lamp_due : 0;

	if (receiver->edges_length == 0)
		return lamp;
	const uint64_t edge = receiver->edges[receiver->edges_length - 1].due;
	return lamp && lamp < edge ? lamp : edge;
}

static void set_timer(struct receiver *receiver)
{
	avr_t *avr = receiver->avr;
	const uint64_t due = next_due(receiver);

	avr_cycle_timer_cancel(avr, something_is_due, receiver);
	if (due)
		avr_cycle_timer_register(avr, due > avr->cycle ? due - avr->cycle : 1, something_is_due, receiver);
}

static avr_cycle_count_t something_is_due(avr_t *avr, avr_cycle_count_t when, void *param)
{
	struct receiver *receiver = param;

	(void)when;
	while (receiver->edges_length > 0 && receiver->edges[receiver->edges_length - 1].due <= avr->cycle) {
		const struct seen_edge edge = receiver->edges[--receiver->edges_length];
		struct light_source *source = &receiver->sources[edge.source];

		source->waiting--;
		source->on = edge.on;
		source->on_since = avr->cycle;
	}
	while (receiver->lamp && receiver->lamp_due <= avr->cycle) {
		receiver->lamp_phase = !receiver->lamp_phase;
		receiver->lamp_due += LAMP_HALF;
	}
	update(receiver);
	return next_due(receiver);
}

static void insert(struct receiver *receiver, struct seen_edge edge)
{
	struct light_source *source = &receiver->sources[edge.source];
	size_t at = receiver->edges_length;

	if (source->waiting == SOURCE_EDGES)
		return; /* nobody can follow it, and the others shall not suffer */
	source->waiting++;
	while (at > 0 && receiver->edges[at - 1].due <= edge.due)
		at--;
	memmove(receiver->edges + at + 1, receiver->edges + at, (receiver->edges_length - at) * sizeof edge);
	receiver->edges[at] = edge;
	receiver->edges_length++;
}

void receiver_carrier(struct receiver *receiver, unsigned number, uint64_t cycle, bool on)
{
	struct light_source *source = &receiver->sources[number];
	const uint64_t now = receiver->avr->cycle;
	uint64_t due = cycle + source->shift;

	if (on == source->told) {
		source->known = cycle;
		return;
	}
	if (!source->heard || cycle < source->edge || (on && cycle - source->edge > PAUSE)) {
		due = now + LIGHT_DELAY;
	} else if (due < now) { /* the rest of the packet is as late as this */
		trace_event(receiver->trace, now, "late %" PRIu64, now - due);
		due = now;
	}
	source->heard = true;
	source->told = on;
	source->edge = source->known = cycle;
	source->shift = due - cycle;
	due += receiver->demodulates && !on ? LENGTHENING : 0;
	source->ready = due > source->ready ? due : source->ready; /* no edge overtakes another */
	insert(receiver, (struct seen_edge){.due = source->ready, .source = number, .on = on});
	set_timer(receiver);
}

static bool has_to_wait(const struct light_source *source, uint64_t cycle)
{
	return source->heard && source->known - source->edge < PACKET_DARKNESS && source->known + source->shift < cycle;
}

bool receiver_has_to_wait(const struct receiver *receiver, uint64_t cycle)
{
	for (unsigned source = 0; source < LIGHT_SOURCES; source++)
		if (has_to_wait(&receiver->sources[source], cycle))
			return true;
	return false;
}

void receiver_give_up(struct receiver *receiver)
{
	for (unsigned source = 0; source < LIGHT_SOURCES; source++)
		if (has_to_wait(&receiver->sources[source], UINT64_MAX))
			receiver->sources[source].heard = false;
}

void receiver_light_lamp(struct receiver *receiver)
{
	receiver->lamp = receiver->lamp_phase = true;
	receiver->lamp_due = receiver->avr->cycle + LAMP_HALF;
	update(receiver);
	set_timer(receiver);
}

void receiver_shine(struct receiver *receiver, bool light)
{
	receiver->plain = light;
	update(receiver);
}

void receiver_darken(struct receiver *receiver)
{
	receiver->edges_length = 0;
	memset(receiver->sources, 0, sizeof receiver->sources);
	receiver->plain = receiver->lamp = false;
	set_timer(receiver);
	update(receiver);
}

/* ---- simavr's interrupt ------------------------------------------------------------------------------------------ */

static bool queued(avr_int_table_t *table, const avr_int_vector_t *vector)
{
	const int length = avr_int_pending_get_read_size(&table->pending);

	for (int i = 0; i < length; i++)
		if (avr_int_pending_read_at(&table->pending, (uint16_t)i) == vector)
			return true;
	return false;
}

/*
 * Two faults of simavr would make the robot miss light. Under a flood of edges INT0 can stay marked as pending though it
 * is not in the queue: deaf for ever. And an edge that comes while INT0 is masked only sets its flag; the real AVR serves
 * it when INT0 is unmasked.
 */
static void revive_interrupt(struct receiver *receiver)
{
	avr_t *avr = receiver->avr;
	avr_int_vector_t *vector = receiver->interrupt;
	const bool latched = avr_regbit_get(avr, vector->raised) && avr_regbit_get(avr, vector->enable);

	if ((vector->pending || latched) && !queued(&avr->interrupts, vector)) {
		avr_clear_interrupt(avr, vector);
		avr_raise_interrupt(avr, vector);
	}
}

/* after the write */
static void interrupt_mask_written(avr_irq_t *irq, uint32_t value, void *param)
{
	(void)irq;
	(void)value;
	revive_interrupt(param);
}

static avr_int_vector_t *find_interrupt(avr_t *avr, int number)
{
	for (int i = 0; i < avr->interrupts.vector_count; i++)
		if (avr->interrupts.vector[i]->vector == number)
			return avr->interrupts.vector[i];
	return NULL;
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

void receiver_init(struct receiver *receiver, avr_t *avr, bool demodulates, struct trace *trace)
{
	*receiver = (struct receiver){.avr = avr, .demodulates = demodulates, .trace = trace};
	receiver->pin = avr_io_getirq(avr, (uint32_t)AVR_IOCTL_IOPORT_GETIRQ('D'), SENSOR_PIN);
	receiver->interrupt = find_interrupt(avr, INT0_VECTOR);
	avr_irq_register_notify(avr_iomem_getirq(avr, receiver->interrupt->enable.reg, NULL, AVR_IOMEM_IRQ_ALL),
	                        interrupt_mask_written, receiver);
	drive_pin(receiver);
}

void receiver_reset(struct receiver *receiver)
{
	receiver->pin->flags |= IRQ_FLAG_INIT; /* the pin's register needs the level, though it has not changed */
	drive_pin(receiver);
	set_timer(receiver); /* a reset of the AVR forgets it */
}

void receiver_keep_going(struct receiver *receiver)
{
	for (struct light_source *source = receiver->sources; source < receiver->sources + LIGHT_SOURCES; source++)
		if (source->on && receiver->avr->cycle - source->on_since > LONGEST_MARK)
			source->on = source->told = false; /* it has gone, or is none that a demodulator would follow */
	update(receiver);
	revive_interrupt(receiver);
}
