/* The flash contents that an AVR ELF file describes. */
#ifndef AVR_ROBOT_FIRMWARE_IMAGE_H
#define AVR_ROBOT_FIRMWARE_IMAGE_H

#include <stdbool.h>
#include <stdint.h>

enum { FLASH_BYTES = 32 * 1024 }; /* ATmega328P */

struct firmware_image {
	uint8_t flash[FLASH_BYTES];
	uint32_t size;  /* bytes used from address 0 */
	uint32_t start; /* where the AVR begins after a reset: at 0, or in the boot loader */
};

/* Read `path` into `image`; false with one line on stderr if it is not a program for an ATmega328P. */
bool firmware_image_read(struct firmware_image *image, const char *path);

#endif
