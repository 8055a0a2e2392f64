// SPDX-License-Identifier: MIT
#include "export_size.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <vector>

namespace thermorig::app {

namespace {

/// A folder of its own that goes when this goes.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code failure;
    std::string name = (std::filesystem::temp_directory_path(failure) / "thermorig-size-XXXXXX").string();
    if (!failure && mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;  // empty: there is none
};

/// Runs a program that is looked up in PATH, without a shell; its output goes to `out`.
bool succeeded(std::vector<std::string> words, const std::filesystem::path& out) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t process = 0;
  const int failure = posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  return failure == 0 && waitpid(process, &status, 0) == process && WIFEXITED(status) &&
         WEXITSTATUS(status) == 0;
}

/// Code, constants and initialised data, from the table that `size` prints.
std::optional<std::uint64_t> flash_of(const std::filesystem::path& table) {
  std::ifstream file(table);
  std::string heading;
  std::uint64_t text = 0, data = 0;
  if (!std::getline(file, heading) || !(file >> text >> data)) return std::nullopt;
  return text + data;
}

}  // namespace

std::optional<CompiledSize> compiled_size(const std::filesystem::path& c_file) {
  const TemporaryFolder folder;
  if (folder.path().empty()) return std::nullopt;
  const auto object = folder.path() / "network.o", out = folder.path() / "out.txt";
  if (!succeeded(
          {"arm-none-eabi-gcc", "-std=c99", "-O2", "-mthumb", "-mcpu=cortex-m4", "-mfloat-abi=hard",
           "-mfpu=fpv4-sp-d16", "-c", std::filesystem::absolute(c_file).string(), "-o", object.string()},
          out) ||
      !succeeded({"arm-none-eabi-size", object.string()}, out))
    return std::nullopt;
  const auto flash = flash_of(out);
  if (!flash) return std::nullopt;
  return CompiledSize{*flash, "arm-none-eabi-gcc -O2 for a Cortex-M4F"};
}

}  // namespace thermorig::app
