/*
 * Intel HEX: a record a line, in hexadecimal digits: ":", number of data bytes, address (2 bytes), type, data, checksum.
 * simavr has a reader of its own, but that one takes what it cannot read for the end of the file.
 */
#include "bootloader.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { COUNT, ADDRESS_HIGH, ADDRESS_LOW, TYPE, DATA }; /* of a record */

enum record_type { RECORD_DATA, RECORD_END, RECORD_SEGMENT, RECORD_START_SEGMENT, RECORD_LINEAR, RECORD_START_LINEAR };

enum {
	RECORD_MAX = DATA + 255 + 1,
	LINE_MAX_BYTES = 1 + 2 * RECORD_MAX + sizeof "\r\n",
};

struct extent {
	uint32_t start, end;
};

/* NULL, or what is wrong with the line. */
static const char *decode(const char *line, uint8_t record[RECORD_MAX])
{
	if (line[0] != ':')
		return "is not an Intel HEX file";
	const size_t digits = strspn(line + 1, "0123456789ABCDEFabcdef");
	const char *rest = line + 1 + digits;
	if (digits % 2 != 0 || digits / 2 < DATA + 1 || digits / 2 > RECORD_MAX || rest[strspn(rest, "\r\n")] != '\0')
		return "is not an Intel HEX file";

	uint8_t sum = 0;
	for (size_t i = 0; i < digits / 2; i++) {
		sscanf(line + 1 + 2 * i, "%2hhx", &record[i]);
		sum += record[i];
	}
	if (digits / 2 != DATA + record[COUNT] + 1u)
		return "is not an Intel HEX file";
	return sum == 0 ? NULL : "has a wrong checksum";
}

static const char *place(struct firmware_image *image, struct extent *extent, uint32_t start, const uint8_t *record)
{
	if (start > FLASH_BYTES || record[COUNT] > FLASH_BYTES - start)
		return "does not fit into the flash of an ATmega328P";
	if (start < image->size)
		return "overlaps the firmware";
	memcpy(image->flash + start, record + DATA, record[COUNT]);
	if (start < extent->start)
		extent->start = start;
	if (start + record[COUNT] > extent->end)
		extent->end = start + record[COUNT];
	return NULL;
}

static const char *load(struct firmware_image *image, struct extent *extent, FILE *file)
{
	char line[LINE_MAX_BYTES];
	uint8_t record[RECORD_MAX];
	uint32_t base = 0;

	while (fgets(line, sizeof line, file)) {
		const char *fault = decode(line, record);
		if (fault)
			return fault;
		switch ((enum record_type)record[TYPE]) {
		case RECORD_DATA:
			fault = place(image, extent, base + (record[ADDRESS_HIGH] << 8) + record[ADDRESS_LOW], record);
			if (fault)
				return fault;
			break;
		case RECORD_END: return NULL;
		case RECORD_SEGMENT:
		case RECORD_LINEAR:
			if (record[COUNT] != 2)
				return "is not an Intel HEX file";
			base = (uint32_t)(record[DATA] << 8 | record[DATA + 1]) << (record[TYPE] == RECORD_LINEAR ? 16 : 4);
			break;
		case RECORD_START_SEGMENT:
		case RECORD_START_LINEAR: break; /* for processors that have such a start */
		default: return "is not an Intel HEX file";
		}
	}
	return ferror(file) ? "cannot be read" : "is cut off";
}

/* The fuses of an ATmega328P let it start at these addresses only. */
static bool is_boot_section(uint32_t start)
{
	return start == 0x7000 || start == 0x7800 || start == 0x7c00 || start == 0x7e00;
}

bool bootloader_read(struct firmware_image *image, const char *path)
{
	struct extent extent = {.start = FLASH_BYTES};
	FILE *file = fopen(path, "re");

	if (!file) {
		fprintf(stderr, "avr_robot: cannot read boot loader %s: %s\n", path, strerror(errno));
		return false;
	}
	const char *fault = load(image, &extent, file);
	fclose(file);
	if (!fault && !is_boot_section(extent.start))
		fault = "does not begin with a boot section (0x7000, 0x7800, 0x7c00 or 0x7e00)";
	if (fault) {
		fprintf(stderr, "avr_robot: boot loader %s %s\n", path, fault);
		return false;
	}
	image->start = extent.start;
	image->size = extent.end;
	return true;
}
