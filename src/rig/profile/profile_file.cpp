// SPDX-License-Identifier: MIT
#include "thermorig/rig/profile/profile_file.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <system_error>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/io/files/replaced_file.h"
#include "thermorig/rig/profile/toml_table.h"
#include "thermorig/rig/profile/toml_text.h"
#include "thermorig/storage/recording_header/profile_fields.h"

namespace thermorig::rig {

namespace {

using recording_header::FieldValue;
using recording_header::ProfileField;
using recording_header::ProfileProblem;

std::optional<FieldValue> value_in(TomlTable& table, const ProfileField& field) {
  if (std::holds_alternative<bool>(field.standard)) return table.boolean(field.name);
  if (std::holds_alternative<std::int64_t>(field.standard))
    return table.integer(field.name, std::llround(field.min), std::llround(field.max));
  if (std::holds_alternative<double>(field.standard)) return table.number(field.name, field.min, field.max);
  return table.text(field.name);
}

/// The tables of a text, by the names that fields have for them.
class TomlTables {
 public:
  explicit TomlTables(TomlTable root) { tables_.emplace("", std::move(root)); }

  /// "gyro.text" is a table within "gyro".
  TomlTable& operator[](const std::string& name) {
    if (const auto found = tables_.find(name); found != tables_.end()) return found->second;
    const std::size_t dot = name.rfind('.');
    TomlTable& parent = (*this)[dot == std::string::npos ? "" : name.substr(0, dot)];
    return tables_.emplace(name, parent.table(name.substr(dot + 1))).first->second;
  }

  void refuse_unknown() const {
    for (const auto& [name, table] : tables_) table.refuse_unknown();
  }

 private:
  std::map<std::string, TomlTable> tables_;
};

std::string toml_value(const FieldValue& value) {
  if (const auto* const text = std::get_if<std::string>(&value)) return toml_quoted(*text);
  return std::visit([](const auto& plain) { return fmt::format("{}", plain); }, value);
}

const std::filesystem::path& with_folder(const std::filesystem::path& path) {
  std::error_code failure;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), failure);
  if (!failure) return path;
  throw Error(ExitCode::storage,
              "the rig profile cannot be written: its folder cannot be made: " + failure.message(),
              path.string(), files::usual_advice(failure.value()));
}

files::ReplacedFile locked(const std::filesystem::path& path) {
  files::ReplacedFile file(with_folder(path), "the rig profile");
  file.lock();
  return file;
}

}  // namespace

RigProfile parse_profile(const std::string& text, const std::string& file_name) {
  TomlTable root = TomlTable::parse(text, file_name);
  if (root.is_empty())
    throw Error(ExitCode::bad_usage, "this rig profile says nothing: there is no key in it", file_name,
                "thermorig ports --save NAME writes a whole one");
  TomlTables tables(std::move(root));
  RigProfile profile = recording_header::profile_from(
      [&](const ProfileField& field) { return value_in(tables[field.table], field); },
      [&](const ProfileProblem& problem) {
        tables[problem.table].refuse(problem.name, problem.what, problem.allowed);
      });
  tables.refuse_unknown();
  return profile;
}

RigProfile read_profile(const std::filesystem::path& path) {
  return parse_profile(read_text_file(path.string(), "rig profile"), path.string());
}

std::string profile_text(const RigProfile& profile) {
  std::string text = "# A rig of thermorig: what is connected, and how. Keys may be left out.\n";
  std::string table;
  recording_header::for_each_field(profile, [&](const ProfileField& field, const FieldValue& value) {
    if (field.table != table) text += fmt::format("\n[{}]\n", field.table);
    table = field.table;
    const std::string line = fmt::format("{} = {}", field.name, toml_value(value));
    text += fmt::format("{:<32}  # {}\n", line, field.help);
  });
  return text;
}

ProfileFile::ProfileFile(const std::filesystem::path& path) : part_(locked(path)) {
  part_.reserve(profile_text(RigProfile()).size());
}

void ProfileFile::write(const RigProfile& profile) {
  const std::string text = profile_text(profile);
  part_.write(std::as_bytes(std::span(text)));
  part_.sync();
  part_.publish();
}

void require_profile_storage(const std::filesystem::path& path) {
  std::error_code hidden;
  if (std::filesystem::exists(path, hidden)) read_profile(path);
  const ProfileFile file(path);
}

void write_profile(const std::filesystem::path& path, const RigProfile& profile) {
  ProfileFile(path).write(profile);
}

}  // namespace thermorig::rig
