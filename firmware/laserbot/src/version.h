// The firmware's version, in its health message.
#pragma once

#include <stdint.h>

constexpr uint8_t VERSION_MAJOR = 2;
constexpr uint8_t VERSION_MINOR = 0;
