// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "thermorig/network/workers.h"

namespace thermorig::training {

/// Threads that share the parts of a training step: the caller and size - 1 others. They wait a moment
/// busily, then sleep, so that a recording on the same machine is not disturbed.
class ThreadPool final : public network::Workers {
 public:
  explicit ThreadPool(int size);
  ~ThreadPool() override;
  int size() const override;
  void run(const std::function<void(int)>& work) override;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace thermorig::training
