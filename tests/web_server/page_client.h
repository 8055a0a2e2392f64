// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace thermorig::web {

/// What a server answered.
struct Reply {
  int status = 0;       // 0: nothing came, the connection was closed
  std::string headers;  // all lines, as they came
  std::string body;
  std::string field(const std::string& name) const;  // "" if there is none
};

/// What came on a stream.
struct Arrival {
  enum class Kind : std::uint8_t { text, closed, silence } kind = Kind::silence;
  std::string text;
  int close_code = 0;  // of `closed`; 0: without a close frame
};

/// A client that can misbehave: plain sockets and its own few lines of HTTP and WebSocket. Blocking; gives up
/// after ten seconds unless told otherwise.
class PageClient {
 public:
  explicit PageClient(std::uint16_t port, int receive_buffer_bytes = 0);
  ~PageClient();
  PageClient(PageClient&& other) noexcept;
  PageClient& operator=(PageClient&&) = delete;

  /// Sends what the other side still takes.
  void send(std::string_view bytes);
  Reply reply(bool head = false);
  /// Nothing but the end comes.
  bool is_closed(std::chrono::milliseconds time = std::chrono::seconds(10));

  /// As a browser asks for it.
  Reply get(const std::string& target, const std::string& more_fields = "");
  Reply post(const std::string& target, const std::string& token, const std::string& body);

  /// Asks for a stream; 101 if it is open.
  Reply upgrade();
  Reply upgrade(const std::string& origin);
  void send_frame(int opcode, std::string_view payload, bool masked = true);
  void send_text(std::string_view payload) { send_frame(1, payload); }
  /// The next message; answers pings on the way.
  Arrival receive(std::chrono::milliseconds time = std::chrono::seconds(10));
  /// Waits for the other side's ping, and until it has read the answer; messages on the way are lost.
  bool answer_ping();

  std::string host() const;

 private:
  struct Frame {
    int opcode = 0;
    std::string payload;
  };
  std::optional<Frame> next_frame(std::chrono::steady_clock::time_point until);
  bool await(int opcode);
  bool fill(std::chrono::milliseconds time);
  bool have(std::size_t bytes, std::chrono::steady_clock::time_point until);

  std::uint16_t port_;
  int socket_ = -1;
  std::string received_;
  bool ended_ = false;
};

/// A stream that has shown its token.
PageClient open_stream(std::uint16_t port, const std::string& token, int receive_buffer_bytes = 0);

/// The token of a server's address.
std::string token_of(const std::string& url);

}  // namespace thermorig::web
