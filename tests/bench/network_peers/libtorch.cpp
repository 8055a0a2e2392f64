// SPDX-License-Identifier: MIT
// libtorch's side of network_peers.sh, eager, Nf = 3, Nr = 1, fusion.
//   network_peer_libtorch WEIGHTS serve|once      (WEIGHTS: float32 in the documented order)
#include <torch/torch.h>

#include <cstdio>
#include <fstream>
#include <string_view>
#include <vector>

#include "seeded_values.h"
#include "worker.h"
#include "workload.h"

namespace {

using namespace thermorig;

struct FusionNetwork : torch::nn::Module {
  FusionNetwork() {
    const network::Shape shape;
    const auto convolution = [](int from, int to) {
      return torch::nn::Conv2d(torch::nn::Conv2dOptions(from, to, 5).padding(2));
    };
    conv1 = register_module("conv1", convolution(shape.frames, network::filters1));
    conv2 = register_module("conv2", convolution(network::filters1, network::filters2));
    speed1 = register_module("speed1", torch::nn::Linear(shape.features(), network::hidden1));
    speed2 = register_module("speed2", torch::nn::Linear(network::hidden1, network::hidden2));
    speed3 = register_module("speed3", torch::nn::Linear(network::hidden2, 1));
    gain1 = register_module("gain1", torch::nn::Linear(shape.features(), network::hidden1));
    gain2 = register_module("gain2", torch::nn::Linear(network::hidden1, 1));
  }

  torch::Tensor forward(const torch::Tensor& frames, const torch::Tensor& gyro) {
    const auto maps = torch::relu(conv2(torch::max_pool2d(torch::relu(conv1(frames)), 2)));
    const auto flat = maps.flatten(1);
    const auto thermal = speed3(torch::relu(speed2(torch::relu(speed1(flat)))));
    const auto gain = torch::sigmoid(gain2(torch::relu(gain1(flat))));
    return gain * thermal + (1 - gain) * gyro;
  }

  torch::nn::Conv2d conv1{nullptr}, conv2{nullptr};
  torch::nn::Linear speed1{nullptr}, speed2{nullptr}, speed3{nullptr}, gain1{nullptr}, gain2{nullptr};
};

void read_weights(FusionNetwork& network, const char* path) {
  std::ifstream file(path, std::ios::binary);
  torch::NoGradGuard no_gradient;
  for (auto& parameter : network.parameters())
    file.read(static_cast<char*>(parameter.data_ptr()),
              static_cast<std::streamsize>(parameter.numel() * sizeof(float)));
  if (!file) throw std::runtime_error("too few weights");
}

torch::Tensor berhu(const torch::Tensor& error) {
  const auto size = error.abs();
  const auto c = (0.2 * size.max()).detach();
  return torch::where(size <= c, size, (error * error + c * c) / (2 * c)).mean();
}

struct Data {
  torch::Tensor frames, gyro, label;

  explicit Data(std::size_t samples) {
    const network::Shape shape;
    const interop::SeededBatch owner(shape, bench::seed, 0, samples);
    const network::Batch batch = owner.batch();
    const auto count = static_cast<std::int64_t>(samples);
    frames = torch::empty({count, shape.frames, shape.rows(), shape.columns()});
    gyro = torch::empty({count, 1});
    label = torch::empty({count});
    for (std::size_t i = 0; i < samples; ++i) {
      std::copy_n(batch.frames[i], shape.inputs(), frames.data_ptr<float>() + i * shape.inputs());
      gyro.data_ptr<float>()[i] = batch.gyro[i];
      label.data_ptr<float>()[i] = batch.label[i];
    }
  }
};

}  // namespace

int main(int count, char** arguments) {
  if (count < 3) return 2;
  torch::set_num_threads(1);
  torch::globalContext().setFlushDenormal(true);  // as a training of ours does
  FusionNetwork network, trained;
  read_weights(network, arguments[1]);
  const Data windows(bench::windows);
  std::vector<torch::Tensor> frames, gyro;
  for (std::int64_t i = 0; i < windows.frames.size(0); ++i) {
    frames.push_back(windows.frames.narrow(0, i, 1).contiguous());
    gyro.push_back(windows.gyro.narrow(0, i, 1).contiguous());
  }
  std::size_t next = 0;
  float sum = 0.0F;
  const auto infer = [&] {
    const torch::InferenceMode inference;
    const std::size_t i = next++ % bench::windows;
    sum += network.forward(frames[i], gyro[i]).item<float>();
  };
  if (std::string_view(arguments[2]) != "serve") {
    infer();
    std::printf("%g\n", static_cast<double>(sum));
    return 0;
  }
  read_weights(trained, arguments[1]);
  const Data batch(bench::batch);
  torch::optim::Adam adam(trained.parameters(), torch::optim::AdamOptions(1e-3));
  const auto train = [&] {
    adam.zero_grad();
    const auto loss = berhu(trained.forward(batch.frames, batch.gyro).squeeze(1) - batch.label);
    loss.backward();
    adam.step();
    sum += loss.item<float>();
  };
  bench::serve({{"infer", infer}, {"train", train}});
  return 0;
}
