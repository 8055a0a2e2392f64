// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/learning/dataset/dataset.h"
#include "thermorig/storage/session/annotations.h"

namespace thermorig::dataset {

/// What is to be known of a session file to find it again among many.
struct ListedSession {
  std::filesystem::path file;
  std::optional<Error> refusal;  // why it is no session; the rest is then empty
  RecordingHeader header;
  session::Place place;  // where it is known, which later words may have changed
  session::Quality quality;
  bool for_calibration = false;
  std::vector<Annotation> exclusions;  // made afterwards
  std::vector<std::string> notes;      // of the recording, the operator's marks, later ones; in this order
};

/// Opens the file of that index. May be called from several threads; throws Error.
using OpenFile = std::function<session::StoredFile(std::size_t index)>;

/// Looks at all files, on all cores; in their order. A file that is no session keeps nobody from the others.
/// `open`: empty: the file as it stands there.
std::vector<ListedSession> list_sessions(const std::vector<std::filesystem::path>& files,
                                         const ReadingProgress& progress = {}, const OpenFile& open = {});

/// The simulated rig's world of a recording, as `simulation` in its header ends: "honest",
/// "hard,gyro.bandwidth_hz=20"; empty of a real rig, and where the header says none.
std::string world_of(const RecordingHeader& header);

}  // namespace thermorig::dataset
