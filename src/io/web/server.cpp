// SPDX-License-Identifier: MIT
#include "thermorig/io/web/server.h"

#include <fmt/format.h>

#include <cstdlib>
#include <utility>

#include "assets.h"
#include "listeners.h"
#include "page_loop.h"
#include "state_file.h"
#include "thermorig/core/error.h"
#include "token.h"

namespace thermorig::web {

namespace {

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
    return !Listeners::open(port);
  } catch (const Error&) {
    return false;
  }
}

/// The port of last time; nothing if it is in use or cannot be opened.
std::optional<Listeners> reopen(std::uint16_t port) {
  try {
    return Listeners::open(port);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// The fixed port; else the one of last time, so that a page that is open finds the server again; else any.
Listeners open_listeners(std::uint16_t fixed, const std::optional<PageState>& before) {
  if (fixed == 0 && before)
    if (auto same = reopen(before->port)) return *std::move(same);
  if (auto listeners = Listeners::open(fixed)) return *std::move(listeners);
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
  parts_->port = listeners.port();
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
