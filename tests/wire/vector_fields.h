// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "support/vectors.h"
#include "thermorig/sensors/wire/counters.h"

namespace thermorig::test {

using Fields = std::map<std::string, std::string>;

inline Fields fields_in(const GoldenVector& vector) {
  const auto pairs = fields_of(vector.meaning);
  return {pairs.begin(), pairs.end()};
}

inline std::uint64_t count_in(const Fields& fields, const std::string& name) {
  const auto found = fields.find(name);
  return found == fields.end() ? 0 : std::stoull(found->second);
}

/// "1,-2.5,3" as numbers.
inline std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream in(text);
  for (std::string number; std::getline(in, number, ',');) numbers.push_back(std::stod(number));
  return numbers;
}

/// Counters that a vector does not name must be zero.
inline void expect_counters(const wire::Counters& counters, const Fields& fields,
                            const std::string& messages) {
  EXPECT_EQ(counters.messages, count_in(fields, messages));
  EXPECT_EQ(counters.replies, count_in(fields, "replies"));
  EXPECT_EQ(counters.bad_checksum, count_in(fields, "bad_checksum"));
  EXPECT_EQ(counters.bad_length, count_in(fields, "bad_length"));
  EXPECT_EQ(counters.bad_value, count_in(fields, "bad_value"));
  EXPECT_EQ(counters.bytes_in_damaged, count_in(fields, "damaged"));
  EXPECT_EQ(counters.bytes_skipped, count_in(fields, "skipped"));
  EXPECT_EQ(counters.bytes_pending, count_in(fields, "pending"));
}

}  // namespace thermorig::test
