// SPDX-License-Identifier: MIT
#include "facts.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "thermorig/storage/session/annotations.h"

namespace thermorig::view {

namespace {

using nlohmann::json;
using session::Rows;
using session::Session;

/// More are told of by their number alone.
constexpr std::size_t most_listed = 5000;

json number(double value) {
  return std::isfinite(value) ? json(value) : json();
}

template <typename Rows_, typename Object>
json list_of(const Rows_& rows, Object object) {
  json list = json::array();
  for (std::size_t i = 0; i < rows.size() && i < most_listed; ++i) list.push_back(object(rows[i]));
  return list;
}

template <std::size_t size>
json words(const std::array<std::string_view, size>& names) {
  json list = json::array();
  for (const std::string_view name : names) list.push_back(std::string(name));
  return list;
}

json header_json(const Session& session) {
  const RecordingHeader& header = session.raw.header;
  const session::Place place = session::place_of(session);
  return {{"environment", place.environment},
          {"acquisition", place.acquisition},
          {"start_utc", header.start_time_utc},
          {"simulated", header.simulated},
          {"simulation", header.simulation},
          {"seed", header.simulation_seed ? json(*header.simulation_seed) : json()},
          {"plan", header.plan_name},
          {"frames_per_leg", header.frames_per_leg},
          {"licence", header.licence},
          {"operator", header.operator_name},
          {"place", header.place},
          {"note", header.note},
          {"creator", header.creator},
          {"firmware", header.firmware},
          {"model", header.live_model.name}};
}

json legs_json(const Session& session) {
  const HostTime begin = session.raw.header.time_reference;
  return list_of(session.raw.legs, [begin](const LegRecord& leg) -> json {
    return {{"leg", leg.leg},
            {"rate_dps", number(leg.rate_dps)},
            {"begin_s", to_s(leg.begin - begin)},
            {"end_s", to_s(leg.end - begin)},
            {"complete", leg.complete}};
  });
}

json events_json(const Session& session) {
  const HostTime begin = session.raw.header.time_reference;
  return list_of(session.raw.events, [begin](const RecordingEvent& event) -> json {
    return {{"time_s", to_s(event.time - begin)},
            {"kind", std::string(event_kind_names[static_cast<std::size_t>(event.kind)])},
            {"source", event.source ? std::string(name_of(*event.source)) : "host"},
            {"message", event.message}};
  });
}

json annotations_json(const Session& session) {
  return list_of(session.annotations, [](const Annotation& annotation) -> json {
    json object{{"kind", std::string(annotation_kind_names[static_cast<std::size_t>(annotation.kind)])},
                {"made_utc", annotation.made_utc},
                {"text", annotation.text}};
    if (annotation.kind == AnnotationKind::exclusion) {
      object["begin_s"] = annotation.begin_s;
      object["end_s"] = annotation.end_s;
    }
    return object;
  });
}

json estimators_json(const Session& session) {
  return list_of(session.raw.header.estimators, [](const EstimatorColumn& column) -> json {
    return {{"name", column.name}, {"values", column.values}};
  });
}

/// How many frames are valid, and what stands against the others.
json counts_json(const Session& session) {
  std::uint64_t valid = 0, swept = 0;
  for (const LabelledSample& sample : session.samples) {
    valid += sample.valid ? 1 : 0;
    swept += sample.leg != 0 || !session.raw.header.profile.servo.is_there() ? 1 : 0;
  }
  return {{"frames", session.samples.size()}, {"frames_swept", swept}, {"frames_valid", valid}};
}

json sync_json(const Session& session) {
  const GyroErrors& gyro = session.sync.gyro;
  return {{"gyro_bias_dps", gyro.bias_dps ? number(gyro.bias_dps->value) : json()},
          {"gyro_bias_moves", !gyro.bias_course.empty()},
          {"gyro_scale", number(gyro.scale.value)}};
}

}  // namespace

std::string facts_json(const std::string& file, const Rows& rows, const Columns& columns) {
  const Session& session = rows.session;
  json facts = header_json(session);
  facts.update(counts_json(session));
  facts.update(sync_json(session));
  facts.update({{"file", file},
                {"state", session::name_of(session.state)},
                {"duration_s", to_s(session.raw.end_time - session.raw.header.time_reference)},
                {"frame_period_s", number(session.frame_period_s)},
                {"camera_mode", session.camera_mode},
                {"verdict", rows.verdict},
                {"verdict_reasons", rows.verdict_reasons},
                {"verdict_altered", rows.verdict_altered},
                {"legs", legs_json(session)},
                {"leg_count", session.raw.legs.size()},
                {"events", events_json(session)},
                {"event_count", session.raw.events.size()},
                {"annotations", annotations_json(session)},
                {"estimators", estimators_json(session)},
                {"reason_names", words(reason_names)},
                {"warning_bits", warning_bits},
                {"state_names", words(estimate_state_names)},
                {"estimate_reason_names", words(estimate_reason_names)}});
  facts["rows_every"] = columns.every();
  facts["columns"] = list_of(columns.names(), [](const ColumnName& column) -> json {
    return {{"name", column.name}, {"type", std::string(column.type)}};
  });
  return facts.dump(-1, ' ', true, json::error_handler_t::replace);
}

}  // namespace thermorig::view
