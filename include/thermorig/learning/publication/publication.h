// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "thermorig/learning/dataset/session_list.h"

namespace thermorig::publication {

/// What its owner says of a data set.
struct Terms {
  std::string title;
  std::string description;           // empty: none
  std::string licence;               // empty: that of the sessions, where they all have the same
  std::vector<std::string> authors;  // none: not stated
  std::string version = "1.0.0";
  std::string url;   // where it will be; empty: not known yet
  std::string date;  // "2026-11-23"
};

/// A session of a data set.
struct Entry {
  dataset::ListedSession session;
  std::string path;  // within the folder, with '/'
  std::uint64_t bytes = 0;
  std::string sha256;
};

/// All sessions of a folder, by environment and number. Throws Error: bad_usage where there is none or a path
/// cannot stand in a list of sums, not_a_session for a file that is none, for a link, and for a recording
/// that is there twice, check_failed for a bad verdict unless these are accepted.
std::vector<Entry> entries_of(const std::filesystem::path& folder, bool accept_bad,
                              const dataset::ReadingProgress& progress = {});

/// Train on all environments but one, test on that one: a fold. Calibrations are in neither part.
struct Fold {
  std::string environment;  // that is left out
  std::vector<std::string> training, test;
};

/// One an environment, by name; none where there is only one.
std::vector<Fold> leave_one_out(const std::vector<Entry>& entries);

/// The licence that is stated for a data set: the owner's word, else what all sessions say; else empty.
std::string licence_of(const Terms& terms, const std::vector<Entry>& entries);

/// A file that describes a data set.
struct Description {
  std::string name;
  std::string text;
};

/// What they are called.
inline constexpr std::array<const char*, 5> description_names{"manifest.json", "splits.json", "DATA_CARD.md",
                                                              "CITATION.cff", "croissant.json"};

/// One of each of these names, in this order.
std::vector<Description> describe(const Terms& terms, const std::vector<Entry>& entries);

/// The file that holds the sums of all others, as sha256sum(1) reads it.
inline constexpr const char* sums_name = "SHA256SUMS";
std::string sums_text(const std::vector<Entry>& entries, const std::vector<Description>& descriptions);

/// A file that is not as it was when the data set was built.
struct Difference {
  std::string path;  // within the folder
  std::string what;
};

/// What differs from what `dataset build` makes: each session and each description has its line and its sum,
/// nothing else has one, and no link leads anywhere. Throws Error: bad_usage if the folder has no sums,
/// not_a_session if these are none, no_permission and storage if a file cannot be read.
std::vector<Difference> verify(const std::filesystem::path& folder);

}  // namespace thermorig::publication
