// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/storage/sandbox/sandbox.h"
#include "thermorig/storage/sandbox/sealed_copy.h"
#include "thermorig/storage/session/rows.h"

namespace thermorig::view {

/// What children are asked to make of a session for a page: for session::try_sessions_first().
std::vector<sandbox::Task> tasks();

inline constexpr std::uint64_t overview_bytes_max = 512U << 20U;  // of facts and rows

/// A finished session as a page is sent it. A child process reads the file, and its answers are handed on as
/// they are: who shows them must not believe them. Where no child was started (session::try_sessions_first())
/// the file is read in this process, as suits tests. docs/session_page.md says what the bytes are.
class SessionView {
 public:
  /// `every`: a row for every n-th frame, 1 at least. Throws as read_session() does for what it reads, and
  /// Error(not_a_session) for a session whose rows take more than overview_bytes_max.
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
  std::string ask(std::size_t task, const std::string& request, std::uint64_t bytes_max) const;

  sandbox::SealedCopy copy_;
  std::uint64_t frames_ = 0;
  std::string facts_, rows_;
};

inline constexpr std::uint64_t served_images = 64;  // of a block, as they lie in the file

/// What a server answers to a page: "facts", "rows" and "images/N", the N-th block of served_images; nothing
/// for any other name. Throws as SessionView::images() does.
std::optional<std::string> served_part(const SessionView& view, std::string_view name);

}  // namespace thermorig::view
