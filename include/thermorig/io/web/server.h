// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace thermorig::web {

/// What a message is about, which says what new and slow clients get of it.
enum class Topic : std::uint8_t {
  hello,         // what runs: the newest is kept, and is the first that a client gets
  state,         // sweep, health, disk: only the newest matters
  frame,         // numbers of one frame: the last 512 are kept, and sent to a new client
  image,         // pixels of one frame: only the newest matters
  surroundings,  // pixels all around the shaft: only the newest matters
  event,         // something happened: the last 50 are kept
  ended,         // the run is over: kept
};

enum class OrderKind : std::uint8_t { stop, mark, start };

/// What the page asks for.
struct Order {
  OrderKind kind = OrderKind::stop;
  std::string note;  // of a mark, at most 200 printable characters
};

/// The bytes of /data/NAME, or nothing: there is no such thing. May throw.
using Data = std::function<std::optional<std::string>(std::string_view name)>;

/// Decision 9 says what is checked, in which order, and what the limits are.
struct ServerOptions {
  using Time = std::chrono::steady_clock::time_point;
  std::uint16_t port = 8650;  // 0: any that is free
  bool control = false;       // may the page start motion?
  Data data;  // of a session that is over, asked on the server's thread: its page then, no stream, no orders
  std::filesystem::path state_file;               // port, token, URL, mode 0600; empty: nothing is kept
  bool new_token = false;                         // a new one even if the state file has one
  std::size_t clients = 8;                        // open streams at a time
  std::size_t queue_bytes = 1U << 20U;            // of one client
  std::size_t marks = 10;                         // that may be set at once, by all pages together
  std::chrono::milliseconds mark_period{1'000};   // then one more in this time
  std::chrono::milliseconds header_time{10'000};  // until a request's headers are there; again for its body
  std::chrono::milliseconds token_time{5'000};    // until a stream has sent its token
  std::chrono::milliseconds stall_time{10'000};   // until a stream that takes nothing is closed
  std::chrono::milliseconds silent_time{20'000};  // until a stream is closed that answers no ping
  std::function<Time()> now = std::chrono::steady_clock::now;  // of these limits; for the server's thread
};

/// `$XDG_STATE_HOME/thermorig/page.json` or `~/.local/state/thermorig/page.json`; empty if neither is known.
std::filesystem::path default_state_file();

/// Whether the page was built into this program; else the server has its messages alone, and "/" says so.
bool page_is_built();

/// Serves the page and the messages on loopback (127.0.0.1 and ::1) from a thread of its own. Whatever its
/// clients do costs the caller nothing but the copy of a message.
class Server {
 public:
  /// `ordered` is called on the server's thread. Throws Error(no_permission) if the port is in use, with what
  /// to try, Error(storage) if the state file cannot be written.
  Server(const ServerOptions& options, std::function<void(const Order&)> ordered);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;
  std::string url() const;  // with the token in its fragment

  /// The state file, which has the same address as `url`; empty if it is kept nowhere.
  const std::filesystem::path& kept_in() const;

  /// A sentence for the user on a state file that was not used (others can read it, another server runs); or
  /// empty.
  const std::string& note() const;

  /// Sends a JSON text to every client that has shown its token. From any thread; never blocks.
  void publish(Topic topic, std::string message);

  std::size_t clients() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace thermorig::web
