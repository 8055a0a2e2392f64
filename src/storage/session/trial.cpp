// SPDX-License-Identifier: MIT
#include "thermorig/storage/session/trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>
#include <utility>

#include "file_image.h"
#include "tasks.h"
#include "thermorig/core/count_text.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/sandbox/refusal.h"
#include "thermorig/storage/sandbox/sandbox.h"

namespace thermorig::session {

namespace {

constexpr std::size_t reading = 0;
constexpr std::size_t naming_altered = 1;
constexpr std::size_t salvaging = 2;
// Of a file that says that it ought to have a thousand times as many bytes nothing can be left.
constexpr std::uint64_t largest_share = 1000;

std::string read_it(const sandbox::SealedCopy& copy, std::string_view /*request*/) {
  read_for_nothing(copy);
  return "";
}

/// A line each.
std::string name_altered(const sandbox::SealedCopy& copy, std::string_view /*request*/) {
  std::string lines;
  for (const std::string& path : altered_in(copy)) lines += path + "\n";
  return lines;
}

/// The request: how many bytes there are.
std::string salvage_it(const sandbox::SealedCopy& copy, std::string_view request) {
  std::uint64_t bytes_there = 0;
  std::from_chars(request.data(), request.data() + request.size(), bytes_there);
  salvaged_from(copy, bytes_there);
  return "";
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

void try_sessions_first(const std::vector<sandbox::Task>& others) {
  std::vector<sandbox::Task> tasks{read_it, name_altered, salvage_it};
  static_assert(salvaging + 1 == first_other_task);
  tasks.insert(tasks.end(), others.begin(), others.end());
  sandbox::start(std::move(tasks));
}

sandbox::SealedCopy tried_copy(const std::filesystem::path& path) {
  return tried(sandbox::SealedCopy(path));
}

sandbox::SealedCopy tried(sandbox::SealedCopy copy) {
  require_whole(copy);
  if (sandbox::is_started()) sandbox::require_done(sandbox::ask(copy, reading), copy);
  return copy;
}

void require_readable(const sandbox::SealedCopy& copy) {
  require_whole(copy);
  if (!sandbox::is_started()) return read_for_nothing(copy);
  sandbox::require_done(sandbox::ask(copy, reading), copy);
}

Salvaged salvage(const sandbox::SealedCopy& copy) {
  const std::uint64_t whole = stated_end(copy.bytes()), there = copy.bytes().size();
  const auto read_padded = [&](std::uint64_t offset, std::span<std::byte> out) {
    const auto left = copy.bytes().subspan(std::min<std::uint64_t>(offset, there));
    std::ranges::fill(out, std::byte{0});
    std::ranges::copy(left.first(std::min(left.size(), out.size())), out.begin());
  };
  if (whole / largest_share > there)
    sandbox::refuse(copy.path(), "was cut short, and too little is left to make anything of it");
  const sandbox::SealedCopy padded(std::max(whole, there), read_padded, copy.path());
  if (sandbox::is_started())
    sandbox::require_done(sandbox::ask(padded, salvaging, std::to_string(there)), padded);
  Salvaged left = salvaged_from(padded, there);
  left.bytes_missing = padded.bytes().size() - there;
  const bool has_frames = left.raw.received[Device::camera].chunk_count() > 0;
  if (!has_frames)
    sandbox::refuse(copy.path(),
                    fmt::format("was cut short before the raw data of its camera: {} of {} bytes "
                                "are there",
                                count_text(there), count_text(whole)));
  return left;
}

bool is_cut_short(const sandbox::SealedCopy& copy) {
  return stated_end(copy.bytes()) > copy.bytes().size();
}

void require_whole(const sandbox::SealedCopy& copy) {
  if (!is_cut_short(copy)) return;
  throw Error(ExitCode::not_a_session,
              fmt::format("was cut short: {} of {} bytes are there", count_text(copy.bytes().size()),
                          count_text(stated_end(copy.bytes()))),
              copy.path().string(),
              "copy it again; if this is all there is: thermorig recover " + copy.path().string());
}

std::vector<std::string> altered_attributes(const sandbox::SealedCopy& copy) {
  if (!sandbox::is_started()) return altered_in(copy);
  const sandbox::Answer answer = sandbox::ask(copy, naming_altered);
  sandbox::require_done(answer, copy);
  return lines_of(answer.bytes);
}

}  // namespace thermorig::session
