// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "live_run.h"
#include "options.h"
#include "thermorig/rig/recording/order.h"

namespace thermorig::app {

/// The page of a run: it gets the messages, and gives orders.
class LivePage : public MessageSink {
 public:
  /// Throws Error(no_permission) if the port is in use, Error(storage) if its state cannot be kept.
  explicit LivePage(const PageOptions& options);
  ~LivePage() override;

  void take(web::Topic topic, const std::string& message) override;
  const web::Server& server() const;

  /// What the page ordered since the last call.
  std::vector<rig::Order> take_orders();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// What the run itself and its page, if there is one, order.
std::vector<rig::Order> orders_of(LiveRun& run, LivePage* page);

}  // namespace thermorig::app
