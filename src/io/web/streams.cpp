// SPDX-License-Identifier: MIT
#include "streams.h"

#include <fmt/format.h>

#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <exception>
#include <utility>

#include "answer.h"
#include "request_check.h"

namespace thermorig::web {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using Time = ServerOptions::Time;
using std::chrono_literals::operator""s;

namespace {

constexpr auto closing_time = 5s;  // until the other side has said goodbye as well

/// Without compression: what is sent is small, and takes no memory for each page.
using Stream = websocket::stream<tcp::socket, false>;

}  // namespace

struct Streams::Client {
  Client(tcp::socket connection, std::size_t queue_bytes)
      : stream(std::move(connection)), wake(stream.get_executor()), queue(queue_bytes) {
    wake.expires_at(asio::steady_timer::time_point::max());
  }

  void set_up(const ServerOptions& options, std::string host) {
    deadline = options.now() + options.token_time;
    stream.control_callback([this, &options](websocket::frame_type kind, beast::string_view) {
      if (kind == websocket::frame_type::pong) heard(options.now());
    });
    stream.set_option(
        websocket::stream_base::decorator([host = std::move(host)](websocket::response_type& answer) {
          for (const auto& [name, value] : protecting_fields(host))
            answer.set({name.data(), name.size()}, value);
          answer.set(boost::beast::http::field::server, "");  // else the library puts its name there
        }));
    stream.read_message_max(client_message_bytes_max);
    stream.auto_fragment(false);
    stream.text(true);
  }

  void cut() { close(stream.next_layer()); }

  void heard(Time now) {
    heard_at = now;
    asked_at.reset();
  }

  Stream stream;
  asio::steady_timer wake;  // cancelled whenever there is something to do
  MessageQueue queue;
  std::optional<Time> deadline;  // of its token, or of its goodbye
  std::optional<Time> writing_since;
  Time heard_at;
  std::optional<Time> asked_at;  // by a ping that it has not answered
  bool pinging = false;          // one ping can be on its way at a time
  bool known = false;            // has shown the token
  bool leaving = false;          // closed as soon as the queue is empty
  bool closing = false;          // a stream can be closed once only
  bool gone = false;
};

Streams::Streams(asio::io_context& context, const ServerOptions& options, const std::string& token,
                 std::function<void()> emptied)
    : context_(context), options_(options), token_(token), emptied_(std::move(emptied)) {}

Streams::~Streams() = default;

/// Runs a coroutine; what it throws (memory, a bug) ends that stream and nothing else.
template <typename Done>
void Streams::spawn(asio::awaitable<void> work, Done done) {
  asio::co_spawn(context_, std::move(work), [done = std::move(done)](const std::exception_ptr&) { done(); });
}

std::optional<Refusal> Streams::check(std::size_t bytes_ahead) const {
  if (bytes_ahead > 0) return Refusal{400, "a stream's first message waits for the answer"};
  if (leaving_) return Refusal{503, "the run is over"};
  if (clients_.size() < options_.clients) return std::nullopt;
  return Refusal{503, fmt::format("{} pages are open already; close one of them", options_.clients)};
}

void Streams::open(tcp::socket connection, HttpRequest request, std::string host) {
  const auto client = std::make_shared<Client>(std::move(connection), options_.queue_bytes);
  client->set_up(options_, std::move(host));
  clients_.push_back(client);
  spawn(hold(client, std::move(request)), [this, client] { part_with(client); });
}

void Streams::part_with(const ClientPointer& client) {
  if (client->known && !client->gone) --count_;
  client->gone = true;
  client->wake.cancel();
  clients_.remove(client);
  if (clients_.empty()) emptied_();
}

asio::awaitable<void> Streams::hold(ClientPointer client, HttpRequest request) {
  error_code error;
  co_await client->stream.async_accept(request, into(error));
  if (error) co_return;
  beast::flat_buffer buffer;  // read_message_max bounds it
  co_await client->stream.async_read(buffer, into(error));
  if (error) co_return;
  const std::string_view message(static_cast<const char*>(buffer.data().data()), buffer.size());
  std::uint16_t reason = refused_because(*client, message);
  if (reason == websocket::close_code::none) {
    welcome(client);
    buffer.clear();
    co_await client->stream.async_read(buffer, into(error));
    if (error) co_return;
    reason = websocket::close_code::policy_error;  // a page has nothing to say after its token
  }
  if (std::exchange(client->closing, true)) co_return;
  client->deadline = options_.now() + closing_time;
  co_await client->stream.async_close(reason, into(error));
}

std::uint16_t Streams::refused_because(const Client& client, std::string_view message) const {
  if (!client.stream.got_text()) return websocket::close_code::unknown_data;
  if (!shows_token(message, token_)) return websocket::close_code::policy_error;
  if (leaving_) return websocket::close_code::try_again_later;
  return websocket::close_code::none;
}

void Streams::welcome(const ClientPointer& client) {
  client->known = true;
  client->deadline.reset();
  client->heard(options_.now());
  ++count_;
  // A quarter stays free for what happens while it reads this.
  for (Message& message : backlog_.for_new_client(options_.queue_bytes - options_.queue_bytes / 4))
    client->queue.push(std::move(message));
  spawn(write_queue(client), [client] { client->cut(); });
}

asio::awaitable<void> Streams::write_queue(ClientPointer client) {
  error_code error;
  while (!client->gone) {
    const auto message = client->queue.pop();
    if (message) {
      const auto text = text_of(*message);
      client->writing_since = options_.now();
      co_await client->stream.async_write(asio::buffer(*text), into(error));
      client->writing_since.reset();
      if (error) co_return;
    } else if (client->leaving && !std::exchange(client->closing, true)) {
      co_await client->stream.async_close(websocket::close_code::going_away, into(error));
      co_return;
    } else {
      co_await client->wake.async_wait(into(error));
    }
  }
}

void Streams::send(const std::deque<Message>& messages) {
  if (messages.empty()) return;
  for (const Message& message : messages) {
    backlog_.keep(message);
    for (const ClientPointer& client : clients_)
      if (client->known) client->queue.push(message);
  }
  for (const ClientPointer& client : clients_) client->wake.cancel();
}

void Streams::end_what_is_overdue() {
  const Time now = options_.now();
  for (const ClientPointer& client : clients_) {
    if (is_overdue(*client, now))
      client->cut();
    else
      ask_if_silent(client, now);
  }
}

bool Streams::is_overdue(const Client& client, Time now) const {
  const auto older = [now](const std::optional<Time>& time, auto limit) {
    return time && now - *time >= limit;
  };
  return older(client.deadline, 0s) || older(client.writing_since, options_.stall_time) ||
         older(client.asked_at, options_.silent_time / 2);
}

void Streams::ask_if_silent(const ClientPointer& client, Time now) const {
  if (!client->known || client->closing || client->asked_at || client->pinging) return;
  if (now - client->heard_at < options_.silent_time / 2) return;
  client->stream.async_ping({}, [client](error_code) { client->pinging = false; });  // never from within
  client->asked_at = now;
  client->pinging = true;
}

void Streams::leave() {
  leaving_ = true;
  for (const ClientPointer& client : clients_) {
    client->leaving = true;
    client->wake.cancel();
    if (!client->known) client->cut();
  }
}

void Streams::cut_all() {
  for (const ClientPointer& client : clients_) client->cut();
}

}  // namespace thermorig::web
