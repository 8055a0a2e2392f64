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
  /// Refuses a key that comes twice, and text that is not plain (text.h).
  explicit Metadata(const std::vector<std::pair<std::string, std::string>>& entries);

  /// Was it written by this program, so that nothing may be missing? Refuses another version of the format.
  bool is_ours() const { return ours_; }

  /// Compares what the file says of the shape with what its graph shows; takes `crop_left` from it.
  void complete(network::Shape& shape) const;
  network::Scaling scaling() const;
  Provenance provenance(const std::string& producer) const;
  /// Compares the weights with their checksum, where there is one.
  void check(const network::Weights& weights) const;

 private:
  std::optional<std::string> find(std::string_view key) const;
  std::string text(std::string_view key) const;
  template <class Number>
  std::optional<Number> number(std::string_view key) const;
  bool flag(std::string_view key) const;
  bool has(std::string_view key) const { return entries_.find(key) != entries_.end(); }
  std::optional<Label> label() const;
  std::optional<network::CameraView> view() const;
  float scale(std::string_view key) const;
  void compare(std::string_view key, int shown) const;
  std::vector<Provenance::Data> data(std::string_view key) const;

  std::map<std::string, std::string, std::less<>> entries_;
  bool ours_ = false;
  bool by_window_ = false;
};

}  // namespace thermorig::model
