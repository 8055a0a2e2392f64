// SPDX-License-Identifier: MIT
#include "byte_source.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "thermorig/core/error.h"

namespace thermorig::app {

namespace {

constexpr std::size_t block_bytes = 1 << 16;

int keep_open(std::FILE*) {
  return 0;
}

[[noreturn]] void refuse_to_read(const std::string& path, int reason) {
  if (reason == ENOENT)
    throw Error(ExitCode::bad_usage, "there is no such file", path, "another name, or - for standard input");
  const ExitCode code = reason == EACCES ? ExitCode::no_permission : ExitCode::storage;
  throw Error(code, std::string("it cannot be read: ") + std::strerror(reason), path, "ls -l " + path);
}

std::unique_ptr<std::FILE, int (*)(std::FILE*)> open_source(const std::string& path) {
  if (path == "-") return {stdin, keep_open};
  if (std::filesystem::is_directory(path)) refuse_to_read(path, EISDIR);
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) refuse_to_read(path, errno);
  return {file, std::fclose};
}

}  // namespace

ByteSource::ByteSource(const std::string& path)
    : name_(path == "-" ? "standard input" : path), file_(open_source(path)), block_(block_bytes) {}

std::span<const std::uint8_t> ByteSource::next() {
  for (;;) {  // read(), not fread(): what a pipe has is shown at once
    const ssize_t got = read(fileno(file_.get()), block_.data(), block_.size());
    if (got >= 0) return {block_.data(), static_cast<std::size_t>(got)};
    if (errno != EINTR) refuse_to_read(name_, errno);
  }
}

}  // namespace thermorig::app
