// SPDX-License-Identifier: MIT
// ONNX Runtime's side of network_peers.sh, Nf = 3, Nr = 1, fusion.
//   network_peer_onnx_runtime LIBRARY MODEL.onnx serve|once
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#include "../../interop/onnx_runtime.h"
#include "seeded_values.h"
#include "worker.h"
#include "workload.h"

int main(int count, char** arguments) {
  using namespace thermorig;
  if (count < 4) return 2;
  const network::Shape shape;
  std::ifstream file(arguments[2], std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
  interop::OnnxRuntime network(arguments[1],
                               {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, shape);
  const interop::SeededBatch owner(shape, bench::seed, 0, bench::windows);
  const network::Batch batch = owner.batch();
  std::size_t next = 0;
  float sum = 0.0F;
  const auto infer = [&] {
    const std::size_t i = next++ % bench::windows;
    std::ranges::copy(std::span(batch.frames[i], shape.inputs()), network.frames().begin());
    network.gyro() = batch.gyro[i];
    sum += network.run().fusion;
  };
  if (std::string_view(arguments[3]) == "serve") {
    bench::serve({{"infer", infer}});
  } else {
    infer();
    fmt::print("{}\n", sum);
  }
  return 0;
}
