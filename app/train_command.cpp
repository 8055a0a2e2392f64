// SPDX-License-Identifier: MIT
#include "commands.h"

namespace thermorig::app {

ExitCode run(const TrainOptions& options) {
  throw Error(ExitCode::failed, "this command is being built", options.output, "");
}

}  // namespace thermorig::app
