// SPDX-License-Identifier: MIT
#include "thermorig/storage/sandbox/refusal.h"

#include "thermorig/core/error.h"

namespace thermorig::sandbox {

void refuse(const std::filesystem::path& path, const std::string& what) {
  throw Error(ExitCode::not_a_session, what, path.string(),
              "name a session that thermorig wrote; if this is one, it is damaged: take a copy of it from "
              "elsewhere, or its journal with thermorig recover");
}

}  // namespace thermorig::sandbox
