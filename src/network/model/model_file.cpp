// SPDX-License-Identifier: MIT
#include "size_limit.h"
#include "thermorig/io/files/whole_file.h"
#include "thermorig/network/model/model.h"

namespace thermorig::model {

void write_model(const std::filesystem::path& path, const Model& model, int batch) {
  files::write_whole(path, to_onnx(model, batch), "the model");
}

Model read_model(const std::filesystem::path& path) {
  return from_onnx(files::read_whole(path, file_bytes_max, "the model"), path.string());
}

}  // namespace thermorig::model
