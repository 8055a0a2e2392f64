// SPDX-License-Identifier: MIT
#include "train_files.h"

#include <fstream>
#include <iterator>

#include "thermorig/core/error.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;

bool same_bytes(const fs::path& one, const fs::path& other) {
  std::error_code missing;
  const auto size = fs::file_size(one, missing);
  if (missing || size != fs::file_size(other, missing) || missing) return false;
  std::ifstream first(one, std::ios::binary), second(other, std::ios::binary);
  return first && second &&
         std::equal(std::istreambuf_iterator<char>(first), {}, std::istreambuf_iterator<char>(second));
}

}  // namespace

fs::path run_folder_of(const TrainOptions& options) {
  if (!options.run_folder.empty()) return options.run_folder;
  fs::path folder = options.output;
  return folder.replace_extension(".run");
}

bool is_free(const fs::path& output, const fs::path& written) {
  std::error_code hidden;
  if (fs::is_directory(output, hidden))
    throw Error(ExitCode::bad_usage, "is a folder", output.string(), "name a file: -o model.onnx");
  return !fs::exists(output, hidden) || same_bytes(output, written);
}

void require_free(const fs::path& output, const fs::path& written) {
  if (is_free(output, written)) return;
  throw Error(ExitCode::bad_usage, "there is a file already, and a model is never overwritten",
              output.string(), "another name with -o, or move that one away");
}

}  // namespace thermorig::app
