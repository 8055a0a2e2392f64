// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>

#include "beast.h"
#include "message_queue.h"
#include "request_check.h"

namespace thermorig::web {

using HttpRequest = boost::beast::http::request<boost::beast::http::string_body>;

/// The open WebSockets of the pages. Lives on the server's thread; only count() may be called from others.
class Streams {
 public:
  /// `emptied` is called whenever one has gone and none is left.
  Streams(boost::asio::io_context& context, const ServerOptions& options, const std::string& token,
          std::function<void()> emptied);
  ~Streams();
  Streams(const Streams&) = delete;
  Streams& operator=(const Streams&) = delete;

  /// May one more be opened now? `bytes_ahead`: that came before the answer to its request.
  std::optional<Refusal> check(std::size_t bytes_ahead) const;
  /// `host`: of the answer's headers.
  void open(boost::asio::ip::tcp::socket connection, HttpRequest request, std::string host);

  void send(const std::deque<Message>& messages);
  /// Cuts those that show no token, take nothing or answer no ping for too long; asks those that are silent.
  void end_what_is_overdue();

  /// Closes each as soon as what waits for it is sent.
  void leave();
  void cut_all();

  bool empty() const { return clients_.empty(); }
  /// Of those that have shown the token.
  std::size_t count() const { return count_; }

 private:
  struct Client;
  using ClientPointer = std::shared_ptr<Client>;

  template <typename Done>
  void spawn(boost::asio::awaitable<void> work, Done done);
  boost::asio::awaitable<void> hold(ClientPointer client, HttpRequest request);
  boost::asio::awaitable<void> write_queue(ClientPointer client);
  std::uint16_t refused_because(const Client& client, std::string_view message) const;
  void welcome(const ClientPointer& client);
  bool is_overdue(const Client& client, ServerOptions::Time now) const;
  void ask_if_silent(const ClientPointer& client, ServerOptions::Time now) const;
  void part_with(const ClientPointer& client);

  boost::asio::io_context& context_;
  const ServerOptions& options_;
  const std::string& token_;
  const std::function<void()> emptied_;
  std::list<ClientPointer> clients_;
  std::atomic<std::size_t> count_ = 0;
  Backlog backlog_;
  bool leaving_ = false;
};

}  // namespace thermorig::web
