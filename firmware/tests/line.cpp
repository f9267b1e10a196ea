#include "line.h"

#include "testing.h"

Line line;

std::string Line::take() {
  const std::string text = testing::hex(sent);
  *this = Line();
  return text;
}

namespace rosserial {
namespace port {

size_t room() { return line.free; }

void write(uint8_t byte) {
  CHECK(line.free > 0);
  --line.free;
  line.sent.push_back(byte);
}

}  // namespace port
}  // namespace rosserial
