// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>

#include "epoch_plan.h"
#include "thermorig/network/workers.h"
#include "window_set.h"

namespace thermorig::training {

/// The batches of an epoch, in its order. Frames that are not in memory as the network takes them are read by
/// all workers side by side, and the disk hears of them several batches before they are needed.
class BatchStream {
 public:
  /// What is handed in must live as long as this.
  BatchStream(const WindowSet& set, const EpochPlan& plan, std::size_t windows_a_batch,
              network::Workers& workers);

  std::size_t batches() const;

  /// The next one, unchanged until the one after it is asked for. At most batches() times. Throws as
  /// WindowSet::read().
  const BatchBuffer& next();

 private:
  void announce(std::size_t place) const;
  void read_share(int worker);
  void read();

  const WindowSet& set_;
  const EpochPlan& plan_;
  const std::size_t windows_a_batch_;
  network::Workers& workers_;
  BatchBuffer buffer_;
  std::size_t begin_ = 0, end_ = 0;  // places in the plan of the batch that is in the buffer
  std::mutex mutex_;                 // of the failure
  std::exception_ptr failure_;
  const std::function<void(int)> share_ = [this](int worker) { read_share(worker); };
};

}  // namespace thermorig::training
