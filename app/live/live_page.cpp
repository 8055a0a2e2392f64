// SPDX-License-Identifier: MIT
#include "live_page.h"

#include <mutex>
#include <utility>

namespace thermorig::app {

namespace {

web::ServerOptions server_options(const PageOptions& page) {
  web::ServerOptions options;
  options.port = page.port;
  options.control = page.control;
  options.new_token = page.new_token;
  options.state_file = web::default_state_file();
  return options;
}

rig::Order order_of(const web::Order& order) {
  switch (order.kind) {
    case web::OrderKind::stop:
      return {rig::OrderKind::stop, "the page"};
    case web::OrderKind::mark:
      return {rig::OrderKind::mark, order.note};
    case web::OrderKind::start:
      break;
  }
  return {rig::OrderKind::start, ""};
}

}  // namespace

struct LivePage::Parts {
  explicit Parts(const PageOptions& options)
      : server(server_options(options), [this](const web::Order& order) {
          const std::lock_guard lock(mutex);
          orders.push_back(order_of(order));
        }) {}

  std::mutex mutex;
  std::vector<rig::Order> orders;
  web::Server server;  // last: its thread uses everything above
};

LivePage::LivePage(const PageOptions& options) : parts_(std::make_unique<Parts>(options)) {}

LivePage::~LivePage() = default;

void LivePage::take(web::Topic topic, const std::string& message) {
  parts_->server.publish(topic, message);
}

const web::Server& LivePage::server() const {
  return parts_->server;
}

std::vector<rig::Order> LivePage::take_orders() {
  const std::lock_guard lock(parts_->mutex);
  return std::exchange(parts_->orders, {});
}

std::vector<rig::Order> orders_of(LiveRun& run, LivePage* page) {
  std::vector<rig::Order> orders = run.take_orders();
  if (page == nullptr) return orders;
  for (rig::Order& order : page->take_orders()) orders.push_back(std::move(order));
  return orders;
}

}  // namespace thermorig::app
