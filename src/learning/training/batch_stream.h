// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

#include "epoch_plan.h"
#include "made_windows.h"
#include "thermorig/network/workers.h"
#include "window_set.h"

namespace thermorig::training {

/// The batches of an epoch, in its order. Windows that are not in memory as the network takes them are
/// prepared by all workers side by side.
class BatchStream {
 public:
  /// What is handed in must live as long as this.
  BatchStream(const WindowSet& set, const EpochPlan& plan, std::size_t windows_a_batch,
              network::Workers& workers);

  /// Adds so many made-up windows to each batch; in all `batches` of them, where the set has no window.
  void add_made(MadeWindows& made, std::size_t windows_a_batch, std::size_t batches);

  std::size_t batches() const;

  /// The next one, unchanged until the one after it is asked for. At most batches() times.
  const BatchBuffer& next();

 private:
  void prepare_share(int worker);

  const WindowSet& set_;
  const EpochPlan& plan_;
  const std::size_t windows_a_batch_;
  network::Workers& workers_;
  BatchBuffer buffer_;
  MadeWindows* made_ = nullptr;
  std::size_t made_a_batch_ = 0, batches_;
  std::size_t begin_ = 0, end_ = 0;  // places in the plan of the batch that is in the buffer
  const std::function<void(int)> share_ = [this](int worker) { prepare_share(worker); };
};

}  // namespace thermorig::training
