// SPDX-License-Identifier: MIT
#include "thermorig/storage/view/session_view.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "facts.h"
#include "frame_columns.h"
#include "thermorig/core/image_bytes.h"

namespace thermorig::view {

namespace {

std::optional<std::uint64_t> take_number(std::string_view& text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

}  // namespace

SessionView::SessionView(const std::filesystem::path& path, std::uint64_t every) : file_(path) {
  const session::Rows rows = session::read_rows(file_);
  const Columns columns = frame_columns(rows, every);
  frames_ = rows.session.samples.size();
  facts_ = facts_json(path.filename().string(), rows, columns);
  rows_ = columns.bytes();
}

std::string SessionView::images(session::FrameRange range) const {
  const session::Images images = session::read_images(file_, range);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(images.frames.size() * image_bytes);
  for (const ThermalFrame& frame : images.frames) append_image(bytes, frame, images.mirrored);
  return {bytes.begin(), bytes.end()};
}

std::optional<std::string> served_part(const SessionView& view, std::string_view name) {
  constexpr std::string_view block_prefix = "images/";
  if (name == "facts") return view.facts();
  if (name == "rows") return view.rows();
  if (!name.starts_with(block_prefix)) return std::nullopt;
  name.remove_prefix(block_prefix.size());
  const auto block = take_number(name);
  if (!block || !name.empty() || *block > view.frames() / served_images) return std::nullopt;
  const std::uint64_t first = *block * served_images;
  if (first >= view.frames()) return std::nullopt;
  return view.images({first, std::min(served_images, view.frames() - first)});
}

}  // namespace thermorig::view
