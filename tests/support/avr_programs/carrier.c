/*
 * Shows what a virtual robot's hardware does. Every 40 ms it says on the UART, at 57600 baud, what the ADC has read against
 * AVCC: the 1.1 V reference and A0. Then timer 2 gets the pin for two marks with a space of 0.6 ms between them.
 *
 * To define: CONTROL_A (with its COM2B bits), CONTROL_B and COMPARE_A, the timer's registers; OUTPUT, whether PD3 is one.
 */
#define F_CPU 16000000UL
#include <avr/io.h>
#include <stdio.h>
#include <util/delay.h>

static unsigned reading(uint8_t channel)
{
	ADMUX = (1 << REFS0) | channel;
	ADCSRA = (1 << ADEN) | (1 << ADSC) | 7;
	while (ADCSRA & (1 << ADSC))
		;
	return ADC;
}

static void say(const char *text)
{
	for (; *text; text++) {
		while (!(UCSR0A & (1 << UDRE0)))
			;
		UDR0 = *text;
	}
}

static void mark(void)
{
	TCCR2A = CONTROL_A;
	_delay_us(1200);
	TCCR2A = CONTROL_A & ~0x30;
}

int main(void)
{
	char text[32];

	UBRR0 = 16;
	UCSR0B = 1 << TXEN0;
	snprintf(text, sizeof text, "%u %u\n", reading(0x0e), reading(0));
	PORTD = 1 << PD3;
	DDRD = OUTPUT << PD3;
	OCR2A = COMPARE_A;
	OCR2B = COMPARE_A / 2;
	TCCR2B = CONTROL_B;
	for (;;) {
		say(text);
		_delay_ms(40);
		mark();
		_delay_us(600);
		mark();
	}
}
