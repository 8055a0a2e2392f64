// SPDX-License-Identifier: MIT
#include "thermorig/learning/dataset/session_list.h"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "for_each_file.h"

namespace thermorig::dataset {

namespace {

std::vector<std::string> notes_of(const session::Session& session) {
  std::vector<std::string> notes;
  if (!session.raw.header.note.empty()) notes.push_back(session.raw.header.note);
  for (const RecordingEvent& event : session.raw.events)
    if (event.kind == EventKind::mark) notes.push_back(event.message);
  for (const Annotation& annotation : session.annotations)
    if (annotation.kind == AnnotationKind::note) notes.push_back(annotation.text);
  return notes;
}

template <typename Open>
ListedSession listed(const std::filesystem::path& file, Open open) {
  ListedSession entry;
  entry.file = file;
  try {
    const auto [session, quality] = session::read_overview(open());
    entry.header = session.raw.header;
    entry.place = session::place_of(session);
    entry.quality = quality;
    entry.for_calibration = session::is_for_calibration(session.raw.header);
    std::copy_if(session.annotations.begin(), session.annotations.end(), std::back_inserter(entry.exclusions),
                 [](const Annotation& one) { return one.kind == AnnotationKind::exclusion; });
    entry.notes = notes_of(session);
  } catch (const Error& error) {
    entry.refusal = error;
  }
  return entry;
}

}  // namespace

std::vector<ListedSession> list_sessions(const std::vector<std::filesystem::path>& files,
                                         const ReadingProgress& progress, const OpenFile& open) {
  std::vector<ListedSession> list(files.size());
  for_each_file(
      files.size(),
      [&](std::size_t index) {
        list[index] =
            listed(files[index], [&] { return open ? open(index) : session::StoredFile(files[index]); });
      },
      progress);
  return list;
}

std::string world_of(const RecordingHeader& header) {
  constexpr std::string_view before = ", world ";
  const std::size_t at = header.simulated ? header.simulation.rfind(before) : std::string::npos;
  return at == std::string::npos ? "" : header.simulation.substr(at + before.size());
}

}  // namespace thermorig::dataset
