// SPDX-License-Identifier: MIT
#include "thermorig/network/weights.h"

#include <algorithm>
#include <cassert>

namespace thermorig::network {

namespace {

std::size_t size_of(const std::vector<int>& dimensions) {
  std::size_t size = 1;
  for (int dimension : dimensions) size *= static_cast<std::size_t>(dimension);
  return size;
}

Tensor tensor_named(const Shape& shape, std::string_view name) {
  const auto tensors = tensors_of(shape);
  const auto found =
      std::find_if(tensors.begin(), tensors.end(), [&](const Tensor& t) { return t.name == name; });
  assert(found != tensors.end());
  return *found;
}

}  // namespace

std::vector<Tensor> tensors_of(const Shape& shape) {
  std::vector<Tensor> tensors;
  const auto add = [&](std::string_view name, std::vector<int> dimensions) {
    const std::size_t offset = tensors.empty() ? 0 : tensors.back().offset + tensors.back().size;
    const std::size_t size = size_of(dimensions);
    tensors.push_back({name, std::move(dimensions), offset, size});
  };
  add("conv1.weight", {filters1, shape.frames, kernel_size, kernel_size});
  add("conv1.bias", {filters1});
  add("conv2.weight", {filters2, filters1, kernel_size, kernel_size});
  add("conv2.bias", {filters2});
  add("speed1.weight", {hidden1, shape.features()});
  add("speed1.bias", {hidden1});
  add("speed2.weight", {hidden2, hidden1});
  add("speed2.bias", {hidden2});
  add("speed3.weight", {1, hidden2});
  add("speed3.bias", {1});
  if (!shape.fusion) return tensors;
  add("gain1.weight", {hidden1, shape.features()});
  add("gain1.bias", {hidden1});
  add("gain2.weight", {1, hidden1});
  add("gain2.bias", {1});
  return tensors;
}

std::span<float> Weights::tensor(std::string_view name) {
  const Tensor found = tensor_named(shape, name);
  return std::span(values).subspan(found.offset, found.size);
}

std::span<const float> Weights::tensor(std::string_view name) const {
  const Tensor found = tensor_named(shape, name);
  return std::span(values).subspan(found.offset, found.size);
}

}  // namespace thermorig::network
