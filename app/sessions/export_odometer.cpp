// SPDX-License-Identifier: MIT
#include "export_odometer.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "export_files.h"
#include "export_session.h"
#include "export_size.h"
#include "print/output.h"
#include "thermorig/estimators/board_odometer/odometer_source.h"
#include "thermorig/estimators/map_file/map_file.h"
#include "thermorig/io/files/existing.h"
#include "thermorig/rig/profile/profile_file.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::app {

namespace {

/// What else this program writes: read as a profile it would only be found not to be text.
void refuse_other_kinds(const std::filesystem::path& file) {
  const bool is_map = map_file::is_map(file);
  if (!is_map && file.extension() != ".onnx") return;
  throw Error(
      ExitCode::bad_usage,
      fmt::format("--odometer takes a rig profile or a session, and this is a {}", is_map ? "map" : "model"),
      file.string(),
      is_map ? "the profile of that rig: thermorig export bench.toml --odometer"
             : "thermorig export MODEL --c-header, or thermorig export bench.toml --odometer");
}

RigProfile profile_of(const std::filesystem::path& file) {
  refuse_other_kinds(file);
  return file.extension() == ".h5" ? session::read_session(file).raw.header.profile : rig::read_profile(file);
}

void print_words(const ExportOptions& options, const RigProfile& rig, const std::vector<NewFile>& files,
                 const board_odometer::OdometerSource& source, const std::optional<CompiledSize>& compiled) {
  print("rig       {}: {}\n", printable(options.file.string()), printable(rig.name));
  for (const NewFile& file : files) print("written   {}\n", printable(file.path.string()));
  if (compiled)
    print("flash     {} B of code ({})\n", count_text(compiled->flash_bytes), printable(compiled->compiler));
  else
    print("flash     about 23 kB of code (arm-none-eabi-gcc would tell)\n");
  print("RAM       {} B, and less than {} B of stack\n", count_text(source.state_bytes),
        count_text(source.stack_bytes));
  print("next      docs/export.md tells what the firmware calls\n");
}

}  // namespace

ExitCode export_odometer(const ExportOptions& options) {
  if (is_of_a_session(options) || options.batch || options.frames || options.reduction)
    throw Error(ExitCode::bad_usage, "--odometer writes C sources, and no other form with them", "",
                "thermorig export --help");
  files::require_existing(options.file);
  const RigProfile rig = profile_of(options.file);
  const std::string name = options.name.value_or("thermorig_odometer");
  board_odometer::OdometerSource source = board_odometer::odometer_source(rig, name);
  std::vector<NewFile> files;
  for (embedded::SourceFile& file : source.files)
    files.push_back({options.output / file.name, std::move(file.text)});
  write_new_files(files);
  const std::optional<CompiledSize> compiled = compiled_size(options.output / (name + ".c"));
  if (!options.json) {
    print_words(options, rig, files, source, compiled);
    return ExitCode::ok;
  }
  nlohmann::json object{
      {"profile", options.file.string()}, {"name", name},        {"files", nlohmann::json::array()},
      {"flash_bytes", nullptr},           {"compiler", nullptr}, {"state_bytes", source.state_bytes},
      {"stack_bytes", source.stack_bytes}};
  for (const NewFile& file : files) object["files"].push_back(file.path.string());
  if (compiled) {
    object["flash_bytes"] = compiled->flash_bytes;
    object["compiler"] = compiled->compiler;
  }
  print_json(object);
  return ExitCode::ok;
}

}  // namespace thermorig::app
