// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "thermorig/learning/publication/publication.h"

namespace thermorig::publication {

/// Sums over the sessions that are not for calibrations.
struct Totals {
  std::size_t sessions = 0, simulated = 0, calibrations = 0;
  std::uint64_t frames = 0, swept = 0, valid = 0, bytes = 0;
  double duration_s = 0.0;
  std::map<std::string, std::uint64_t> reasons;  // frames within legs
};
Totals totals_of(const std::vector<Entry>& entries);

/// JSON: every session with its facts and its sum.
std::string manifest_text(const Terms& terms, const std::vector<Entry>& entries);
/// JSON: the folds.
std::string splits_text(const std::vector<Entry>& entries);
/// Markdown, for people.
std::string card_text(const Terms& terms, const std::vector<Entry>& entries);
/// Citation File Format 1.2.
std::string citation_text(const Terms& terms, const std::vector<Entry>& entries);
/// Croissant 1.0 (JSON-LD); `manifest`: the text of manifest.json.
std::string croissant_text(const Terms& terms, const std::vector<Entry>& entries,
                           const std::string& manifest);

/// What a data set without a description of its own is.
std::string description_of(const Terms& terms, const std::vector<Entry>& entries);

}  // namespace thermorig::publication
