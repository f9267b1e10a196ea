/* The boot loader that an Intel HEX file describes. */
#ifndef AVR_ROBOT_BOOTLOADER_H
#define AVR_ROBOT_BOOTLOADER_H

#include "firmware_image.h"

#include <stdbool.h>

/* Put the boot loader at `path` behind the firmware in `image`; false with one line on stderr if it is none that fits. */
bool bootloader_read(struct firmware_image *image, const char *path);

#endif
