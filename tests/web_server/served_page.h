// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "page_client.h"
#include "support/hand_clock.h"
#include "thermorig/io/web/server.h"

namespace thermorig::web {

using tests::comes_true;

/// A server on a free port whose time stands still unless a test moves it, and the orders that it took.
class ServedPage : public ::testing::Test {
 protected:
  ServedPage() {
    options_.port = 0;
    options_.now = [this] { return clock_.now(); };
  }

  Server& server() {
    if (!server_) {
      server_.emplace(options_, [this](const Order& order) {
        const std::lock_guard lock(mutex_);
        orders_.push_back(order);
      });
    }
    return *server_;
  }

  std::vector<Order> orders() {
    const std::lock_guard lock(mutex_);
    return orders_;
  }

  PageClient connect() { return PageClient(server().port()); }
  std::string token() { return token_of(server().url()); }
  std::string host() { return "127.0.0.1:" + std::to_string(server().port()); }

  /// A request of these bytes alone, on a connection of its own.
  Reply reply_to(const std::string& request) {
    PageClient client = connect();
    client.send(request);
    return client.reply();
  }

  /// "GET / HTTP/1.1" with this host.
  Reply get_with_host(const std::string& its_host) {
    return reply_to("GET / HTTP/1.1\r\nHost: " + its_host + "\r\n\r\n");
  }

  /// POST /stop with these fields between Host and body.
  Reply stop_with(const std::string& fields, const std::string& body = "{}") {
    return reply_to("POST /stop HTTP/1.1\r\nHost: " + host() + "\r\n" + fields +
                    "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  }

  std::string own_origin() { return "Origin: http://" + host() + "\r\n"; }
  std::string json_type() { return "Content-Type: application/json\r\n"; }
  std::string authorization() { return "Authorization: Bearer " + token() + "\r\n"; }

  tests::HandClock clock_;
  ServerOptions options_;

 private:
  std::mutex mutex_;
  std::vector<Order> orders_;
  std::optional<Server> server_;  // goes first: its thread uses the others
};

}  // namespace thermorig::web
