// SPDX-License-Identifier: MIT
#include "thermorig/io/files/whole_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"
#include "thermorig/io/files/descriptor.h"
#include "thermorig/io/files/replaced_file.h"

namespace thermorig::files {

namespace {

/// A file that is open for reading.
class SourceFile {
 public:
  SourceFile(const std::filesystem::path& path, const std::string& noun) : path_(path), noun_(noun) {
    // A pipe without a writer would block the program for good.
    descriptor_ = Descriptor(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
    if (!descriptor_) refuse_to_open(errno);
  }

  std::size_t size(std::size_t bytes_max) const {
    struct stat info {};
    if (::fstat(descriptor_.get(), &info) != 0) refuse(std::strerror(errno));
    if (S_ISDIR(info.st_mode)) refuse("it is a folder");
    if (!S_ISREG(info.st_mode)) refuse("it is a pipe or a device, not a regular file");
    if (static_cast<std::uint64_t>(info.st_size) > bytes_max)
      refuse(fmt::format("it has {} bytes, more than the {} that are read at most", info.st_size, bytes_max));
    return static_cast<std::size_t>(info.st_size);
  }

  std::vector<std::uint8_t> read(std::size_t bytes) const {
    std::vector<std::uint8_t> content(bytes);
    std::size_t done = 0;
    while (done < bytes) {
      const ssize_t count = ::read(descriptor_.get(), content.data() + done, bytes - done);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) refuse(std::strerror(errno));
      if (count == 0) refuse("it becomes shorter while it is read");
      done += static_cast<std::size_t>(count);
    }
    return content;
  }

 private:
  [[noreturn]] void refuse_to_open(int error_number) const {
    if (error_number != EACCES && error_number != EPERM) refuse(std::strerror(error_number));
    throw Error(ExitCode::no_permission,
                fmt::format("cannot read {}: {}", noun_, std::strerror(error_number)), path_.string(),
                "see who may read it: ls -l " + shell_word(path_.string()));
  }

  [[noreturn]] void refuse(const std::string& reason) const {
    throw Error(ExitCode::not_a_session, fmt::format("cannot read {}: {}", noun_, reason), path_.string(),
                "check the path");
  }

  const std::filesystem::path& path_;
  const std::string& noun_;
  Descriptor descriptor_;
};

void fill(PartFile& part, std::string_view bytes) {
  part.reserve(bytes.size());
  part.write(std::as_bytes(std::span(bytes)));
  part.sync();
}

}  // namespace

void write_whole(const std::filesystem::path& path, std::string_view bytes, const std::string& noun,
                 Advice advice) {
  PartFile part(ReplacedFile(path, noun, advice));
  fill(part, bytes);
  part.publish();
}

bool write_whole_if_free(const std::filesystem::path& path, std::string_view bytes, const std::string& noun,
                         Advice advice) {
  PartFile part(path, noun, advice);
  fill(part, bytes);
  return part.publish_unless_taken();
}

std::vector<std::uint8_t> read_whole(const std::filesystem::path& path, std::size_t bytes_max,
                                     const std::string& noun) {
  const SourceFile file(path, noun);
  return file.read(file.size(bytes_max));
}

}  // namespace thermorig::files
