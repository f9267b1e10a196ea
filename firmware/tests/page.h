// The tables of ../docs/protocol-light.md: what the firmware, the simulator and the Pi's side have to agree on.
#pragma once

#include <stdint.h>

#include <map>
#include <string>
#include <vector>

typedef std::map<std::string, std::string> Row;

// The rows of the first table below that heading, each a cell's text by its column's name, without backquotes.
std::vector<Row> table(const std::string &heading);

// "2400 600 600" -> {2400, 600, 600}
std::vector<uint32_t> numbers(const std::string &text);
