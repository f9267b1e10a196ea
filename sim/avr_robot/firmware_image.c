/*
 * Loads the segments by their load address, as a flash programmer does. simavr has a loader of its own, but that one
 * trusts the file: a truncated or foreign ELF ends in a crash instead of a message.
 */
#include "firmware_image.h"

#include <errno.h>
#include <fcntl.h>
#include <gelf.h>
#include <libelf.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* NULL, or what is wrong with the segment. */
static const char *load_segment(struct firmware_image *image, Elf *elf, const GElf_Phdr *segment)
{
	if (segment->p_type != PT_LOAD || segment->p_filesz == 0 || segment->p_paddr >= 0x800000)
		return NULL; /* not in flash: avr-gcc puts fuses and EEPROM above RAM's 0x800000 */
	if (segment->p_paddr > FLASH_BYTES || segment->p_filesz > FLASH_BYTES - segment->p_paddr)
		return "does not fit into the flash of an ATmega328P";
	const Elf_Data *data = elf_getdata_rawchunk(elf, (int64_t)segment->p_offset, segment->p_filesz, ELF_T_BYTE);
	if (!data)
		return "is cut off";
	memcpy(image->flash + segment->p_paddr, data->d_buf, segment->p_filesz);
	const uint32_t end = (uint32_t)(segment->p_paddr + segment->p_filesz);
	if (end > image->size)
		image->size = end;
	return NULL;
}

static const char *load(struct firmware_image *image, Elf *elf)
{
	GElf_Ehdr header;
	size_t segments;

	if (!elf || elf_kind(elf) != ELF_K_ELF || !gelf_getehdr(elf, &header))
		return "is not an ELF file";
	if (header.e_machine != EM_AVR || gelf_getclass(elf) != ELFCLASS32)
		return "is not a program for an AVR";
	if (elf_getphdrnum(elf, &segments) != 0)
		return "has no readable program headers";
	for (size_t i = 0; i < segments; i++) {
		GElf_Phdr segment;
		if (!gelf_getphdr(elf, (int)i, &segment))
			return "has no readable program headers";
		const char *fault = load_segment(image, elf, &segment);
		if (fault)
			return fault;
	}
	return image->size == 0 ? "has no program in it" : NULL;
}

bool firmware_image_read(struct firmware_image *image, const char *path)
{
	const int file = open(path, O_RDONLY | O_CLOEXEC);
	if (file < 0) {
		fprintf(stderr, "avr_robot: cannot read firmware %s: %s\n", path, strerror(errno));
		return false;
	}
	memset(image->flash, 0xff, sizeof image->flash);
	image->size = image->start = 0;
	elf_version(EV_CURRENT);
	Elf *elf = elf_begin(file, ELF_C_READ, NULL);
	const char *fault = load(image, elf);
	elf_end(elf);
	close(file);
	if (fault)
		fprintf(stderr, "avr_robot: firmware %s %s\n", path, fault);
	return !fault;
}
