// SPDX-License-Identifier: MIT
#include "annotation_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace thermorig::app {

std::string words_of(const Annotation& annotation) {
  const std::string day = annotation.made_utc.substr(0, annotation.made_utc.find('T'));
  switch (annotation.kind) {
    case AnnotationKind::note:
      break;
    case AnnotationKind::environment:
      return fmt::format("{}: belongs to {}, acquisition {}", day, annotation.text, annotation.acquisition);
    case AnnotationKind::exclusion:
      return fmt::format("{}: {}", day, exclusion_text(annotation));
  }
  return fmt::format("{}: {}", day, annotation.text);
}

std::string exclusion_text(const Annotation& annotation) {
  const std::string frames =
      annotation.is_of_all() ? "all frames" : fmt::format("{}..{} s", annotation.begin_s, annotation.end_s);
  return fmt::format("{} excluded{}{}", frames, annotation.text.empty() ? "" : ": ", annotation.text);
}

nlohmann::json annotation_json(const Annotation& annotation) {
  nlohmann::json object{{"kind", annotation_kind_names[static_cast<std::size_t>(annotation.kind)]},
                        {"made_utc", annotation.made_utc}};
  switch (annotation.kind) {
    case AnnotationKind::environment:
      object["environment"] = annotation.text;
      object["acquisition"] = annotation.acquisition;
      return object;
    case AnnotationKind::exclusion:
      object["begin_s"] = annotation.begin_s;
      object["end_s"] = annotation.end_s;
      break;
    case AnnotationKind::note:
      break;
  }
  object["text"] = annotation.text;
  return object;
}

}  // namespace thermorig::app
