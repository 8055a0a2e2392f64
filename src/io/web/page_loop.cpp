// SPDX-License-Identifier: MIT
#include "page_loop.h"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <list>
#include <mutex>
#include <thread>
#include <variant>

#include "answer.h"
#include "assets.h"
#include "beast.h"
#include "request_check.h"
#include "streams.h"

namespace thermorig::web {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using Time = ServerOptions::Time;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

namespace {

constexpr std::size_t connections_max = 64;  // that are no streams
constexpr auto answer_time = 10s;
constexpr auto last_words_time = 300ms;
constexpr auto lingering_time = 1s;
constexpr std::size_t lingering_bytes_max = 256 * 1024;
constexpr auto tick_period = 100ms;

using Parser = http::request_parser<http::string_body>;
using HttpAnswer = http::response<http::string_body>;

/// A connection before it becomes a stream, if it does.
struct Connection {
  Connection(tcp::socket opened, Time first_deadline) : socket(std::move(opened)), deadline(first_deadline) {}

  tcp::socket socket;
  bool idle = true;  // waits for a request
  Time deadline;     // of what it is doing
};

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

/// A field that comes once; "" if it comes more often, as then nobody can say which one counts.
std::optional<std::string_view> only(const HttpRequest& request, http::field name) {
  const auto count = request.count(name);
  if (count == 0) return std::nullopt;
  return count == 1 ? view(request[name]) : "";
}

/// A WebSocket that the handshake accepts, so that every refusal is one of ours: the version that there is,
/// and a key of 16 bytes in base64.
bool asks_for_stream(const HttpRequest& request) {
  constexpr std::size_t key_size = 24;
  return websocket::is_upgrade(request) && only(request, http::field::sec_websocket_version) == "13" &&
         only(request, http::field::sec_websocket_key).value_or("").size() == key_size;
}

RequestHead head_of(const HttpRequest& request, bool body) {
  RequestHead head;
  head.method = view(request.method_string());
  head.target = view(request.target());
  head.host = only(request, http::field::host);
  head.origin = only(request, http::field::origin);
  head.content_type = only(request, http::field::content_type);
  head.authorization = only(request, http::field::authorization);
  head.upgrade = asks_for_stream(request);
  head.body = body;
  return head;
}

/// What is wrong with the size or the framing of a request; before anything that it says is looked at.
std::optional<Refusal> check_size(const HttpRequest& request) {
  const std::size_t line = request.method_string().size() + request.target().size() + sizeof "  HTTP/1.1\r";
  if (line > request_line_bytes_max) return Refusal{414, "the request's first line is too long"};
  // A length that is told in two ways is how one request is hidden in another.
  if (request.count(http::field::transfer_encoding) > 0)
    return Refusal{411, "a request's body needs a Content-Length; Transfer-Encoding is not taken"};
  const auto length = only(request, http::field::content_length);
  if (length && (length->empty() || length->find_first_not_of("0123456789") != std::string_view::npos))
    return Refusal{400, "a request's length is told once, as a number"};
  return std::nullopt;
}

/// What a client is told whose bytes are no request; nothing if there is nobody to tell.
std::optional<Refusal> refusal_of(error_code error) {
  if (error == http::error::header_limit || error == http::error::buffer_overflow)
    return Refusal{431, "the request's headers are too long"};
  if (error == http::error::body_limit) return Refusal{413, "the request's body is too long"};
  if (error == http::error::end_of_stream || error == http::error::partial_message) return std::nullopt;
  if (error.category() == make_error_code(http::error::bad_method).category())
    return Refusal{400, "this is not an HTTP request"};
  return std::nullopt;
}

std::string host_of(const HttpRequest& request, const Gate& gate) {
  const bool checked = !check({"GET", "/", only(request, http::field::host)}, gate);
  return checked ? std::string(view(request[http::field::host])) : "";
}

HttpAnswer http_answer(Answer answer, std::string_view host) {
  HttpAnswer http(static_cast<http::status>(answer.status), 11);
  for (const auto& fields : {answer.fields, protecting_fields(host)})
    for (const auto& [name, value] : fields) http.set({name.data(), name.size()}, value);
  http.body() = std::move(answer.body);
  return http;
}

}  // namespace

struct PageLoop::Impl {
  Impl(const ServerOptions& server_options, Listeners listeners, std::string token,
       std::function<void(const Order&)> order_taker)
      : options(server_options),
        gate{listeners.port, std::move(token), server_options.control, server_options.data != nullptr},
        ordered(std::move(order_taker)),
        hand_over(server_options.queue_bytes) {
    acceptors.emplace_back(context, tcp::v4(), listeners.v4.release());
    if (listeners.v6) acceptors.emplace_back(context, tcp::v6(), listeners.v6.release());
    for (tcp::acceptor& acceptor : acceptors) spawn(accept(acceptor), [] {});
    wait_for_tick();
  }

  /// Runs a coroutine; what it throws (memory, a bug) ends that connection and nothing else.
  template <typename Done>
  void spawn(asio::awaitable<void> work, Done done) {
    asio::co_spawn(context, std::move(work), [done = std::move(done)](const std::exception_ptr&) { done(); });
  }

  // --- connections -------------------------------------------------------------------------------------

  asio::awaitable<void> accept(tcp::acceptor& acceptor) {
    asio::steady_timer pause(context);
    while (acceptor.is_open()) {
      error_code error;
      tcp::socket socket(context);
      co_await acceptor.async_accept(socket, into(error));
      if (error && acceptor.is_open()) {  // no descriptors left, most likely: some will be free again
        pause.expires_after(100ms);
        co_await pause.async_wait(into(error));
      } else if (!error) {
        admit(std::move(socket));
      }
    }
  }

  void admit(tcp::socket socket) {
    if (leaving || connections.size() >= connections_max) return;  // which closes it
    error_code no_matter;
    socket.set_option(tcp::no_delay(true), no_matter);
    const auto connection =
        std::make_shared<Connection>(std::move(socket), options.now() + options.header_time);
    connections.push_back(connection);
    spawn(serve(connection), [this, connection] { forget(connection); });
  }

  void forget(const std::shared_ptr<Connection>& connection) {
    connections.remove(connection);
    stop_if_done();
  }

  asio::awaitable<void> serve(std::shared_ptr<Connection> connection) {
    beast::flat_buffer buffer(header_bytes_max + body_bytes_max);
    while (co_await serve_one(connection, buffer)) {
    }
  }

  /// One request; false: the connection is done.
  asio::awaitable<bool> serve_one(std::shared_ptr<Connection> connection, beast::flat_buffer& buffer) {
    Parser parser;
    parser.header_limit(header_bytes_max);
    parser.body_limit(body_bytes_max);
    error_code error;
    connection->idle = true;
    connection->deadline = options.now() + options.header_time;
    co_await http::async_read_header(connection->socket, buffer, parser, into(error));
    connection->idle = false;
    if (error) {
      const HttpRequest unknown;
      if (const auto refusal = refusal_of(error)) co_await refuse(*connection, unknown, *refusal);
      co_return false;
    }
    auto refusal = check_size(parser.get());
    if (!refusal) refusal = check(head_of(parser.get(), !parser.is_done()), gate);
    if (refusal) {
      co_await refuse(*connection, parser.get(), *refusal);
      co_return false;
    }
    const auto target = view(parser.get().target());
    const Route where = *route(target, gate);
    if (where == Route::order) co_return co_await take_order(*connection, parser, buffer);
    if (where == Route::asset) {
      Answer answer = file_answer(*file_of(target, gate), view(parser.get()[http::field::accept_encoding]));
      co_return co_await send(*connection, parser.get(), answer);
    }
    if (where == Route::data) co_return co_await send_data(*connection, parser.get());
    if (const auto full = streams.check(buffer.size())) {
      co_await refuse(*connection, parser.get(), *full);
      co_return false;
    }
    std::string host = host_of(parser.get(), gate);
    connections.remove(connection);  // whose socket goes to the stream
    streams.open(std::move(connection->socket), parser.release(), std::move(host));
    co_return false;
  }

  asio::awaitable<bool> send_data(Connection& connection, const HttpRequest& request) {
    std::variant<Answer, Refusal> found = read_data(data_name(view(request.target())));
    if (const auto* refusal = std::get_if<Refusal>(&found)) {
      co_await refuse(connection, request, *refusal);
      co_return false;
    }
    co_return co_await send(connection, request, std::get<Answer>(found));
  }

  std::variant<Answer, Refusal> read_data(std::string_view name) const {
    try {
      std::optional<std::string> bytes = options.data(name);
      if (!bytes) return Refusal{404, "there is nothing here"};
      return Answer{200, {{"Content-Type", "application/octet-stream"}}, *std::move(bytes)};
    } catch (const std::exception&) {
      return Refusal{500, "the program could not read this part of the session"};
    }
  }

  /// Whether the connection stays open.
  asio::awaitable<bool> send(Connection& connection, const HttpRequest& request, Answer& answer) {
    const bool stays = !leaving && request.keep_alive() && answer.status < 400;
    HttpAnswer http = http_answer(std::move(answer), host_of(request, gate));
    http.keep_alive(stays);
    if (http.result() != http::status::no_content) http.content_length(http.body().size());
    if (request.method() == http::verb::head) http.body().clear();
    error_code error;
    connection.deadline = options.now() + answer_time;
    co_await http::async_write(connection.socket, http, into(error));
    co_return stays && !error;
  }

  asio::awaitable<void> refuse(Connection& connection, const HttpRequest& request, const Refusal& refusal) {
    Answer answer = refusal_answer(refusal);
    co_await send(connection, request, answer);
    // Closing while bytes are unread would reset the connection, and the client might never see the answer.
    error_code error;
    connection.socket.shutdown(tcp::socket::shutdown_send, error);
    std::array<char, 4096> unread{};
    connection.deadline = options.now() + lingering_time;
    for (std::size_t bytes = 0; !error && bytes < lingering_bytes_max;)
      bytes += co_await connection.socket.async_read_some(asio::buffer(unread), into(error));
    close(connection.socket);
  }

  asio::awaitable<bool> take_order(Connection& connection, Parser& parser, beast::flat_buffer& buffer) {
    error_code error;
    connection.deadline = options.now() + options.header_time;
    co_await http::async_read(connection.socket, buffer, parser, into(error));
    std::optional<Refusal> refusal;
    if (error) {
      refusal = refusal_of(error);
      if (!refusal) co_return false;
    } else {
      refusal = carry_out(parser.get());
    }
    if (refusal) {
      co_await refuse(connection, parser.get(), *refusal);
      co_return false;
    }
    Answer done;
    co_return co_await send(connection, parser.get(), done);
  }

  std::optional<Refusal> carry_out(const HttpRequest& request) {
    const auto order = parse_order(order_kind(view(request.target())), request.body());
    if (const auto* refusal = std::get_if<Refusal>(&order)) return *refusal;
    if (leaving) return Refusal{503, "the run is over"};
    if (std::get<Order>(order).kind == OrderKind::mark && !take_mark())
      return Refusal{429, fmt::format("no more than {} marks can be set at once, then one in {:g} s",
                                      options.marks, options.mark_period / 1.0s)};
    try {
      if (ordered) ordered(std::get<Order>(order));
    } catch (const std::exception&) {
      return Refusal{500, "the program could not take this order"};
    }
    return std::nullopt;
  }

  /// Some at once, then one a period: each is a record of the journal, which a key that is held down would
  /// fill the disk with.
  bool take_mark() {
    const Time now = options.now(), due = std::max(mark_due, now);
    if (due - now > options.mark_period * (options.marks - 1)) return false;
    mark_due = due + options.mark_period;
    return true;
  }

  // --- time --------------------------------------------------------------------------------------------

  void wait_for_tick() {
    tick.expires_after(tick_period);
    tick.async_wait([this](error_code error) {
      if (error) return;
      wait_for_tick();
      end_what_is_overdue();  // first, for what follows may find no memory
      distribute();           // in case that the memory for publish()'s handler was missing
    });
  }

  void end_what_is_overdue() {
    const Time now = options.now();
    if (leaving && now >= leaving_deadline) context.stop();
    for (const auto& connection : connections)
      if (now >= connection->deadline) close(connection->socket);
    streams.end_what_is_overdue();
  }

  // --- messages ----------------------------------------------------------------------------------------

  /// Hands over what was published since: one handler for however many messages.
  void distribute() {
    std::deque<Message> messages;
    {
      const std::lock_guard lock(hand_over_mutex);
      distribution_waits = false;
      messages = hand_over.take_all();
    }
    streams.send(messages);
  }

  // --- the end -----------------------------------------------------------------------------------------

  void leave() {
    // First what ends this thread whatever happens: distribute() may find no memory.
    leaving = true;
    leaving_deadline = options.now() + last_words_time;
    wait_for_tick();
    error_code no_matter;
    for (tcp::acceptor& acceptor : acceptors) acceptor.close(no_matter);
    for (const auto& connection : connections)
      if (connection->idle) close(connection->socket);
    distribute();
    streams.leave();
    stop_if_done();
  }

  void stop_if_done() {
    if (leaving && streams.empty() && connections.empty()) context.stop();
  }

  /// A page is not worth a recording: what one handler throws ends that handler and no more.
  void run() {
    for (bool done = false; !done;) {
      try {
        context.run();
        done = true;
      } catch (const std::exception&) {
        // No memory, most likely. The next message finds out whether that has passed.
      }
    }
  }

  /// What is left is called back, finds itself closed and ends, so that nothing is destroyed half-way.
  void close_all() {
    for (const auto& connection : connections) close(connection->socket);
    streams.cut_all();
    tick.cancel();
    do context.restart();
    while (context.poll() > 0);
  }

  asio::io_context context{1};
  const ServerOptions options;
  const Gate gate;
  const std::function<void(const Order&)> ordered;
  Time mark_due = Time::min();  // of the next one, if there were one a period
  std::list<tcp::acceptor> acceptors;
  asio::steady_timer tick{context};
  std::list<std::shared_ptr<Connection>> connections;
  Streams streams{context, options, gate.token, [this] { stop_if_done(); }};
  bool leaving = false;
  Time leaving_deadline;

  std::mutex hand_over_mutex;
  MessageQueue hand_over;  // guarded, as the next one is
  bool distribution_waits = false;

  std::thread thread;
};

namespace {

/// Signals are for the threads that expect them: this one starts with all of them blocked.
template <typename Work>
std::thread quiet_thread(Work work) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread(std::move(work));
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

}  // namespace

PageLoop::PageLoop(const ServerOptions& options, Listeners listeners, std::string token,
                   std::function<void(const Order&)> ordered)
    : impl_(std::make_unique<Impl>(options, std::move(listeners), std::move(token), std::move(ordered))) {
  impl_->thread = quiet_thread([impl = impl_.get()] { impl->run(); });
}

PageLoop::~PageLoop() {
  asio::post(impl_->context, [impl = impl_.get()] { impl->leave(); });
  impl_->thread.join();
  impl_->close_all();
}

void PageLoop::publish(Message message) {
  {
    const std::lock_guard lock(impl_->hand_over_mutex);
    impl_->hand_over.push(std::move(message));
    if (std::exchange(impl_->distribution_waits, true)) return;
  }
  asio::post(impl_->context, [impl = impl_.get()] { impl->distribute(); });
}

std::size_t PageLoop::clients() const {
  return impl_->streams.count();
}

}  // namespace thermorig::web
