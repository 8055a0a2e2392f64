// SPDX-License-Identifier: MIT
#include "state_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "thermorig/core/error.h"
#include "thermorig/io/files/descriptor.h"
#include "thermorig/io/files/whole_file.h"
#include "token.h"

namespace thermorig::web {

namespace {

/// What this process creates meanwhile is for its user alone. The mask is the whole process's; that another
/// thread's file is private as well for these microseconds does no harm, a token that others read would.
class PrivateFiles {
 public:
  PrivateFiles() : before_(::umask(077)) {}
  ~PrivateFiles() { ::umask(before_); }
  PrivateFiles(const PrivateFiles&) = delete;
  PrivateFiles& operator=(const PrivateFiles&) = delete;

 private:
  mode_t before_;
};

/// Why this file is not to be believed; empty: it is.
std::string distrust(int file) {
  struct stat info {};
  if (::fstat(file, &info) != 0) return std::strerror(errno);
  if (!S_ISREG(info.st_mode)) return "it is no regular file";
  if (info.st_uid != ::geteuid()) return "it belongs to another user";
  if ((info.st_mode & 077) != 0) return "others may read or write it";
  return "";
}

std::optional<PageState> parse(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  const auto port = json.find("port");
  const auto token = json.find("token");
  if (port == json.end() || token == json.end()) return std::nullopt;
  if (!port->is_number_unsigned() || !token->is_string()) return std::nullopt;
  const auto number = port->get<std::uint64_t>();
  PageState state{static_cast<std::uint16_t>(number), token->get<std::string>()};
  if (number == 0 || number > 65'535 || !is_token(state.token)) return std::nullopt;
  return state;
}

}  // namespace

std::string url_of(const PageState& state) {
  return fmt::format("http://127.0.0.1:{}/#t={}", state.port, state.token);
}

FoundState read_state(const std::filesystem::path& path) {
  const files::Descriptor file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (!file) {
    if (errno == ENOENT || errno == ENOTDIR) return {};
    return {std::nullopt, errno == ELOOP ? "it is a link" : std::strerror(errno)};
  }
  if (std::string why = distrust(file.get()); !why.empty()) return {std::nullopt, std::move(why)};
  std::array<char, 4096> bytes{};
  const ssize_t count = ::read(file.get(), bytes.data(), bytes.size());
  if (count < 0) return {std::nullopt, std::strerror(errno)};
  auto state = parse({bytes.data(), static_cast<std::size_t>(count)});
  if (!state) return {std::nullopt, "it is damaged"};
  return {std::move(state), ""};
}

void write_state(const std::filesystem::path& path, const PageState& state) {
  const PrivateFiles guard;
  if (path.has_parent_path()) {
    std::error_code error;
    std::filesystem::create_directories(path.parent_path(), error);
    if (error)
      throw Error(ExitCode::storage,
                  fmt::format("cannot create the folder of the page's state: {}", error.message()),
                  path.parent_path().string(), files::usual_advice(error.value()));
  }
  // A file is written anew with the access that it has, behind its link: not where others may read it.
  if (!read_state(path).refused.empty()) ::unlink(path.c_str());
  const nlohmann::json json{{"port", state.port}, {"token", state.token}, {"url", url_of(state)}};
  files::write_whole(path, json.dump() + "\n", "the page's state");
}

}  // namespace thermorig::web
