// SPDX-License-Identifier: MIT
#include "profile_path.h"

#include <cstdlib>

#include "thermorig/core/error.h"
#include "thermorig/rig/profile/profile_file.h"

namespace thermorig::app {

namespace {

std::string environment_value(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::filesystem::path settings_folder() {
  const std::string settings = environment_value("XDG_CONFIG_HOME");
  if (!settings.empty()) return std::filesystem::path(settings) / "thermorig";
  const std::string home = environment_value("HOME");
  if (!home.empty()) return std::filesystem::path(home) / ".config" / "thermorig";
  throw Error(ExitCode::bad_usage, "neither XDG_CONFIG_HOME nor HOME says where profiles lie", "",
              "a file name, e.g. --rig ./bench.toml");
}

/// A word without '/' and ".toml" is a name in the settings; a file of this folder may have been meant.
void refuse_one_that_is_here(const std::string& name, const std::filesystem::path& path) {
  for (const std::string& file : {name, name + ".toml"}) {
    const std::filesystem::path here = std::filesystem::path(".") / file;
    std::error_code hidden;
    if (!std::filesystem::is_regular_file(here, hidden)) continue;
    throw Error(ExitCode::bad_usage,
                "there is no such profile: a word without '/' that does not end in .toml is a name, which is "
                "not looked for in the present folder",
                path.string(), "the file that is here: --rig " + here.string());
  }
}

}  // namespace

std::filesystem::path profile_path(const std::string& name) {
  if (name.find('/') != std::string::npos || name.ends_with(".toml")) return name;
  return settings_folder() / (name + ".toml");
}

RigProfile read_named_profile(const std::string& name) {
  const std::filesystem::path path = profile_path(name);
  if (std::filesystem::exists(path)) return rig::read_profile(path);
  if (path != name) refuse_one_that_is_here(name, path);
  throw Error(ExitCode::bad_usage, "there is no such profile", path.string(),
              "thermorig ports --save " + name);
}

}  // namespace thermorig::app
