// SPDX-License-Identifier: MIT
#include "listeners.h"

#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "thermorig/core/error.h"

namespace thermorig::web {

namespace {

/// More than a flood that the system would make wait for a second and more.
constexpr int waiting_connections = 1024;
/// What the system holds back for a client that does not read: little, so that the queue finds out soon.
constexpr int send_buffer_bytes = 128 * 1024;
constexpr int attempts_for_any_port = 20;

[[noreturn]] void refuse(int error_number, std::uint16_t port) {
  throw Error(ExitCode::failed, std::string("cannot open the page's port: ") + std::strerror(error_number),
              fmt::format("127.0.0.1:{}", port), "choose another one with --page-port (0: any that is free)");
}

struct Opened {
  int socket = -1;
  int error_number = 0;
};

void set_option(int socket, int level, int name, int value) {
  // None of them is vital: a failure shows as a port in use, at worst.
  (void)::setsockopt(socket, level, name, &value, sizeof value);
}

template <typename Address>
Opened listen_on(const Address& address, int family) {
  const int socket = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket < 0) return {-1, errno};
  set_option(socket, SOL_SOCKET, SO_REUSEADDR,
             1);  // or a restart waits a minute for the last one's connections
  set_option(socket, SOL_SOCKET, SO_SNDBUF, send_buffer_bytes);
  if (family == AF_INET6) set_option(socket, IPPROTO_IPV6, IPV6_V6ONLY, 1);
  if (::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      ::listen(socket, waiting_connections) == 0)
    return {socket, 0};
  const int error_number = errno;
  ::close(socket);
  return {-1, error_number};
}

Opened listen_v4(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return listen_on(address, AF_INET);
}

Opened listen_v6(std::uint16_t port) {
  sockaddr_in6 address{};
  address.sin6_family = AF_INET6;
  address.sin6_port = htons(port);
  address.sin6_addr = in6addr_loopback;
  return listen_on(address, AF_INET6);
}

std::uint16_t port_of(int socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) refuse(errno, 0);
  return ntohs(address.sin_port);
}

}  // namespace

std::optional<Listeners> Listeners::open(std::uint16_t port) {
  for (int attempt = 0; attempt < attempts_for_any_port; ++attempt) {
    Listeners listeners;
    const Opened v4 = listen_v4(port);
    listeners.v4_ = v4.socket;
    if (v4.error_number == EADDRINUSE) return std::nullopt;
    if (v4.error_number != 0) refuse(v4.error_number, port);
    listeners.port_ = port_of(v4.socket);
    const Opened v6 = listen_v6(listeners.port_);
    listeners.v6_ = v6.socket;
    // Somebody else's server on ::1 would get what a browser sends to localhost. Any other failure: no ::1
    // here.
    if (v6.error_number != EADDRINUSE) return listeners;
    if (port != 0) return std::nullopt;
  }
  return std::nullopt;
}

Listeners::Listeners(Listeners&& other) noexcept
    : v4_(std::exchange(other.v4_, -1)), v6_(std::exchange(other.v6_, -1)), port_(other.port_) {}

Listeners::~Listeners() {
  for (const int socket : {v4_, v6_})
    if (socket >= 0) ::close(socket);
}

int Listeners::take_v4() {
  return std::exchange(v4_, -1);
}

int Listeners::take_v6() {
  return std::exchange(v6_, -1);
}

}  // namespace thermorig::web
