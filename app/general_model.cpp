// SPDX-License-Identifier: MIT
#include "general_model.h"

#include <sha2.h>

#include <cmath>
#include <cstdint>
#include <span>

#include "thermorig/io/files/existing.h"

// The files as they are (docs/models), each between two labels.
__asm__(
    ".section .rodata\n"
    ".balign 16\n"
    "thermorig_general_55:\n"
    ".incbin \"" THERMORIG_MODELS
    "/general-55.onnx\"\n"
    "thermorig_general_55_end:\n"
    ".balign 16\n"
    "thermorig_general_110:\n"
    ".incbin \"" THERMORIG_MODELS
    "/general-110.onnx\"\n"
    "thermorig_general_110_end:\n"
    ".byte 0\n"
    ".text\n");
extern "C" {
extern const std::uint8_t thermorig_general_55[] __attribute__((visibility("hidden")));
extern const std::uint8_t thermorig_general_55_end[] __attribute__((visibility("hidden")));
extern const std::uint8_t thermorig_general_110[] __attribute__((visibility("hidden")));
extern const std::uint8_t thermorig_general_110_end[] __attribute__((visibility("hidden")));
}

namespace thermorig::app {

namespace {

struct General {
  double width_deg;
  const char* file;
  std::span<const std::uint8_t> bytes;

  NamedModel named() const;
};

/// Of the lens that is nearer.
General general_of(double width_deg) {
  if (std::abs(width_deg - 55.0) < std::abs(width_deg - 110.0))
    return {55.0, "general-55.onnx", {thermorig_general_55, thermorig_general_55_end}};
  return {110.0, "general-110.onnx", {thermorig_general_110, thermorig_general_110_end}};
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

NamedModel General::named() const {
  return {model::from_onnx(bytes, general_model_name), file, sha256_of(bytes)};
}

}  // namespace

std::optional<model::Model> general_model(const network::CameraView& view) {
  model::Model model = general_of(view.width_deg).named().model;
  if (!model.provenance.view || !model.provenance.view->fits(view)) return std::nullopt;
  return model;
}

NamedModel named_model(const std::filesystem::path& path, double width_deg) {
  std::error_code hidden;
  if (path == "general" && !std::filesystem::exists(path, hidden)) return general_of(width_deg).named();
  files::require_existing(path);
  return {model::read_model(path), path.filename().string(), sha256_of(path)};
}

}  // namespace thermorig::app
