// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "export_files.h"
#include "export_session.h"
#include "print/output.h"
#include "thermorig/io/files/existing.h"
#include "thermorig/network/embedded/c_source.h"
#include "thermorig/network/model/model.h"

namespace thermorig::app {

namespace {

/// What a C file takes on a Cortex-M4 with its floating-point unit, as the compiler makes it.
struct CompiledSize {
  std::uint64_t flash_bytes = 0;  // code and constants, without the C library's expf
  std::string compiler;           // in words
};

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

/// Compiles the file if the board's compiler (arm-none-eabi-gcc) is on this machine; nothing otherwise.
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

void require_kind(const ExportOptions& options) {
  if (options.c_header || options.batch) return;
  throw Error(
      ExitCode::bad_usage, "what should be exported?", "",
      "of a session --npz, --csv, --tum or --mcap; of a model --c-header for small boards, or --batch 1 for "
      "ONNX with a fixed batch (the model file itself is ONNX with any batch)");
}

std::string name_of(const ExportOptions& options) {
  return options.name.value_or("thermorig_network");
}

/// What the C sources take on a board.
struct BoardNeeds {
  std::size_t constant_bytes = 0;
  std::size_t state_bytes = 0;
  std::optional<CompiledSize> compiled;
};

std::vector<NewFile> c_files(const ExportOptions& options, const model::Model& model, BoardNeeds& needs) {
  const auto kind = options.weights == "int8" ? embedded::WeightKind::int8 : embedded::WeightKind::float32;
  embedded::CSource source = embedded::c_source(model, kind, name_of(options));
  needs = {source.constant_bytes, source.working_bytes, std::nullopt};
  std::vector<NewFile> files;
  for (embedded::SourceFile& file : source.files)
    files.push_back({options.output / file.name, std::move(file.text)});
  return files;
}

NewFile onnx_file(const ExportOptions& options, const model::Model& model) {
  const std::string name = fmt::format("{}-batch{}.onnx", options.file.stem().string(), *options.batch);
  return {options.output / name, model::to_onnx(model, *options.batch)};
}

std::string network_words(const model::Model& model) {
  const network::Shape& shape = model.weights.shape;
  return fmt::format("Nf {}, Nr {}, {}, {} weights{}", shape.frames, shape.reduction,
                     shape.fusion ? "fusion" : "thermal-only", count_text(network::weight_count(shape)),
                     model.provenance.simulated ? ", TRAINED ON SIMULATED DATA" : "");
}

void print_needs(const BoardNeeds& needs) {
  const std::string constants = fmt::format("{} B of constants", count_text(needs.constant_bytes));
  if (needs.compiled)
    print("flash     {} B: {} and the code ({})\n", count_text(needs.compiled->flash_bytes), constants,
          printable(needs.compiled->compiler));
  else
    print("flash     {}, and about 3 kB of code (install arm-none-eabi-gcc to measure it)\n", constants);
  print("RAM       {} B, and less than 512 B of stack\n", count_text(needs.state_bytes));
}

void print_words(const ExportOptions& options, const model::Model& model, const std::vector<NewFile>& files,
                 const BoardNeeds& needs) {
  print("model     {}: {}\n", printable(options.file.string()), network_words(model));
  for (const NewFile& file : files) print("written   {}\n", printable(file.path.string()));
  if (!options.c_header) return;
  print_needs(needs);
  print("next      #include \"{}.h\"; docs/export.md says how\n", name_of(options));
}

void print_object(const ExportOptions& options, const model::Model& model, const std::vector<NewFile>& files,
                  const BoardNeeds& needs) {
  const network::Shape& shape = model.weights.shape;
  nlohmann::json object{{"model", options.file.string()},
                        {"frames", shape.frames},
                        {"reduction", shape.reduction},
                        {"fusion", shape.fusion},
                        {"weights", network::weight_count(shape)},
                        {"simulated", model.provenance.simulated},
                        {"files", nlohmann::json::array()},
                        {"batch", nullptr},
                        {"c_header", nullptr}};
  for (const NewFile& file : files) object["files"].push_back(file.path.string());
  if (options.batch) object["batch"] = *options.batch;
  if (options.c_header)
    object["c_header"] = {
        {"name", name_of(options)},
        {"weights", options.weights},
        {"constant_bytes", needs.constant_bytes},
        {"flash_bytes", needs.compiled ? nlohmann::json(needs.compiled->flash_bytes) : nlohmann::json()},
        {"compiler", needs.compiled ? nlohmann::json(needs.compiled->compiler) : nlohmann::json()},
        {"state_bytes", needs.state_bytes}};
  print_json(object);
}

}  // namespace

ExitCode run(const ExportOptions& options) {
  if (options.name && !options.c_header)
    throw Error(ExitCode::bad_usage, "--name is for C sources: it needs --c-header", *options.name,
                "--c-header");
  if (is_of_a_session(options)) return export_session(options);
  require_kind(options);
  files::require_existing(options.file);
  const model::Model model = model::read_model(options.file);
  BoardNeeds needs;
  std::vector<NewFile> files;
  if (options.c_header) files = c_files(options, model, needs);
  if (options.batch) files.push_back(onnx_file(options, model));
  write_new_files(files);
  if (options.c_header) needs.compiled = compiled_size(options.output / (name_of(options) + ".c"));
  if (options.json)
    print_object(options, model, files, needs);
  else
    print_words(options, model, files, needs);
  return ExitCode::ok;
}

}  // namespace thermorig::app
