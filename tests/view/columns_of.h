// SPDX-License-Identifier: MIT
#pragma once

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace thermorig::view {

/// The columns of a session as a page reads them: by the names and types that the facts tell.
class ReadColumns {
 public:
  ReadColumns(const nlohmann::json& facts, const std::string& bytes) : bytes_(bytes) {
    static const std::map<std::string, std::size_t> sizes{
        {"f64", 8}, {"f32", 4}, {"u32", 4}, {"u16", 2}, {"u8", 1}};
    std::size_t row_bytes = 0;
    for (const auto& column : facts.at("columns")) row_bytes += sizes.at(column.at("type"));
    rows_ = bytes.size() / row_bytes;
    if (rows_ * row_bytes != bytes.size()) throw std::runtime_error("the rows are not as long as they say");
    std::size_t begin = 0;
    for (const auto& column : facts.at("columns")) {
      begins_[column.at("name")] = begin;
      begin += rows_ * sizes.at(column.at("type"));
    }
  }

  std::size_t rows() const { return rows_; }
  bool has(const std::string& name) const { return begins_.contains(name); }

  template <typename Value>
  Value at(const std::string& name, std::size_t row) const {
    char parts[sizeof(Value)];
    for (std::size_t i = 0; i < sizeof(Value); ++i) parts[i] = bytes_.at(begins_.at(name) + i * rows_ + row);
    Value value;
    std::memcpy(&value, parts, sizeof value);
    return value;
  }

 private:
  std::string bytes_;
  std::size_t rows_ = 0;
  std::map<std::string, std::size_t> begins_;
};

}  // namespace thermorig::view
