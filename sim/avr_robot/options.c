#include "options.h"

#include <getopt.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
	"usage: avr_robot --firmware ELF --name NAME (--serial PATH | --tcp [HOST:]PORT) [--bootloader HEX]\n"
	"                 [--arena HOST:PORT] [--receiver plain|coded] [--supply MV] [--a0 MV] [--trace]\n"
	"\n"
	"A robot's Arduino Uno with its motors, infrared emitter and sensor, running the real firmware in real time.\n"
	"\n"
	"  --firmware ELF      program of the ATmega328P\n"
	"  --name NAME         robot's name in the arena: 1 to 32 of letters, digits, _ and -\n"
	"  --serial PATH       the Uno's serial port: a pseudo terminal behind the symlink PATH, removed at exit\n"
	"  --tcp [HOST:]PORT   or the serial port on TCP: one client at a time, the newest wins; HOST is 127.0.0.1 unless\n"
	"                      given (0.0.0.0 = everywhere), port 0 picks a free one\n"
	"  --bootloader HEX    boot loader in Intel HEX, such as optiboot: the AVR starts in it, and avrdude can write\n"
	"                      another program through the serial port; that one stays until avr_robot ends\n"
	"  --arena HOST:PORT   link to the arena that moves the robot and lights its sensor; reconnects for ever\n"
	"  --receiver KIND     plain = a bare phototransistor, which sees any light, a carrier too (default);\n"
	"                      coded = a demodulating receiver, which sees nothing but carriers of 38 kHz\n"
	"  --supply MV         the Uno's supply, 1800 to 5500 mV (default 5000)\n"
	"  --a0 MV             on the pin A0, such as from a battery's divider, up to 5500 mV (default 0: nothing is "
	"there)\n"
	"  --trace             print hardware events on stdout: <monotonic ns> <AVR cycles> <event>\n"
	"  --help              this text\n"
	"\n"
	"Unlike a real Uno, the virtual one does not reset when its serial port is opened, unless it has a boot loader.\n"
	"Then every opening resets it: a real Uno can be spared by clearing HUPCL, but that does not come through here.\n";

__attribute__((noreturn, format(printf, 1, 2))) static void refuse(const char *format, ...)
{
	va_list words;
	va_start(words, format);
	fputs("avr_robot: ", stderr);
	vfprintf(stderr, format, words);
	va_end(words);
	fputs(" (see avr_robot --help)\n", stderr);
	exit(2);
}

/* `text` = [HOST:]PORT or [IPV6]:PORT; a missing host becomes `default_host`, or is refused if that is NULL. */
static struct address parse_address(const char *option, const char *text, const char *default_host)
{
	struct address address = {{0}, {0}};
	const char *colon = strrchr(text, ':');
	const char *port = colon ? colon + 1 : text;
	const char *host = colon ? text : default_host;
	size_t host_length = colon ? (size_t)(colon - text) : default_host ? strlen(default_host) : 0;

	if (host_length >= 2 && host[0] == '[' && host[host_length - 1] == ']') {
		host++;
		host_length -= 2;
	}
	if (host_length == 0 || host_length >= sizeof address.host)
		refuse("%s %s: expected %s", option, text, default_host ? "[HOST:]PORT" : "HOST:PORT");
	const size_t port_length = strlen(port);
	if (port_length == 0 || port_length >= sizeof address.port || strspn(port, "0123456789") != port_length ||
	    strtol(port, NULL, 10) > 65535)
		refuse("%s %s: the port must be a whole number up to 65535", option, text);
	memcpy(address.host, host, host_length);
	memcpy(address.port, port, port_length);
	return address;
}

static uint32_t parse_voltage(const char *option, const char *text, uint32_t lowest)
{
	enum { HIGHEST_MV = 5500, DIGITS = 4 };
	const size_t length = strlen(text);
	const bool is_number = length > 0 && length <= DIGITS && strspn(text, "0123456789") == length;
	const uint32_t millivolts = is_number ? (uint32_t)strtoul(text, NULL, 10) : 0;

	if (!is_number || millivolts < lowest || millivolts > HIGHEST_MV)
		refuse("%s %s: expected %u to %d mV", option, text, (unsigned)lowest, HIGHEST_MV);
	return millivolts;
}

/* Whether it demodulates. */
static bool parse_receiver(const char *text)
{
	if (strcmp(text, "plain") != 0 && strcmp(text, "coded") != 0)
		refuse("--receiver %s: expected plain or coded", text);
	return strcmp(text, "coded") == 0;
}

static void check(const struct options *options)
{
	static const char name_characters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";

	if (!options->firmware)
		refuse("--firmware is missing");
	if (access(options->firmware, R_OK) != 0)
		refuse("no readable firmware at %s; build it with: make -C firmware", options->firmware);
	if (options->bootloader && access(options->bootloader, R_OK) != 0)
		refuse("no readable boot loader at %s; build one with: make -C sim optiboot", options->bootloader);
	if (!options->name)
		refuse("--name is missing");
	const size_t length = strlen(options->name);
	if (length == 0 || length > ROBOT_NAME_MAX || strspn(options->name, name_characters) != length)
		refuse("--name '%s': use 1 to %d of letters, digits, _ and -", options->name, ROBOT_NAME_MAX);
	if (!options->pty_link == !options->tcp)
		refuse("give either --serial or --tcp");
}

struct options options_parse(int argc, char **argv)
{
	static const struct option known[] = {
		{"firmware", required_argument, NULL, 'f'}, {"bootloader", required_argument, NULL, 'b'},
		{"name", required_argument, NULL, 'n'},     {"serial", required_argument, NULL, 's'},
		{"tcp", required_argument, NULL, 't'},      {"arena", required_argument, NULL, 'a'},
		{"receiver", required_argument, NULL, 'r'}, {"supply", required_argument, NULL, 'v'},
		{"a0", required_argument, NULL, '0'},       {"trace", no_argument, NULL, 'T'},
		{"help", no_argument, NULL, 'h'},           {NULL, 0, NULL, 0},
	};
	struct options options = {.board = {.voltages = {.supply = 5000}}};
	int choice;

	opterr = 0; /* our own words, one line */
	while ((choice = getopt_long(argc, argv, ":", known, NULL)) != -1) {
		switch (choice) {
		case 'f': options.firmware = optarg; break;
		case 'b': options.bootloader = optarg; break;
		case 'n': options.name = optarg; break;
		case 's': options.pty_link = optarg; break;
		case 't':
			options.tcp = true;
			options.listen = parse_address("--tcp", optarg, "127.0.0.1");
			break;
		case 'a':
			options.arena = true;
			options.arena_address = parse_address("--arena", optarg, NULL);
			break;
		case 'r': options.board.demodulates = parse_receiver(optarg); break;
		case 'v': options.board.voltages.supply = parse_voltage("--supply", optarg, 1800); break;
		case '0': options.board.voltages.a0 = parse_voltage("--a0", optarg, 0); break;
		case 'T': options.trace = true; break;
		case 'h': fputs(usage, stdout); exit(0);
		case ':': refuse("option %s needs a value", argv[optind - 1]);
		default: refuse("unknown option %s", argv[optind - 1]);
		}
	}
	if (optind < argc)
		refuse("unexpected argument %s", argv[optind]);
	check(&options);
	return options;
}
