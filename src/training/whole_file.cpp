// SPDX-License-Identifier: MIT
#include "thermorig/training/whole_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "thermorig/core/error.h"

namespace thermorig::training {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path, int reason) {
  throw Error(ExitCode::storage, std::string("cannot be written: ") + std::strerror(reason), path.string(),
              "free some space, or choose a folder that can be written");
}

/// A file under its temporary name; removed again unless it was renamed.
class PartFile {
 public:
  explicit PartFile(const fs::path& path) : path_(path), part_(path.string() + ".part") {
    file_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file_ < 0) refuse(path_, errno);
  }
  ~PartFile() {
    if (file_ >= 0) ::close(file_);
    if (!renamed_) ::unlink(part_.c_str());
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(file_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) refuse(path_, errno);
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void rename() {
    if (::fsync(file_) != 0) refuse(path_, errno);
    const int file = file_;
    file_ = -1;
    if (::close(file) != 0) refuse(path_, errno);
    if (::rename(part_.c_str(), path_.c_str()) != 0) refuse(path_, errno);
    renamed_ = true;
  }

 private:
  fs::path path_, part_;
  int file_ = -1;
  bool renamed_ = false;
};

/// The name is safe only when its folder is. Some file systems cannot sync a folder: then it is theirs to
/// say.
void sync_folder(const fs::path& path) {
  const fs::path folder = path.parent_path().empty() ? fs::path(".") : path.parent_path();
  const int handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) return;
  ::fsync(handle);
  ::close(handle);
}

}  // namespace

void write_whole(const fs::path& path, std::string_view bytes) {
  PartFile file(path);
  file.write(bytes);
  file.rename();
  sync_folder(path);
}

}  // namespace thermorig::training
