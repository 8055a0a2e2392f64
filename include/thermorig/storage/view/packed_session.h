// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace thermorig::view {

/// A part of a document: base64 of what deflate made of it, but "packing", which is as it is.
struct PackedPart {
  std::string name;  // facts, rows, images-0, images-1, ..., packing
  std::string base64;
};

/// A session as a document holds it. docs/session_page.md says what the parts are.
struct PackedSession {
  std::vector<PackedPart> parts;
  std::string facts;  // JSON, as SessionView::facts()
  std::uint64_t frames = 0;
  std::uint64_t row_every = 1;    // frames of which one has a row
  std::uint64_t image_every = 1;  // frames of which one has an image; a multiple of row_every
  std::string left_out;           // in a sentence; empty: nothing is
};

/// Packs a session so that its parts take `bytes_max` at most: first every n-th image is left, and where rows
/// alone would take most of that, every n-th of them. Throws as SessionView does, Error(failed) if not even
/// the facts fit.
PackedSession packed_session(const std::filesystem::path& path, std::size_t bytes_max);

}  // namespace thermorig::view
