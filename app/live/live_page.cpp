// SPDX-License-Identifier: MIT
#include "live_page.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <mutex>
#include <utility>

#include "print/output.h"

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

/// Is it a file whose text others can read as well? A terminal, a pipe or a socket leads to whoever began
/// this.
bool is_read_by_others(std::FILE* stream) {
  struct stat info {};
  if (::fstat(::fileno(stream), &info) != 0 || !S_ISREG(info.st_mode)) return false;
  return (info.st_mode & (S_IRGRP | S_IROTH)) != 0 || info.st_uid != ::geteuid();
}

/// Where the address is that the output may not have.
std::string whereabouts(const LivePage& page, bool on_standard_error) {
  if (!page.kept_in().empty())
    return fmt::format("the address with its token stands {}under \"url\" in {}",
                       on_standard_error ? "on standard error, and " : "",
                       printable(page.kept_in().string()));
  if (on_standard_error) return "the address with its token stands on standard error";
  return "the address with its token is kept nowhere; print to a terminal, or to a file that is yours alone";
}

/// The address alone, and where the token is; standard error, if it is another and nobody else's, gets both.
void tell_without_token(const LivePage& page, std::FILE* stream) {
  const bool shown_beside = stream != stderr && !is_read_by_others(stderr);
  if (shown_beside) print(stderr, "page  {}\n", page.url());
  print(stream, "page  http://127.0.0.1:{}/ (others may read this output: {})\n", page.port(),
        whereabouts(page, shown_beside));
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

std::uint16_t LivePage::port() const {
  return parts_->server.port();
}

std::string LivePage::url() const {
  return parts_->server.url();
}

const std::filesystem::path& LivePage::kept_in() const {
  return parts_->server.kept_in();
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
  if (is_read_by_others(stream))
    tell_without_token(page, stream);
  else
    print(stream, "page  {}\n", page.url());
  if (!web::page_is_built())
    print(stream,
          "note  this program was built without its page: bash app/setup.sh page, then cmake --preset "
          "release && cmake --build build\n");
  if (!page.note().empty()) print(stream, "note  {}\n", printable(page.note()));
  std::fflush(stream);
}

}  // namespace thermorig::app
