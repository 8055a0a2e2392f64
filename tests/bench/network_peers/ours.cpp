// SPDX-License-Identifier: MIT
// Our side of network_peers.sh.  network_peer_ours MODEL.onnx serve|once [fp16]
// `once`: reads the model, estimates one window and ends, to time the start-up.
#include <fmt/format.h>

#include <string_view>

#include "seeded_values.h"
#include "thermorig/core/error.h"
#include "thermorig/network/model/model.h"
#include "thermorig/network/trainer.h"
#include "worker.h"
#include "workload.h"

namespace {

using namespace thermorig;

/// Inference of one seeded window after the other.
class Inference {
 public:
  Inference(const model::Model& model, network::Precision precision)
      : estimator_(model.weights, precision), windows_(model.weights.shape, bench::seed, 0, bench::windows) {}

  void next() {
    const network::Batch batch = windows_.batch();
    const std::size_t i = next_++ % bench::windows;
    sum_ += estimator_.estimate({batch.frames[i], estimator_.shape().inputs()}, batch.gyro[i]).fusion;
  }

  float sum() const { return sum_; }

 private:
  network::Estimator estimator_;
  interop::SeededBatch windows_;
  std::size_t next_ = 0;
  float sum_ = 0.0F;  // so that no call can be left out
};

/// One step of Adam after the other.
class Training {
 public:
  explicit Training(const model::Model& model)
      : trainer_(model.weights, {}, workers_), batch_(model.weights.shape, bench::seed, 0, bench::batch) {}

  void next() { sum_ += trainer_.step(batch_.batch()).loss; }

 private:
  network::CallingThread workers_;
  network::Trainer trainer_;
  interop::SeededBatch batch_;
  double sum_ = 0.0;
};

void serve(const model::Model& model) {
  Inference fp32(model, network::Precision::fp32), fp16(model, network::Precision::fp16_weights);
  Training training(model);
  bench::serve({{"infer", [&] { fp32.next(); }}, {"infer_fp16", [&] { fp16.next(); }}, {"train", [&] {
                                                                                          training.next();
                                                                                        }}});
}

}  // namespace

int main(int count, char** arguments) try {
  if (count < 3) return 2;
  const model::Model model = model::read_model(arguments[1]);
  const bool fp16 = count > 3 && std::string_view(arguments[3]) == "fp16";
  if (std::string_view(arguments[2]) == "serve") {
    serve(model);
    return 0;
  }
  Inference first(model, fp16 ? network::Precision::fp16_weights : network::Precision::fp32);
  first.next();
  fmt::print("{}\n", first.sum());
  return 0;
} catch (const thermorig::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
