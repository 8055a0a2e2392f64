// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "message_queue.h"
#include "thermorig/io/files/descriptor.h"
#include "thermorig/io/web/server.h"

namespace thermorig::web {

/// Sockets that listen on one port of 127.0.0.1 and, where the machine has it, of ::1. No other address.
struct Listeners {
  files::Descriptor v4, v6;
  std::uint16_t port = 0;
};

/// Connections, requests and streams, on a thread of its own. What is allowed is said in request_check.h, who
/// gets which message in message_queue.h and backlog.h.
class PageLoop {
 public:
  PageLoop(const ServerOptions& options, Listeners listeners, std::string token,
           std::function<void(const Order&)> ordered);
  /// Sends what is queued, for 300 ms and the rest of a tick at most.
  ~PageLoop();
  PageLoop(const PageLoop&) = delete;
  PageLoop& operator=(const PageLoop&) = delete;

  /// From any thread.
  void publish(Message message);
  std::size_t clients() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace thermorig::web
