// SPDX-License-Identifier: MIT
#include "page_loop.h"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <exception>
#include <list>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "assets.h"
#include "backlog.h"
#include "beast.h"
#include "client_json.h"
#include "request_check.h"

namespace thermorig::web {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

// g++ 12 destroys a class that is made within a co_await expression twice: what a
// coroutine takes is a variable of the caller's, by reference, or a shared_ptr that the caller has.

namespace {

constexpr std::size_t connections_max = 64;      // that are no streams
constexpr std::size_t unknown_streams_max = 16;  // that have not shown their token yet
constexpr auto answer_time = 10s;
constexpr auto last_words_time = 300ms;
constexpr auto lingering_time = 1s;
constexpr std::size_t lingering_bytes_max = 256 * 1024;
constexpr auto tick_period_max = 1s;
constexpr auto keep_alive_time = 20s;  // a stream is asked after half of it, and lost after all of it

/// A WebSocket without compression: what is sent is small, and nobody else's memory is needed for it.
using Stream = websocket::stream<beast::tcp_stream, false>;
using Request = http::request<http::string_body>;
using Parser = http::request_parser<http::string_body>;
using Answer = http::response<http::string_body>;

auto into(error_code& error) {
  return asio::redirect_error(asio::use_awaitable, error);
}

/// A connection before it becomes a stream, if it does.
struct Connection {
  explicit Connection(tcp::socket socket) : stream(std::move(socket)) {}

  beast::tcp_stream stream;
  bool idle = true;  // waits for a request
};

/// An open stream.
struct Client {
  Client(beast::tcp_stream connection, std::size_t queue_bytes)
      : stream(std::move(connection)),
        token_deadline(stream.get_executor()),
        wake(stream.get_executor()),
        queue(queue_bytes) {
    wake.expires_at(Clock::time_point::max());
  }

  void cut() { stream.next_layer().close(); }

  Stream stream;
  asio::steady_timer token_deadline, wake;  // wake: cancelled whenever there is something to do
  MessageQueue queue;
  std::optional<Clock::time_point> writing_since;
  bool known = false;    // has shown the token
  bool leaving = false;  // closed as soon as the queue is empty
  bool gone = false;
};

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

/// A field that comes once; "" if it comes more often, as then nobody can say which one counts.
std::optional<std::string_view> only(const Request& request, http::field name) {
  const auto count = request.count(name);
  if (count == 0) return std::nullopt;
  return count == 1 ? view(request[name]) : "";
}

RequestHead head_of(const Request& request, bool body) {
  RequestHead head;
  head.method = view(request.method_string());
  head.target = view(request.target());
  head.host = only(request, http::field::host);
  head.origin = only(request, http::field::origin);
  head.content_type = only(request, http::field::content_type);
  head.authorization = only(request, http::field::authorization);
  head.upgrade = websocket::is_upgrade(request);
  head.body = body;
  return head;
}

/// What is wrong with the size or the framing of a request; before anything that it says is looked at.
std::optional<Refusal> check_size(const Request& request) {
  const std::size_t line = request.method_string().size() + request.target().size() + sizeof "  HTTP/1.1\r";
  if (line > request_line_bytes_max) return Refusal{414, "the request's first line is too long"};
  // A length that is told in two ways is how one request is hidden in another.
  if (request.count(http::field::transfer_encoding) > 0)
    return Refusal{411, "a request's body needs a Content-Length; Transfer-Encoding is not taken"};
  return std::nullopt;
}

/// What a client is told whose bytes are no request; nothing if there is nobody to tell.
std::optional<Refusal> refusal_of(error_code error) {
  if (error == http::error::header_limit || error == http::error::buffer_overflow)
    return Refusal{431, "the request's headers are too long"};
  if (error == http::error::body_limit) return Refusal{413, "the request's body is too long"};
  if (error == http::error::end_of_stream || error == http::error::partial_message) return std::nullopt;
  if (error.category() == make_error_code(http::error::bad_method).category())
    return Refusal{400, "this is no HTTP request"};
  return std::nullopt;
}

/// The headers of every answer. `host`: as the client wrote it, once it has been checked.
template <typename Fields>
void set_common_fields(Fields& fields, std::string_view host) {
  // Not every browser takes 'self' for a WebSocket to the same place, so that one is named.
  const std::string streams = host.empty() ? "" : fmt::format("connect-src 'self' ws://{}; ", host);
  fields.set("Content-Security-Policy",
             fmt::format("default-src 'self'; {}frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
                         streams));
  fields.set("X-Content-Type-Options", "nosniff");
  fields.set("Referrer-Policy", "no-referrer");
  fields.set("Cross-Origin-Resource-Policy", "same-origin");
  fields.set("Cross-Origin-Opener-Policy", "same-origin");
  fields.set(http::field::cache_control, "no-store");
}

std::string host_of(const Request& request, const Gate& gate) {
  const bool checked = !check({"GET", "/", only(request, http::field::host)}, gate);
  return checked ? std::string(view(request[http::field::host])) : "";
}

Answer asset_answer(const Asset& file, const Request& request) {
  Answer answer(http::status::ok, 11);
  answer.set(http::field::content_type, beast::string_view(file.type.data(), file.type.size()));
  answer.set(http::field::etag, beast::string_view(file.etag.data(), file.etag.size()));
  answer.set(http::field::vary, "Accept-Encoding");
  const bool zipped = view(request[http::field::accept_encoding]).find("gzip") != std::string_view::npos;
  if (zipped) answer.set(http::field::content_encoding, "gzip");
  answer.body() = zipped ? file.bytes : file.plain;
  return answer;
}

Answer refusal_answer(const Refusal& refusal) {
  Answer answer(static_cast<http::status>(refusal.status), 11);
  answer.set(http::field::content_type, "application/json");
  if (!refusal.allow.empty())
    answer.set(http::field::allow, beast::string_view(refusal.allow.data(), refusal.allow.size()));
  if (refusal.status == 401) answer.set(http::field::www_authenticate, "Bearer");
  if (refusal.status == 426) answer.set(http::field::upgrade, "websocket");
  answer.body() = nlohmann::json{{"error", refusal.sentence}}.dump() + "\n";
  return answer;
}

}  // namespace

struct PageLoop::Impl {
  Impl(const ServerOptions& server_options, Listeners listeners, std::string token,
       std::function<void(const Order&)> order_taker)
      : options(server_options),
        gate{listeners.port(), std::move(token), server_options.control},
        ordered(std::move(order_taker)),
        hand_over(server_options.queue_bytes) {
    acceptors.emplace_back(context, tcp::v4(), listeners.take_v4());
    if (const int v6 = listeners.take_v6(); v6 >= 0) acceptors.emplace_back(context, tcp::v6(), v6);
    for (tcp::acceptor& acceptor : acceptors) spawn(accept(acceptor), [] {});
    wait_for_tick();
  }

  /// Runs a coroutine; what it throws (memory, a bug) ends that connection and nothing else.
  template <typename Done>
  void spawn(asio::awaitable<void> work, Done done) {
    asio::co_spawn(context, std::move(work), [done = std::move(done)](std::exception_ptr) { done(); });
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
    if (leaving) return;
    if (connections.size() >= connections_max) evict_connection();
    error_code no_matter;
    socket.set_option(tcp::no_delay(true), no_matter);
    const auto connection = std::make_shared<Connection>(std::move(socket));
    connections.push_back(connection);
    spawn(serve(connection), [this, connection] { forget(connection); });
  }

  /// The one that has said nothing for longest makes room, so that silent ones keep nobody out.
  void evict_connection() {
    auto oldest =
        std::find_if(connections.begin(), connections.end(), [](const auto& other) { return other->idle; });
    if (oldest == connections.end()) oldest = connections.begin();
    (*oldest)->stream.close();
    connections.erase(oldest);
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
    connection->stream.expires_after(options.header_time);
    co_await http::async_read_header(connection->stream, buffer, parser, into(error));
    connection->idle = false;
    if (error) {
      const Request unknown;
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
    const Route where = *route(target);
    if (where == Route::order) co_return co_await take_order(*connection, parser, buffer);
    if (where == Route::asset) {
      Answer answer = asset_answer(*asset(target), parser.get());
      co_return co_await send(*connection, parser.get(), answer);
    }
    if (const auto full = check_stream(buffer.size()))
      co_await refuse(*connection, parser.get(), *full);
    else
      open_stream(connection, parser.release());
    co_return false;
  }

  /// Whether the connection stays open.
  asio::awaitable<bool> send(Connection& connection, const Request& request, Answer& answer) {
    const bool stays = !leaving && request.keep_alive() && answer.result_int() < 400;
    set_common_fields(answer, host_of(request, gate));
    answer.keep_alive(stays);
    if (answer.result() != http::status::no_content) answer.content_length(answer.body().size());
    if (request.method() == http::verb::head) answer.body().clear();
    error_code error;
    connection.stream.expires_after(answer_time);
    co_await http::async_write(connection.stream, answer, into(error));
    co_return stays && !error;
  }

  asio::awaitable<void> refuse(Connection& connection, const Request& request, const Refusal& refusal) {
    Answer answer = refusal_answer(refusal);
    co_await send(connection, request, answer);
    // Closing while bytes are unread would reset the connection, and the client might never see the answer.
    error_code error;
    connection.stream.socket().shutdown(tcp::socket::shutdown_send, error);
    std::array<char, 4096> unread{};
    connection.stream.expires_after(lingering_time);
    for (std::size_t bytes = 0; !error && bytes < lingering_bytes_max;)
      bytes += co_await connection.stream.async_read_some(asio::buffer(unread), into(error));
    connection.stream.close();
  }

  asio::awaitable<bool> take_order(Connection& connection, Parser& parser, beast::flat_buffer& buffer) {
    error_code error;
    connection.stream.expires_after(options.header_time);
    co_await http::async_read(connection.stream, buffer, parser, into(error));
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
    Answer done(http::status::no_content, 11);
    co_return co_await send(connection, parser.get(), done);
  }

  std::optional<Refusal> carry_out(const Request& request) {
    const auto order = parse_order(order_kind(view(request.target())), request.body());
    if (const auto* refusal = std::get_if<Refusal>(&order)) return *refusal;
    if (leaving) return Refusal{503, "the run is over"};
    try {
      if (ordered) ordered(std::get<Order>(order));
    } catch (const std::exception&) {
      return Refusal{500, "the program could not take this order"};
    }
    return std::nullopt;
  }

  // --- streams -----------------------------------------------------------------------------------------

  void open_stream(const std::shared_ptr<Connection>& connection, Request request) {
    evict_unknown_streams();
    const auto client = std::make_shared<Client>(std::move(connection->stream), options.queue_bytes);
    connections.remove(connection);
    clients.push_back(client);
    spawn(hold_stream(client, std::move(request)), [this, client] { part_with(client); });
  }

  /// May one more stream be opened now? `bytes_ahead`: that came before the answer.
  std::optional<Refusal> check_stream(std::size_t bytes_ahead) const {
    if (bytes_ahead > 0) return Refusal{400, "a stream's first message waits for the answer"};
    if (leaving) return Refusal{503, "the run is over"};
    if (client_count < options.clients) return std::nullopt;
    return Refusal{503, fmt::format("{} pages are open already; close one of them", options.clients)};
  }

  /// Streams that show no token keep nobody out, as connections that say nothing do not.
  void evict_unknown_streams() {
    const auto unknown = [](const auto& client) { return !client->known; };
    if (std::count_if(clients.begin(), clients.end(), unknown) <
        static_cast<std::ptrdiff_t>(unknown_streams_max))
      return;
    const auto oldest = std::find_if(clients.begin(), clients.end(), unknown);
    (*oldest)->cut();
    clients.erase(oldest);
  }

  void part_with(const std::shared_ptr<Client>& client) {
    if (client->known && !client->gone) --client_count;
    client->gone = true;
    client->token_deadline.cancel();
    client->wake.cancel();
    clients.remove(client);
    stop_if_done();
  }

  asio::awaitable<void> hold_stream(std::shared_ptr<Client> client, Request request) {
    set_up(*client, host_of(request, gate));
    wait_for_token(client);
    error_code error;
    co_await client->stream.async_accept(request, into(error));
    if (error) co_return;
    beast::flat_buffer buffer;  // read_message_max bounds it
    co_await client->stream.async_read(buffer, into(error));
    if (error) co_return;
    const std::string_view message(static_cast<const char*>(buffer.data().data()), buffer.size());
    const auto reason = refused_because(*client, message);
    if (reason == websocket::close_code::none) {
      welcome(client);
      buffer.clear();
      co_await client->stream.async_read(buffer, into(error));  // a page has nothing to say after its token
      if (error) co_return;
    }
    co_await client->stream.async_close(
        reason == websocket::close_code::none ? websocket::close_code::policy_error : reason, into(error));
  }

  void set_up(Client& client, std::string host) {
    client.stream.next_layer().expires_never();  // the stream has time limits of its own
    websocket::stream_base::timeout limits{};
    limits.handshake_timeout = options.token_time;
    limits.idle_timeout = keep_alive_time;
    limits.keep_alive_pings = true;
    client.stream.set_option(limits);
    client.stream.set_option(websocket::stream_base::decorator(
        [host = std::move(host)](websocket::response_type& answer) { set_common_fields(answer, host); }));
    client.stream.read_message_max(client_message_bytes_max);
    client.stream.auto_fragment(false);
    client.stream.text(true);
  }

  void wait_for_token(const std::shared_ptr<Client>& client) {
    client->token_deadline.expires_after(options.token_time);
    client->token_deadline.async_wait([client](error_code error) {
      if (!error && !client->known) client->cut();
    });
  }

  websocket::close_code refused_because(const Client& client, std::string_view message) const {
    if (!client.stream.got_text()) return websocket::close_code::unknown_data;
    if (!shows_token(message, gate.token)) return websocket::close_code::policy_error;
    // It has waited for its turn while others came in.
    if (client_count >= options.clients || leaving) return websocket::close_code::try_again_later;
    return websocket::close_code::none;
  }

  void welcome(const std::shared_ptr<Client>& client) {
    client->known = true;
    client->token_deadline.cancel();
    ++client_count;
    // A quarter stays free for what happens while it reads this.
    for (Message& message : backlog.for_new_client(options.queue_bytes - options.queue_bytes / 4))
      client->queue.push(std::move(message));
    spawn(write_queue(client), [client] { client->cut(); });
  }

  asio::awaitable<void> write_queue(std::shared_ptr<Client> client) {
    error_code error;
    while (!client->gone) {
      const auto message = client->queue.pop();
      if (message) {
        const auto text = text_of(*message);
        client->writing_since = Clock::now();
        co_await client->stream.async_write(asio::buffer(*text), into(error));
        client->writing_since.reset();
        if (error) co_return;
      } else if (client->leaving) {
        co_await client->stream.async_close(websocket::close_code::going_away, into(error));
        co_return;
      } else {
        co_await client->wake.async_wait(into(error));
      }
    }
  }

  void wait_for_tick() {
    tick.expires_after(std::min<Clock::duration>(tick_period_max, options.stall_time / 4));
    tick.async_wait([this](error_code error) {
      if (error || leaving) return;
      for (const auto& client : clients)
        if (client->writing_since && Clock::now() - *client->writing_since > options.stall_time)
          client->cut();
      wait_for_tick();
    });
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
    for (const Message& message : messages) {
      backlog.keep(message);
      for (const auto& client : clients)
        if (client->known) client->queue.push(message);
    }
    for (const auto& client : clients) client->wake.cancel();
  }

  // --- the end -----------------------------------------------------------------------------------------

  void leave() {
    distribute();
    leaving = true;
    tick.cancel();
    error_code no_matter;
    for (tcp::acceptor& acceptor : acceptors) acceptor.close(no_matter);
    for (const auto& connection : connections)
      if (connection->idle) connection->stream.close();
    for (const auto& client : clients) {
      client->leaving = true;
      client->wake.cancel();
      if (!client->known) client->cut();
    }
    grace.expires_after(last_words_time);
    grace.async_wait([this](error_code) { context.stop(); });
    stop_if_done();
  }

  void stop_if_done() {
    if (leaving && clients.empty() && connections.empty()) context.stop();
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
    for (const auto& connection : connections) connection->stream.close();
    for (const auto& client : clients) client->cut();
    grace.cancel();
    do context.restart();
    while (context.poll() > 0);
  }

  asio::io_context context{1};
  const ServerOptions options;
  const Gate gate;
  const std::function<void(const Order&)> ordered;
  std::list<tcp::acceptor> acceptors;
  asio::steady_timer tick{context}, grace{context};
  std::list<std::shared_ptr<Connection>> connections;
  std::list<std::shared_ptr<Client>> clients;
  std::atomic<std::size_t> client_count = 0;  // of those that have shown the token
  Backlog backlog;
  bool leaving = false;

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
  return impl_->client_count;
}

}  // namespace thermorig::web
