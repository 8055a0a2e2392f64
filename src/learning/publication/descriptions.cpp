// SPDX-License-Identifier: MIT
#include "descriptions.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "sha256.h"
#include "thermorig/core/code_point.h"

namespace thermorig::publication {

namespace {

using Json = nlohmann::ordered_json;

/// Text from sessions is shown as it is; what is no UTF-8 is replaced.
std::string pretty(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json or_null(const std::string& text) {
  return text.empty() ? Json() : Json(text);
}

Json calibrations_of(const RigProfile& profile) {
  return {{"orientation", or_null(profile.camera.orientation_measured_utc)},
          {"lens", or_null(profile.camera.lens_measured_utc)},
          {"camera_latency", or_null(profile.camera.link.latency_measured_utc)},
          {"gyro_scale", or_null(profile.gyro.scale_measured_utc)},
          {"gyro_bias", or_null(profile.gyro.bias_measured_utc)},
          {"servo_scale", or_null(profile.servo.scale_measured_utc)}};
}

Json rig_of(const RigProfile& profile) {
  return {{"name", profile.name},
          {"camera", profile.camera.model},
          {"camera_rate_hz", profile.camera.output_rate_hz},
          {"field_of_view_deg", profile.camera.field_of_view_deg},
          {"gyro", profile.gyro.model},
          {"gyro_rate_hz", profile.gyro.output_rate_hz},
          {"servo", profile.servo.model},
          {"calibrated_utc", calibrations_of(profile)}};
}

Json session_of(const Entry& entry) {
  const dataset::ListedSession& session = entry.session;
  return {{"path", entry.path},
          {"bytes", entry.bytes},
          {"sha256", entry.sha256},
          {"uuid", session.header.uuid},
          {"environment", session.place.environment},
          {"acquisition", session.place.acquisition},
          {"start_time", session.header.start_time_utc},
          {"duration_s", session.quality.duration_s},
          {"plan", session.header.plan_name},
          {"for_calibration", session.for_calibration},
          {"simulated", session.header.simulated},
          {"world", or_null(dataset::world_of(session.header))},
          {"verdict", session.quality.verdict},
          {"verdict_reasons", session.quality.verdict_reasons},
          {"frames", session.quality.frames},
          {"frames_swept", session.quality.swept},
          {"frames_valid", session.quality.valid},
          {"licence", or_null(session.header.licence)},
          {"place", or_null(session.header.place)},
          {"notes", session.notes},
          {"rig", rig_of(session.header.profile)}};
}

Json field_of(const char* name, const char* type) {
  return {{"@type", "cr:Field"},
          {"@id", fmt::format("sessions/{}", name)},
          {"name", fmt::format("sessions/{}", name)},
          {"dataType", type},
          {"source",
           {{"fileObject", {{"@id", "manifest.json"}}},
            {"extract", {{"jsonPath", fmt::format("$.sessions[*].{}", name)}}}}}};
}

Json file_of(const std::string& path, const char* type, std::uint64_t bytes, const std::string& sha256) {
  return {{"@type", "cr:FileObject"},
          {"@id", path},
          {"name", path},
          {"contentUrl", path},
          {"contentSize", fmt::format("{} B", bytes)},
          {"encodingFormat", type},
          {"sha256", sha256}};
}

/// The context that the specification asks for.
Json context() {
  Json context{{"@language", "en"}, {"@vocab", "https://schema.org/"}};
  for (const char* name :
       {"citeAs",   "column",      "extract",   "field",         "fileProperty", "fileObject",
        "fileSet",  "format",      "includes",  "isLiveDataset", "jsonPath",     "key",
        "md5",      "parentField", "path",      "recordSet",     "references",   "regex",
        "repeated", "replace",     "separator", "source",        "subField",     "transform"})
    context[name] = std::string("cr:") + name;
  context["conformsTo"] = "dct:conformsTo";
  context["cr"] = "http://mlcommons.org/croissant/";
  context["rai"] = "http://mlcommons.org/croissant/RAI/";
  context["data"] = {{"@id", "cr:data"}, {"@type", "@json"}};
  context["dataType"] = {{"@id", "cr:dataType"}, {"@type", "@vocab"}};
  context["examples"] = {{"@id", "cr:examples"}, {"@type", "@json"}};
  context["dct"] = "http://purl.org/dc/terms/";
  context["sc"] = "https://schema.org/";
  return context;
}

Json people_of(const Terms& terms) {
  Json people = Json::array();
  for (const std::string& author : terms.authors)
    people.push_back({{"@type", "sc:Person"}, {"name", author}});
  return people;
}

std::string cite_as(const Terms& terms) {
  std::string authors;
  for (const std::string& author : terms.authors) authors += (authors.empty() ? "" : ", ") + author;
  return fmt::format("{}{}: {}, version {}, {}", authors, authors.empty() ? "" : ".", terms.title,
                     terms.version, terms.date);
}

/// A double-quoted string of YAML 1.2. JSON's would nearly do: but YAML's escapes are of whole characters,
/// and name none by two surrogates.
std::string yaml_text(std::string_view text) {
  std::string yaml = "\"";
  while (!text.empty()) {
    const auto next = first_character(text);
    const std::size_t bytes = next ? next->bytes : 1;
    const char32_t character = next ? next->code_point : 0xFFFD;  // what is no UTF-8
    if (character == U'"' || character == U'\\')
      yaml += fmt::format("\\{}", static_cast<char>(character));
    else if (!next || !is_plain(character))
      yaml += fmt::format("\\U{:08X}", static_cast<std::uint32_t>(character));
    else
      yaml += text.substr(0, bytes);
    text.remove_prefix(bytes);
  }
  return yaml + '"';
}

}  // namespace

Totals totals_of(const std::vector<Entry>& entries) {
  Totals totals;
  for (const Entry& entry : entries) {
    const session::Quality& quality = entry.session.quality;
    totals.bytes += entry.bytes;
    if (entry.session.for_calibration) {
      ++totals.calibrations;
      continue;
    }
    ++totals.sessions;
    totals.simulated += entry.session.header.simulated ? 1 : 0;
    totals.frames += quality.frames;
    totals.swept += quality.swept;
    totals.valid += quality.valid;
    totals.duration_s += quality.duration_s;
    for (const auto& [reason, count] : quality.reason_counts) totals.reasons[reason] += count;
  }
  return totals;
}

std::string description_of(const Terms& terms, const std::vector<Entry>& entries) {
  const Totals totals = totals_of(entries);
  const std::string origin = totals.simulated == 0                 ? "of a real rig"
                             : totals.simulated == totals.sessions ? "of a SIMULATED rig, all of them"
                                                                   : "some of a SIMULATED rig";
  const std::string facts = fmt::format(
      "{} recordings of a rotating 24 x 32 thermal camera with a gyro ({}), each frame labelled with the "
      "commanded "
      "speed over its exposure; {} valid frames.",
      totals.sessions, origin, totals.valid);
  return terms.description.empty() ? facts : terms.description + " " + facts;
}

std::string manifest_text(const Terms& terms, const std::vector<Entry>& entries) {
  const Totals totals = totals_of(entries);
  Json manifest{{"format", "thermorig-dataset"},
                {"format_version", "1.0.0"},
                {"title", terms.title},
                {"version", terms.version},
                {"date", terms.date},
                {"licence", or_null(licence_of(terms, entries))},
                {"authors", terms.authors},
                {"url", or_null(terms.url)},
                {"simulated_sessions", totals.simulated},
                {"sessions", Json::array()}};
  for (const Entry& entry : entries) manifest["sessions"].push_back(session_of(entry));
  return pretty(manifest);
}

std::string splits_text(const std::vector<Entry>& entries) {
  Json folds = Json::array();
  for (const Fold& fold : leave_one_out(entries))
    folds.push_back(
        {{"test_environment", fold.environment}, {"training", fold.training}, {"test", fold.test}});
  return pretty({{"kind", "leave one environment out"}, {"folds", folds}});
}

std::string citation_text(const Terms& terms, const std::vector<Entry>& entries) {
  std::string text = fmt::format(
      "cff-version: 1.2.0\nmessage: \"If you use these data, please cite them.\"\ntype: dataset\ntitle: {}\n"
      "abstract: {}\nversion: {}\ndate-released: {}\n",
      yaml_text(terms.title), yaml_text(description_of(terms, entries)), yaml_text(terms.version),
      yaml_text(terms.date));
  if (const std::string licence = licence_of(terms, entries); !licence.empty())
    text += fmt::format("license: {}\n", yaml_text(licence));
  if (!terms.url.empty()) text += fmt::format("url: {}\n", yaml_text(terms.url));
  text += "authors:\n";
  for (const std::string& author : terms.authors) text += fmt::format("  - name: {}\n", yaml_text(author));
  if (terms.authors.empty()) text += "  - name: \"not stated\"\n";
  return text;
}

std::string croissant_text(const Terms& terms, const std::vector<Entry>& entries,
                           const std::string& manifest) {
  Json files = Json::array();
  files.push_back(file_of("manifest.json", "application/json", manifest.size(), sha256_of(manifest)));
  for (const Entry& entry : entries)
    files.push_back(file_of(entry.path, "application/x-hdf5", entry.bytes, entry.sha256));
  Json fields = Json::array();
  for (const char* name : {"path", "environment", "plan", "verdict", "uuid", "start_time"})
    fields.push_back(field_of(name, "sc:Text"));
  for (const char* name : {"acquisition", "frames", "frames_valid"})
    fields.push_back(field_of(name, "sc:Integer"));
  fields.push_back(field_of("simulated", "sc:Boolean"));
  const std::string licence = licence_of(terms, entries);
  Json croissant{{"@context", context()},
                 {"@type", "sc:Dataset"},
                 {"name", terms.title},
                 {"description", description_of(terms, entries)},
                 {"conformsTo", "http://mlcommons.org/croissant/1.0"},
                 {"license", licence.empty() ? "not stated" : licence},
                 {"version", terms.version},
                 {"datePublished", terms.date},
                 {"citeAs", cite_as(terms)},
                 {"creator", people_of(terms)},
                 {"distribution", files},
                 {"recordSet",
                  {{{"@type", "cr:RecordSet"},
                    {"@id", "sessions"},
                    {"name", "sessions"},
                    {"key", {{"@id", "sessions/path"}}},
                    {"field", fields}}}}};
  if (!terms.url.empty()) croissant["url"] = terms.url;
  return pretty(croissant);
}

std::vector<Description> describe(const Terms& terms, const std::vector<Entry>& entries) {
  const std::string manifest = manifest_text(terms, entries);
  const auto& [manifest_name, splits_name, card_name, citation_name, croissant_name] = description_names;
  return {{manifest_name, manifest},
          {splits_name, splits_text(entries)},
          {card_name, card_text(terms, entries)},
          {citation_name, citation_text(terms, entries)},
          {croissant_name, croissant_text(terms, entries, manifest)}};
}

}  // namespace thermorig::publication
