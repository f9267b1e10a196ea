#include "page.h"

#include <fstream>
#include <sstream>

#include "testing.h"

namespace {

std::vector<std::string> cells(const std::string &line) {
  std::vector<std::string> result;
  std::istringstream parts(line.substr(1));
  std::string part;
  while (std::getline(parts, part, '|')) {
    std::string cell;
    for (char character : part)
      if (character != '`') cell += character;
    const size_t start = cell.find_first_not_of(' ');
    result.push_back(start == std::string::npos ? "" : cell.substr(start, cell.find_last_not_of(' ') - start + 1));
  }
  return result;
}

}  // namespace

std::vector<Row> table(const std::string &heading) {
  std::ifstream page("../docs/protocol-light.md");
  std::vector<Row> rows;
  std::vector<std::string> columns;
  std::string line;
  bool found = false;
  while (std::getline(page, line)) {
    if (line.substr(0, 2) == "##") found = line == "## " + heading;
    if (!found || line.empty() || line[0] != '|') continue;
    const std::vector<std::string> values = cells(line);
    if (columns.empty()) {
      columns = values;
    } else if (values[0].find_first_not_of('-') != std::string::npos) {
      Row row;
      for (size_t i = 0; i < columns.size(); ++i) row[columns[i]] = values.at(i);
      rows.push_back(row);
    }
  }
  CHECK(!rows.empty());
  return rows;
}

std::vector<uint32_t> numbers(const std::string &text) {
  std::istringstream words(text);
  std::vector<uint32_t> result;
  uint32_t number;
  while (words >> number) result.push_back(number);
  return result;
}
