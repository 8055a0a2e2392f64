// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "thermorig/network/model/model.h"

namespace thermorig::model {

/// What a model file says of itself beside the graph, in the order of the file.
std::vector<std::pair<std::string, std::string>> metadata_of(const Model& model);

/// The same, read back. Every member throws Refusal for text that does not say what it should.
class Metadata {
 public:
  /// Refuses a key that comes twice, text that is not plain (text.h), and another version of the format.
  explicit Metadata(const std::vector<std::pair<std::string, std::string>>& entries);

  network::Shape shape() const;
  network::Scaling scaling() const;
  Provenance provenance(const std::string& producer) const;
  /// Compares the weights with their checksum, unless that is empty.
  void check(const network::Weights& weights) const;

 private:
  const std::string& text(std::string_view key) const;
  template <class Number>
  Number number(std::string_view key) const;
  bool flag(std::string_view key) const;
  std::optional<Label> label() const;
  std::optional<network::CameraView> view() const;
  std::vector<Provenance::Data> data(std::string_view key) const;

  std::map<std::string, std::string, std::less<>> entries_;
  bool by_window_ = false;
};

}  // namespace thermorig::model
