// SPDX-License-Identifier: MIT
#include "thermorig/io/web/server.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "assets.h"
#include "page_loop.h"
#include "request_check.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/descriptor.h"
#include "thermorig/io/files/whole_file.h"

namespace thermorig::web {

namespace {

// ---- the port --------------------------------------------------------------------------------------------

/// More than a flood that the system would make wait for a second and more.
constexpr int waiting_connections = 1024;
/// What the system holds back for a client that does not read: little, so that the queue finds out soon.
constexpr int send_buffer_bytes = 128 * 1024;
constexpr int attempts_for_any_port = 20;

void set_option(int socket, int level, int name, int value) {
  // None of them is vital: a failure shows as a port in use, at worst.
  (void)::setsockopt(socket, level, name, &value, sizeof value);
}

/// None: errno says why.
files::Descriptor listen_on(int family, std::uint16_t port) {
  files::Descriptor socket(::socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket) return {};
  // Or a restart waits a minute for the last one's connections.
  set_option(socket.get(), SOL_SOCKET, SO_REUSEADDR, 1);
  set_option(socket.get(), SOL_SOCKET, SO_SNDBUF, send_buffer_bytes);
  if (family == AF_INET6) set_option(socket.get(), IPPROTO_IPV6, IPV6_V6ONLY, 1);
  const sockaddr_in v4{AF_INET, htons(port), {htonl(INADDR_LOOPBACK)}, {}};
  const sockaddr_in6 v6{AF_INET6, htons(port), 0, in6addr_loopback, 0};
  const int bound = family == AF_INET6
                        ? ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&v6), sizeof v6)
                        : ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&v4), sizeof v4);
  if (bound != 0 || ::listen(socket.get(), waiting_connections) != 0) {
    const int error_number = errno;
    socket = {};
    errno = error_number;
  }
  return socket;
}

std::uint16_t port_of(int socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  return ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0 ? ntohs(address.sin_port)
                                                                                  : 0;
}

/// Port 0: any that is free. Nothing if the port is in use; throws Error(failed) for everything else.
std::optional<Listeners> listen_at(std::uint16_t port) {
  for (int attempt = 0; attempt < attempts_for_any_port; ++attempt) {
    Listeners listeners{listen_on(AF_INET, port), {}, port};
    if (!listeners.v4 && errno == EADDRINUSE) return std::nullopt;
    if (listeners.v4) listeners.port = port_of(listeners.v4.get());
    if (listeners.port == 0 || !listeners.v4)
      throw Error(ExitCode::failed, std::string("cannot open the page's port: ") + std::strerror(errno),
                  fmt::format("127.0.0.1:{}", port),
                  "choose another one with --page-port (0: any that is free)");
    listeners.v6 = listen_on(AF_INET6, listeners.port);
    // Somebody else's server on ::1 would get what a browser sends to localhost. Any other failure: no ::1
    // here.
    if (listeners.v6 || errno != EADDRINUSE) return listeners;
    if (port != 0) return std::nullopt;
  }
  return std::nullopt;
}

// ---- the state file --------------------------------------------------------------------------------------

/// What outlives a server, so that the next one is found by a page that is open.
struct PageState {
  std::uint16_t port = 0;
  std::string token;
};

/// The address that opens the page: who has it has the token.
std::string url_of(const PageState& state) {
  return fmt::format("http://127.0.0.1:{}/#t={}", state.port, state.token);
}

struct FoundState {
  std::optional<PageState> state;
  std::string refused;  // why a file that is there was not believed; empty: it was, or there is none
};

std::optional<PageState> parse(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("port") || !json.contains("token")) return std::nullopt;
  if (!json["port"].is_number_unsigned() || !json["token"].is_string()) return std::nullopt;
  const auto number = json["port"].get<std::uint64_t>();
  PageState state{static_cast<std::uint16_t>(number), json["token"].get<std::string>()};
  if (number == 0 || number > 65'535 || !is_token(state.token)) return std::nullopt;
  return state;
}

FoundState read_state(const std::filesystem::path& path) {
  const files::Descriptor file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (!file && (errno == ENOENT || errno == ENOTDIR)) return {};
  struct stat info {};
  if (!file || ::fstat(file.get(), &info) != 0 || !S_ISREG(info.st_mode) || info.st_uid != ::geteuid() ||
      (info.st_mode & 077) != 0)
    return {std::nullopt, "it is no file that this user alone may read and write"};
  std::array<char, 4096> bytes{};
  const ssize_t count = ::read(file.get(), bytes.data(), bytes.size());
  auto state = parse({bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))});
  if (!state) return {std::nullopt, "it is damaged"};
  return {std::move(state), ""};
}

/// With the address that opens the page. Throws Error(storage).
void write_state(const std::filesystem::path& path, const PageState& state) {
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  // A file is written anew with the access that it has, behind its link: not where others may read it.
  if (!read_state(path).refused.empty()) ::unlink(path.c_str());
  const files::Descriptor private_file(::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
  const nlohmann::json json{{"port", state.port}, {"token", state.token}, {"url", url_of(state)}};
  files::write_whole(path, json.dump() + "\n", "the page's state");
}

[[noreturn]] void refuse_port(std::uint16_t port) {
  throw Error(ExitCode::no_permission,
              fmt::format("port {} is in use, perhaps by another live view that still runs", port),
              fmt::format("127.0.0.1:{}", port),
              fmt::format("`ss -ltnp 'sport = :{}'` names the program: stop it, or choose another port with "
                          "--page-port (0: any that is free)",
                          port));
}

/// Can nobody listen there because somebody does already? A port that may not be opened at all (below 1024,
/// or out of another's reach) is no port of ours.
bool in_use(std::uint16_t port) {
  try {
    return !listen_at(port);
  } catch (const Error&) {
    return false;
  }
}

/// The port of last time; nothing if it is in use or cannot be opened.
std::optional<Listeners> reopen(std::uint16_t port) {
  try {
    return listen_at(port);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// The fixed port; else the one of last time, so that a page that is open finds the server again; else any.
Listeners open_listeners(std::uint16_t fixed, const std::optional<PageState>& before) {
  if (fixed == 0 && before)
    if (auto same = reopen(before->port)) return *std::move(same);
  if (auto listeners = listen_at(fixed)) return *std::move(listeners);
  refuse_port(fixed);
}

/// Does the server that wrote this state still run? One that took this server's port cannot.
bool still_runs(const PageState& before, std::uint16_t own_port) {
  return before.port != own_port && in_use(before.port);
}

struct Identity {
  std::string token;
  std::string note;
  bool kept = false;  // in the state file
};

/// The token of last time if it may be used again, and the state file brought up to date.
Identity keep_identity(const ServerOptions& options, std::uint16_t port, const FoundState& found) {
  if (options.state_file.empty()) return {make_token(), ""};
  const std::string file = options.state_file.string();
  if (found.state && still_runs(*found.state, port))
    return {make_token(),
            fmt::format("another live view runs on port {}: the token of this one is not kept in {}",
                        found.state->port, file)};
  Identity own{found.state && !options.new_token ? found.state->token : make_token(), "", true};
  if (!found.refused.empty())
    own.note = fmt::format(
        "{} was not used, as {}: a new token was made, pages that are open have to be opened again", file,
        found.refused);
  write_state(options.state_file, {port, own.token});
  return own;
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

}  // namespace

std::filesystem::path default_state_file() {
  const std::filesystem::path state = variable("XDG_STATE_HOME");
  if (state.is_absolute()) return state / "thermorig" / "page.json";
  const std::filesystem::path home = variable("HOME");
  if (home.is_absolute()) return home / ".local" / "state" / "thermorig" / "page.json";
  return {};
}

bool page_is_built() {
  return has_page;
}

struct Server::Parts {
  std::uint16_t port = 0;
  Identity identity;
  std::filesystem::path kept_in;
  std::unique_ptr<PageLoop> loop;
};

Server::Server(const ServerOptions& options, std::function<void(const Order&)> ordered)
    : parts_(std::make_unique<Parts>()) {
  const FoundState found = options.state_file.empty() ? FoundState{} : read_state(options.state_file);
  Listeners listeners = open_listeners(options.port, found.state);
  parts_->port = listeners.port;
  parts_->identity = keep_identity(options, parts_->port, found);
  if (parts_->identity.kept) parts_->kept_in = options.state_file;
  parts_->loop =
      std::make_unique<PageLoop>(options, std::move(listeners), parts_->identity.token, std::move(ordered));
}

Server::~Server() = default;

std::uint16_t Server::port() const {
  return parts_->port;
}

std::string Server::url() const {
  return url_of({parts_->port, parts_->identity.token});
}

const std::filesystem::path& Server::kept_in() const {
  return parts_->kept_in;
}

const std::string& Server::note() const {
  return parts_->identity.note;
}

void Server::publish(Topic topic, std::string message) {
  parts_->loop->publish({topic, std::make_shared<const std::string>(std::move(message)), {}});
}

std::size_t Server::clients() const {
  return parts_->loop->clients();
}

}  // namespace thermorig::web
