// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.h"
#include "existing_file.h"
#include "output.h"
#include "thermorig/rig/finalise.h"

namespace thermorig::app {

/// Stops at the first file that cannot be made again: nothing is half written.
ExitCode run(const ReprocessOptions& options) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& path : options.files) {
    require_existing(path);
    const session::Session session = rig::reprocess(path);
    const session::Quality quality = session::quality_of(session);
    list.push_back({{"file", path.string()},
                    {"frames", quality.frames},
                    {"frames_swept", quality.swept},
                    {"frames_valid", quality.valid},
                    {"verdict", quality.verdict}});
    if (!options.json)
      fmt::print("made again  {}  {} frames, {} of {} in legs valid, {}\n", path.string(),
                 count_text(quality.frames), count_text(quality.valid), count_text(quality.swept),
                 quality.verdict);
  }
  if (options.json) print_json(list);
  return ExitCode::ok;
}

}  // namespace thermorig::app
