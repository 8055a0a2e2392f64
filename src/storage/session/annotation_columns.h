// SPDX-License-Identifier: MIT
#pragma once

#include "column.h"
#include "device_columns.h"
#include "thermorig/core/annotation.h"
#include "thermorig/storage/session/annotations.h"

namespace thermorig::session {

/// /annotations: what was said of a recording afterwards, in that order. Archive is GroupWriter or
/// GroupReader.
template <typename Archive, typename Rows>
void annotation_columns(Archive& archive, Rows& annotations) {
  archive.bare_axis("annotation", "annotation, in the order in which they were made", annotations, "kind",
                    most_annotations);
  archive.template column<std::uint8_t>(
      {"kind", "1", "what it says", "", flag_values(annotation_kind_names)}, annotations,
      [](const auto& row) { return row.kind; },
      [](auto& row, std::uint8_t value) { row.kind = checked_enum(value, last_annotation_kind); });
  archive.texts({"made_utc", "1", "when it was made, UTC"}, annotations, &Annotation::made_utc);
  archive.texts({"text", "1", "the note, the name of the environment, or why it is excluded"}, annotations,
                &Annotation::text);
  archive.template field<std::int32_t>(
      {"acquisition", "1", "number within the environment", "0: it names no environment"}, annotations,
      &Annotation::acquisition);
  archive.template field<double>(
      {"begin", "s", "begin of what is excluded, since time_reference [s]", "0 where nothing is"},
      annotations, &Annotation::begin_s);
  archive.template field<double>(
      {"end", "s", "end of what is excluded, since time_reference [s]", "0 where nothing is"}, annotations,
      &Annotation::end_s);
}

}  // namespace thermorig::session
