// SPDX-License-Identifier: MIT
#include "thermorig/storage/view/session_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <optional>

#include "facts.h"
#include "frame_columns.h"
#include "thermorig/core/image_bytes.h"
#include "thermorig/storage/sandbox/refusal.h"
#include "thermorig/storage/session/salvage.h"
#include "thermorig/storage/session/trial.h"

namespace thermorig::view {

namespace {

constexpr std::size_t overview_task = 0;
constexpr std::size_t images_task = 1;

/// What stands before facts and rows in a child's answer.
struct OverviewHead {
  std::uint64_t frames = 0, facts_bytes = 0;
};

[[noreturn]] void refuse_request(const sandbox::SealedCopy& copy) {
  sandbox::refuse(copy.path(), "was asked for something that nobody understands");
}

std::optional<std::uint64_t> take_number(std::string_view& text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

/// "EVERY NAME": a row for every n-th frame of the session of that name.
std::string make_overview(const sandbox::SealedCopy& copy, std::string_view request) {
  const auto every = take_number(request);
  if (!every || *every == 0 || !request.starts_with(' ')) refuse_request(copy);
  const session::Rows rows = session::read_rows(copy);
  const Columns columns = frame_columns(rows, *every);
  const std::string facts = facts_json(std::string(request.substr(1)), rows, columns);
  const OverviewHead head{rows.session.samples.size(), facts.size()};
  std::string answer(reinterpret_cast<const char*>(&head), sizeof head);
  return answer + facts + columns.bytes();
}

/// "FIRST COUNT": so many frames.
std::string make_images(const sandbox::SealedCopy& copy, std::string_view request) {
  const auto first = take_number(request);
  if (!first || !request.starts_with(' ')) refuse_request(copy);
  request.remove_prefix(1);
  const auto count = take_number(request);
  if (!count || !request.empty()) refuse_request(copy);
  const session::Images images = session::read_images(copy, {*first, *count});
  std::vector<std::uint8_t> bytes;
  bytes.reserve(images.frames.size() * image_bytes);
  for (const ThermalFrame& frame : images.frames) append_image(bytes, frame, images.mirrored);
  return {bytes.begin(), bytes.end()};
}

constexpr std::array<sandbox::Task, 2> all_tasks{make_overview, make_images};

}  // namespace

std::vector<sandbox::Task> tasks() {
  return {all_tasks.begin(), all_tasks.end()};
}

SessionView::SessionView(const std::filesystem::path& path, std::uint64_t every) : copy_(path) {
  session::require_whole(copy_);
  const std::string request = fmt::format("{} {}", every, path.filename().string());
  const std::string answer =
      ask(overview_task, request.substr(0, sandbox::request_bytes_max), overview_bytes_max);
  OverviewHead head;
  if (answer.size() < sizeof head) sandbox::refuse(path, "is damaged or hostile: its reader said too little");
  std::memcpy(&head, answer.data(), sizeof head);
  if (answer.size() >= overview_bytes_max)
    sandbox::refuse(path, fmt::format("has more rows than a page can show: over {} MiB of them",
                                      overview_bytes_max >> 20U));
  if (head.facts_bytes > answer.size() - sizeof head)
    sandbox::refuse(path, "is damaged or hostile: its reader said too little");
  frames_ = head.frames;
  facts_ = answer.substr(sizeof head, head.facts_bytes);
  rows_ = answer.substr(sizeof head + head.facts_bytes);
}

std::string SessionView::images(session::FrameRange range) const {
  if (range.count > session::most_images || range.first > frames_ || range.count > frames_ - range.first)
    sandbox::refuse(copy_.path(),
                    fmt::format("has no frames {} to {}", range.first, range.first + range.count));
  const std::uint64_t bytes = range.count * image_bytes;
  std::string answer = ask(images_task, fmt::format("{} {}", range.first, range.count), bytes);
  if (answer.size() != bytes)
    sandbox::refuse(copy_.path(),
                    "is damaged or hostile: its reader sent other images than it was asked for");
  return answer;
}

std::string SessionView::ask(std::size_t task, const std::string& request, std::uint64_t bytes_max) const {
  if (!sandbox::is_started()) return all_tasks.at(task)(copy_, request);
  sandbox::Answer answer = sandbox::ask(copy_, session::first_other_task + task, request, bytes_max);
  sandbox::require_done(answer, copy_);
  return std::move(answer.bytes);
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
