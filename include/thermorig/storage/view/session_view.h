// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "thermorig/storage/session/rows.h"

namespace thermorig::view {

/// A finished session as a page is sent it. docs/session_page.md says what the bytes are.
class SessionView {
 public:
  /// `every`: a row for every n-th frame, 1 at least. Throws as read_session() does for what it reads.
  explicit SessionView(const std::filesystem::path& path, std::uint64_t every = 1);

  std::uint64_t frames() const { return frames_; }
  /// JSON.
  const std::string& facts() const { return facts_; }
  /// The columns that the facts name.
  const std::string& rows() const { return rows_; }
  /// Images of frames, image_bytes each. May be called from several threads. Throws as the constructor does,
  /// Error(not_a_session) also for frames that there are not, and for more than session::most_images.
  std::string images(session::FrameRange range) const;

 private:
  session::StoredFile file_;
  std::uint64_t frames_ = 0;
  std::string facts_, rows_;
};

inline constexpr std::uint64_t served_images = 64;  // of a block, as they lie in the file

/// What a server answers to a page: "facts", "rows" and "images/N", the N-th block of served_images; nothing
/// for any other name. Throws as SessionView::images() does.
std::optional<std::string> served_part(const SessionView& view, std::string_view name);

}  // namespace thermorig::view
