// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
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
  std::uint16_t port() const;
  std::string url() const;                       // with the token
  const std::filesystem::path& kept_in() const;  // a private file that has the URL; empty: there is none
  const std::string& note() const;               // on a state file that was not used, or empty

  /// What the page ordered since the last call.
  std::vector<rig::Order> take_orders();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// What the run itself and its page, if there is one, order.
std::vector<rig::Order> orders_of(LiveRun& run, LivePage* page);

/// Prints where the page is, and what is to be said of its state file, once: on standard output or, where
/// that is for programs, on standard error. No token goes into a file that others may read: then it is said
/// where the whole address is.
void tell_page(const LivePage& page, bool json);

}  // namespace thermorig::app
