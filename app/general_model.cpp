// SPDX-License-Identifier: MIT
#include "general_model.h"

#include <sha2.h>

#include <cstdint>
#include <span>

#include "thermorig/io/files/existing.h"

// The file as it is (docs/models), between two labels.
__asm__(
    ".section .rodata\n"
    ".balign 16\n"
    "thermorig_general_55:\n"
    ".incbin \"" THERMORIG_GENERAL_55
    "\"\n"
    "thermorig_general_55_end:\n"
    ".byte 0\n"
    ".text\n");
extern "C" {
extern const std::uint8_t thermorig_general_55[] __attribute__((visibility("hidden")));
extern const std::uint8_t thermorig_general_55_end[] __attribute__((visibility("hidden")));
}

namespace thermorig::app {

namespace {

std::span<const std::uint8_t> general_bytes() {
  return {thermorig_general_55, thermorig_general_55_end};
}

std::string sha256_of(std::span<const std::uint8_t> bytes) {
  char text[SHA256_DIGEST_STRING_LENGTH] = {};
  SHA256Data(bytes.data(), bytes.size(), text);
  return text;
}

std::string sha256_of(const std::filesystem::path& path) {
  char text[SHA256_DIGEST_STRING_LENGTH] = {};
  return SHA256File(path.c_str(), text) == nullptr ? std::string() : std::string(text);
}

}  // namespace

std::optional<model::Model> general_model(const network::CameraView& view) {
  model::Model model = model::from_onnx(general_bytes(), general_model_name);
  if (!model.provenance.view || !model.provenance.view->fits(view)) return std::nullopt;
  return model;
}

NamedModel named_model(const std::filesystem::path& path) {
  std::error_code hidden;
  if (path == "general" && !std::filesystem::exists(path, hidden))
    return {model::from_onnx(general_bytes(), general_model_name), "general-55.onnx",
            sha256_of(general_bytes())};
  files::require_existing(path);
  return {model::read_model(path), path.filename().string(), sha256_of(path)};
}

}  // namespace thermorig::app
