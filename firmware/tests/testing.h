// The smallest test framework that does: a TEST registers itself, a failed CHECK names file and line, the test goes on.
#pragma once

#include <stdint.h>

#include <sstream>
#include <string>
#include <vector>

namespace testing {

struct Registration {
  Registration(const char *name, void (*body)());
};

void report_failure(const char *file, int line, const std::string &what);

template <typename Expected, typename Actual>
void check_equal(const char *file, int line, const char *text, const Expected &expected, const Actual &actual) {
  if (expected == actual) return;
  std::ostringstream what;
  what << text << "\n    expected: " << +expected << "\n    actual:   " << +actual;
  report_failure(file, line, what.str());
}

inline void check_equal(const char *file, int line, const char *text, const std::string &expected,
                        const std::string &actual) {
  if (expected == actual) return;
  report_failure(file, line, std::string(text) + "\n    expected: " + expected + "\n    actual:   " + actual);
}

// "ff fe" <-> {0xff, 0xfe}
std::vector<uint8_t> bytes(const std::string &hex);
std::string hex(const std::vector<uint8_t> &bytes);

}  // namespace testing

#define TEST(name)                                               \
  static void name();                                            \
  static testing::Registration registration_##name(#name, name); \
  static void name()

#define CHECK(condition) \
  if (!(condition)) testing::report_failure(__FILE__, __LINE__, #condition)

#define CHECK_EQUAL(expected, actual) testing::check_equal(__FILE__, __LINE__, #actual, expected, actual)
