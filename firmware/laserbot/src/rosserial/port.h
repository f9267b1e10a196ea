// Where frames go to: the UART, or a test's line. Plain functions and no pointer to an object: a pointer lies in the
// RAM, and one wrong bit of it would make the robot mute.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace rosserial {
namespace port {

// Bytes that can be written now without waiting. A writer checks it for a whole frame first: a frame is sent entirely
// or not at all.
size_t room();
void write(uint8_t byte);

}  // namespace port
}  // namespace rosserial
