// SPDX-License-Identifier: MIT
#include "page_client.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <utility>

namespace thermorig::web {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::string_view end_of_headers = "\r\n\r\n";
constexpr auto patience = std::chrono::seconds(10);
constexpr int opcode_text = 1, opcode_close = 8, opcode_ping = 9, opcode_pong = 10;

std::chrono::milliseconds left(Clock::time_point until) {
  return std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
}

std::size_t number(std::string_view bytes) {
  std::size_t value = 0;
  for (const char byte : bytes) value = value * 256 + static_cast<unsigned char>(byte);
  return value;
}

}  // namespace

std::string Reply::field(const std::string& name) const {
  const auto at = headers.find("\r\n" + name + ": ");
  if (at == std::string::npos) return "";
  const auto begin = at + name.size() + 4;
  return headers.substr(begin, headers.find("\r\n", begin) - begin);
}

PageClient::PageClient(std::uint16_t port, int receive_buffer_bytes) : port_(port) {
  socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (receive_buffer_bytes > 0)
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer_bytes, sizeof receive_buffer_bytes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ended_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0;
}

PageClient::PageClient(PageClient&& other) noexcept
    : port_(other.port_),
      socket_(std::exchange(other.socket_, -1)),
      received_(std::move(other.received_)),
      ended_(other.ended_) {}

PageClient::~PageClient() {
  if (socket_ >= 0) ::close(socket_);
}

std::string PageClient::host() const {
  return fmt::format("127.0.0.1:{}", port_);
}

void PageClient::send(std::string_view bytes) {
  while (!bytes.empty()) {
    pollfd ready{socket_, POLLOUT, 0};
    if (::poll(&ready, 1, 10'000) <= 0) return;
    const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count < 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

bool PageClient::fill(std::chrono::milliseconds time) {
  pollfd ready{socket_, POLLIN, 0};
  if (ended_ || time.count() <= 0 || ::poll(&ready, 1, static_cast<int>(time.count())) <= 0) return false;
  std::array<char, 16'384> bytes{};
  const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
  if (count <= 0) ended_ = true;
  if (count > 0) received_.append(bytes.data(), static_cast<std::size_t>(count));
  return count > 0;
}

bool PageClient::have(std::size_t bytes, Clock::time_point until) {
  while (received_.size() < bytes)
    if (!fill(left(until))) return false;
  return true;
}

bool PageClient::is_closed(std::chrono::milliseconds time) {
  const auto until = Clock::now() + time;
  while (!ended_ && left(until).count() > 0) fill(left(until));
  return ended_ && received_.empty();
}

Reply PageClient::reply(bool head) {
  const auto until = Clock::now() + patience;
  Reply reply;
  std::size_t end = 0;
  while ((end = received_.find(end_of_headers)) == std::string::npos)
    if (!fill(left(until))) return reply;
  reply.headers = received_.substr(0, end + 2);
  received_.erase(0, end + end_of_headers.size());
  reply.status = std::stoi(reply.headers.substr(reply.headers.find(' ')));
  const std::string length = reply.field("Content-Length");
  if (head || length.empty()) return reply;
  const std::size_t bytes = std::stoul(length);
  if (!have(bytes, until)) return reply;
  reply.body = received_.substr(0, bytes);
  received_.erase(0, bytes);
  return reply;
}

Reply PageClient::get(const std::string& target, const std::string& more_fields) {
  send(fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\n{}\r\n", target, host(), more_fields));
  return reply();
}

Reply PageClient::post(const std::string& target, const std::string& token, const std::string& body) {
  send(
      fmt::format("POST {} HTTP/1.1\r\nHost: {}\r\nOrigin: http://{}\r\nContent-Type: application/json\r\n"
                  "Authorization: Bearer {}\r\nContent-Length: {}\r\n\r\n{}",
                  target, host(), host(), token, body.size(), body));
  return reply();
}

Reply PageClient::upgrade() {
  return upgrade("Origin: http://" + host() + "\r\n");
}

Reply PageClient::upgrade(const std::string& origin) {
  send(
      fmt::format("GET /stream HTTP/1.1\r\nHost: {}\r\n{}Upgrade: websocket\r\nConnection: Upgrade\r\n"
                  "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n",
                  host(), origin));
  return reply();
}

void PageClient::send_frame(int opcode, std::string_view payload, bool masked) {
  std::string frame(1, static_cast<char>(0x80 | opcode));
  const int mask_bit = masked ? 0x80 : 0;
  if (payload.size() < 126) {
    frame += static_cast<char>(mask_bit | static_cast<int>(payload.size()));
  } else {
    frame += static_cast<char>(mask_bit | 126);
    frame += static_cast<char>(payload.size() >> 8U);
    frame += static_cast<char>(payload.size() & 255U);
  }
  constexpr std::string_view mask = "\x12\x34\x56\x78";
  if (masked) frame += mask;
  for (std::size_t i = 0; i < payload.size(); ++i)
    frame += masked ? static_cast<char>(payload[i] ^ mask[i % 4]) : payload[i];
  send(frame);
}

std::optional<PageClient::Frame> PageClient::next_frame(Clock::time_point until) {
  if (!have(2, until)) return std::nullopt;
  std::size_t size = received_[1] & 127, header = 2;
  if (size >= 126) {
    header = size == 126 ? 4 : 10;
    if (!have(header, until)) return std::nullopt;
    size = number(std::string_view(received_).substr(2, header - 2));
  }
  if (!have(header + size, until)) return std::nullopt;
  Frame frame{received_[0] & 15, received_.substr(header, size)};
  received_.erase(0, header + size);
  if (frame.opcode == opcode_ping) send_frame(opcode_pong, frame.payload);
  return frame;
}

Arrival PageClient::receive(std::chrono::milliseconds time) {
  const auto until = Clock::now() + time;
  while (const auto frame = next_frame(until)) {
    if (frame->opcode == opcode_text) return {Arrival::Kind::text, frame->payload, 0};
    if (frame->opcode != opcode_close) continue;
    send_frame(opcode_close, frame->payload);
    return {Arrival::Kind::closed, "", static_cast<int>(number(frame->payload.substr(0, 2)))};
  }
  return {ended_ ? Arrival::Kind::closed : Arrival::Kind::silence, "", 0};
}

bool PageClient::await(int opcode) {
  const auto until = Clock::now() + patience;
  while (const auto frame = next_frame(until))
    if (frame->opcode == opcode) return true;
  return false;
}

bool PageClient::answer_ping() {
  if (!await(opcode_ping)) return false;
  send_frame(opcode_ping, "");  // behind the pong: once this one is answered, that one was read
  return await(opcode_pong);
}

PageClient open_stream(std::uint16_t port, const std::string& token, int receive_buffer_bytes) {
  PageClient client(port, receive_buffer_bytes);
  EXPECT_EQ(client.upgrade().status, 101);
  client.send_text(fmt::format(R"({{"token":"{}"}})", token));
  return client;
}

std::string token_of(const std::string& url) {
  return url.substr(url.find("#t=") + 3);
}

}  // namespace thermorig::web
