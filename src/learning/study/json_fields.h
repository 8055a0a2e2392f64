// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace thermorig::study {

/// One hostile text to JSON: an object, not too long, not nested deeper than a result is. Throws
/// Error(not_a_session).
nlohmann::json parsed(const std::string& text, const std::string& where);

/// Reads the fields of an object in a result file. Everything that is missing, of another type or out of
/// range is refused with Error(not_a_session), by its full name. Numbers may be null, which is NaN.
class Fields {
 public:
  /// `object` must outlive this. `prefix`: name of the object with a dot at its end, empty for the whole
  /// file.
  Fields(const nlohmann::json& object, std::string where, std::string prefix);

  [[noreturn]] void refuse(const std::string& field, const std::string& what) const;

  int integer(const char* field, int low, int high) const;
  std::uint64_t count(const char* field) const;  // at most 2^53
  std::uint64_t seed(const char* field) const;   // any 64 bits
  double number(const char* field) const;
  double number(const char* field, double low, double high) const;  // or unknown
  double magnitude(const char* field) const;                        // at least 0, or unknown
  bool truth(const char* field) const;
  std::string text(const char* field) const;

  std::vector<double> numbers(const char* field) const;
  std::vector<double> magnitudes(const char* field) const;
  std::vector<std::vector<double>> rows(const char* field, std::size_t count) const;
  std::vector<std::string> texts(const char* field) const;
  Fields object(const char* field) const;
  std::vector<Fields> objects(const char* field) const;

  template <std::size_t N>
  std::array<std::uint64_t, N> counts(const char* field) const {
    const nlohmann::json& values = list(field);
    if (values.size() != N) refuse(field, "has another length");
    std::array<std::uint64_t, N> array{};
    for (std::size_t i = 0; i < N; ++i) array[i] = count_of(values[i], field);
    return array;
  }

 private:
  const nlohmann::json& at(const char* field) const;
  const nlohmann::json& list(const char* field) const;
  double within(double number, double low, double high, const char* field) const;
  double number_of(const nlohmann::json& value, const char* field) const;
  std::uint64_t count_of(const nlohmann::json& value, const char* field) const;

  const nlohmann::json* object_;
  std::string where_;
  std::string prefix_;
};

}  // namespace thermorig::study
