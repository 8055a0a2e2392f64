// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <fstream>

#include "storage/session/session_image.h"

namespace thermorig::session {

/// As write_session(), but without the writer's own look at what it has written.
inline void write_unchecked(const std::filesystem::path& path, const Session& session) {
  const SessionImage image = build_image(session, 1);
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(image.bytes.data()),
            static_cast<std::streamsize>(image.bytes.size()));
}

}  // namespace thermorig::session
