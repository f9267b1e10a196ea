// The line to the host (rosserial/port.h), with as much room as a test gives it.
#pragma once

#include <string>
#include <vector>

#include "rosserial/port.h"

struct Line {
  // What was written since the last call, as hex; the line is empty again.
  std::string take();

  size_t free = 255;
  std::vector<uint8_t> sent;
};

// Each test begins with a new one.
extern Line line;
