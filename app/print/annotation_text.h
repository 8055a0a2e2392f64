// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "thermorig/core/annotation.h"

namespace thermorig::app {

/// "2026-11-23: 12.5..14 s excluded: a hand in the image". As the file has it: to be made
/// printable().
std::string words_of(const Annotation& annotation);

/// Of an exclusion, without its day: "12.5..14 s excluded: a hand in the image".
std::string exclusion_text(const Annotation& annotation);

/// `kind, made_utc`, and what belongs to the kind: `text`; `environment, acquisition`; `begin_s, end_s,
/// text`.
nlohmann::json annotation_json(const Annotation& annotation);

}  // namespace thermorig::app
