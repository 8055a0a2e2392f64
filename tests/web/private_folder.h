// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace thermorig::web {

/// A folder of mode 0700 that goes with this object.
class PrivateFolder {
 public:
  PrivateFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "thermorig-web-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~PrivateFolder() {
    std::error_code no_matter;
    std::filesystem::remove_all(path_, no_matter);
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace thermorig::web
