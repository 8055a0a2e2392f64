// SPDX-License-Identifier: MIT
#include "live_page.h"

#include <fmt/format.h>

#include <cstdio>
#include <mutex>
#include <utility>

#include "output.h"

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

std::string LivePage::url() const {
  return parts_->server.url();
}

const std::string& LivePage::note() const {
  return parts_->server.note();
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

void tell_page(const LivePage& page, bool json) {
  std::FILE* stream = json ? stderr : stdout;
  print(stream, "page  {}\n", page.url());
  if (!web::page_is_built())
    print(stream,
          "note  this program was built without its page: bash app/setup.sh page, then build again\n");
  if (!page.note().empty()) print(stream, "note  {}\n", printable(page.note()));
  std::fflush(stream);
}

}  // namespace thermorig::app
