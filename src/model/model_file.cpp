// SPDX-License-Identifier: MIT
#include <fstream>
#include <iterator>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/model/model.h"

namespace thermorig::model {

void write_model(const std::filesystem::path& path, const Model& model, int batch) {
  const std::string bytes = to_onnx(model, batch);
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw Error(ExitCode::storage, "cannot write the model", path.string(), "choose another folder");
}

Model read_model(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ExitCode::not_a_session, "cannot open the model", path.string(), "check the path");
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  return from_onnx({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, path.string());
}

}  // namespace thermorig::model
