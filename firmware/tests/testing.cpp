#include "testing.h"

#include <iomanip>
#include <iostream>

namespace testing {

namespace {

struct Test {
  const char *name;
  void (*body)();
};

std::vector<Test> &tests() {
  static std::vector<Test> registered;
  return registered;
}

bool failed;

}  // namespace

Registration::Registration(const char *name, void (*body)()) { tests().push_back(Test{name, body}); }

void report_failure(const char *file, int line, const std::string &what) {
  failed = true;
  std::cout << file << ":" << line << ": " << what << "\n";
}

std::vector<uint8_t> bytes(const std::string &hex) {
  std::istringstream words(hex);
  std::vector<uint8_t> result;
  unsigned byte;
  while (words >> std::hex >> byte) result.push_back(byte);
  return result;
}

std::string hex(const std::vector<uint8_t> &bytes) {
  std::ostringstream text;
  text << std::hex << std::setfill('0');
  for (size_t i = 0; i < bytes.size(); ++i) text << (i > 0 ? " " : "") << std::setw(2) << +bytes[i];
  return text.str();
}

}  // namespace testing

int main() {
  int failures = 0;
  for (const auto &test : testing::tests()) {
    testing::failed = false;
    test.body();
    std::cout << (testing::failed ? "FAILED " : "ok     ") << test.name << std::endl;
    failures += testing::failed;
  }
  std::cout << testing::tests().size() << " tests, " << failures << " failed" << std::endl;
  return failures > 0 || testing::tests().empty() ? 1 : 0;
}
