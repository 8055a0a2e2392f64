// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

namespace thermorig::network {

/// Who does the parts of a step. The network starts no thread; whoever has some hands them in.
class Workers {
 public:
  virtual ~Workers() = default;
  virtual int size() const = 0;
  /// Calls `work(0)` .. `work(size() - 1)`, each once, possibly at the same time, and returns when all are
  /// done.
  virtual void run(const std::function<void(int)>& work) = 0;
};

/// One worker: the calling thread.
class CallingThread final : public Workers {
 public:
  int size() const override { return 1; }
  void run(const std::function<void(int)>& work) override { work(0); }
};

}  // namespace thermorig::network
