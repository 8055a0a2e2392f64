// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "thermorig/network/estimator.h"

namespace thermorig::interop {

/// A model in ONNX Runtime, batch 1, one thread, all its optimisations, inputs and outputs bound once: the
/// fastest way to call it. The library is opened at run time; its C interface is a table of functions that
/// only grows (onnxruntime_c_api.h of its project, struct OrtApi), so the places used here hold for every
/// version.
class OnnxRuntime {
 public:
  /// `library`: libonnxruntime.so; `model`: the bytes of an .onnx file, which scales each window `by_window`
  /// or not. Ends the program with a message where either is refused.
  OnnxRuntime(const std::string& library, std::span<const std::uint8_t> model, const network::Shape& shape,
              bool by_window = false);
  ~OnnxRuntime();

  /// Its version, e.g. "1.30.0".
  std::string version() const;

  /// Runs on what `frames()`, `gyro()` and, of a network that scales by the window, `period()` hold: the
  /// inputs of docs/model_format.md.
  network::Output run();

  std::span<float> frames();
  float& gyro();
  float& period();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace thermorig::interop
