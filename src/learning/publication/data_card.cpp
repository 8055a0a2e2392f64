// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "descriptions.h"
#include "thermorig/core/printable.h"

namespace thermorig::publication {

namespace {

/// Text from sessions and people as it is, not as Markdown or HTML.
std::string plain(const std::string& text) {
  std::string escaped;
  for (const char c : printable(text)) {
    if (std::string_view("\\`*_{}[]<>|#").find(c) != std::string_view::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string share_of(std::uint64_t part, std::uint64_t all) {
  return all == 0 ? "-"
                  : fmt::format("{:.1f} %", 100.0 * static_cast<double>(part) / static_cast<double>(all));
}

std::string origin_section(const Totals& totals) {
  if (totals.simulated == 0) return "All recordings are of real hardware: none is simulated.";
  if (totals.simulated == totals.sessions)
    return "**All recordings are SIMULATED.** No hardware was involved: they say nothing of how well "
           "anything does on a "
           "real rig.";
  return fmt::format(
      "**{} of {} recordings are SIMULATED**, without any hardware; `manifest.json` says which (`simulated`, "
      "`world`). Do not mix them up with the others.",
      totals.simulated, totals.sessions);
}

std::string environments_section(const std::vector<Entry>& entries) {
  std::map<std::string, std::vector<Entry>> by_environment;
  for (const Entry& entry : entries)
    if (!entry.session.for_calibration) by_environment[entry.session.place.environment].push_back(entry);
  std::string text =
      "| environment | recordings | minutes | frames within legs | valid | of a simulated rig |\n"
      "| --- | ---: | ---: | ---: | ---: | ---: |\n";
  for (const auto& [environment, of_it] : by_environment) {
    const Totals totals = totals_of(of_it);
    text += fmt::format("| {} | {} | {:.1f} | {} | {} | {} |\n", plain(environment), totals.sessions,
                        totals.duration_s / 60.0, totals.swept, totals.valid, totals.simulated);
  }
  std::set<std::string> places;
  for (const Entry& entry : entries)
    if (!entry.session.header.place.empty()) places.insert(plain(entry.session.header.place));
  if (!places.empty()) text += fmt::format("\nPlaces: {}.\n", fmt::join(places, "; "));
  return text;
}

std::string measured(const std::string& utc) {
  return utc.empty() ? "assumed" : "measured " + utc.substr(0, utc.find('T'));
}

std::string rigs_section(const std::vector<Entry>& entries) {
  std::set<std::string> lines;
  for (const Entry& entry : entries) {
    const RigProfile& rig = entry.session.header.profile;
    lines.insert(fmt::format(
        "| {} | {}, {} Hz, {} deg | {}, {} Hz | {} | latency {}, gyro scale {}, servo scale {} |\n",
        plain(rig.name), plain(rig.camera.model), rig.camera.output_rate_hz, rig.camera.field_of_view_deg,
        plain(rig.gyro.model), rig.gyro.output_rate_hz, plain(rig.servo.model),
        measured(rig.camera.link.latency_measured_utc), measured(rig.gyro.scale_measured_utc),
        measured(rig.servo.scale_measured_utc)));
  }
  return fmt::format("| rig | camera | gyro | servo | calibration |\n| --- | --- | --- | --- | --- |\n{}",
                     fmt::join(lines, ""));
}

std::string splits_section(const std::vector<Entry>& entries) {
  const std::vector<Fold> folds = leave_one_out(entries);
  if (folds.empty()) return "There is one environment: nothing can be left out.\n";
  std::string text =
      "`splits.json` leaves one environment out at a time. Frames of one recording must never be in training "
      "and test "
      "at once: windows overlap, and a recording is one scene.\n\n"
      "| test | recordings to learn from | to be judged by |\n| --- | ---: | ---: |\n";
  for (const Fold& fold : folds)
    text +=
        fmt::format("| {} | {} | {} |\n", plain(fold.environment), fold.training.size(), fold.test.size());
  return text;
}

/// What somebody who uses the data should know before.
std::vector<std::string> flaws_of(const Terms& terms, const std::vector<Entry>& entries) {
  std::vector<std::string> flaws;
  const Totals totals = totals_of(entries);
  flaws.push_back(
      fmt::format("{} of {} frames within legs are not valid. Their reasons are counted below; "
                  "a frame may have several.",
                  totals.swept - totals.valid, totals.swept));
  for (const Entry& entry : entries)
    if (entry.session.quality.verdict != "good")
      flaws.push_back(
          fmt::format("{}: {}: {}.", plain(entry.path), entry.session.quality.verdict,
                      plain(fmt::format("{}", fmt::join(entry.session.quality.verdict_reasons, "; ")))));
  const auto is_assumed = [](const Entry& entry) {
    return entry.session.header.profile.gyro.scale_measured_utc.empty();
  };
  const auto assumed = std::count_if(entries.begin(), entries.end(), is_assumed);
  if (assumed > 0)
    flaws.push_back(fmt::format(
        "In {} recordings the gyro's scale is that of a data sheet: it may be off by 3 %.", assumed));
  if (licence_of(terms, entries).empty())
    flaws.push_back("No licence is stated: nobody may use the data without asking.");
  flaws.push_back("Nothing measures the shaft: labels are commanded speeds, and a servo model's.");
  return flaws;
}

std::string flaws_section(const Terms& terms, const std::vector<Entry>& entries) {
  std::string text;
  for (const std::string& flaw : flaws_of(terms, entries)) text += "- " + flaw + "\n";
  const Totals totals = totals_of(entries);
  text += "\n| reason | frames within legs | share |\n| --- | ---: | ---: |\n";
  for (const auto& [reason, count] : totals.reasons)
    text += fmt::format("| {} | {} | {} |\n", plain(reason), count, share_of(count, totals.swept));
  return text;
}

std::string notes_section(const std::vector<Entry>& entries) {
  std::string text;
  for (const Entry& entry : entries)
    for (const std::string& note : entry.session.notes)
      text += fmt::format("- {}: {}\n", plain(entry.path), plain(note));
  return text.empty() ? "" : "## Notes of the operators\n\n" + text + "\n";
}

std::string use_section(const Totals& totals) {
  return fmt::format(
      "{} recordings, {} for calibrations, {:.1f} MB. Each is an HDF5 file of the program "
      "thermorig, which describes the format.\n\n"
      "```sh\nthermorig dataset verify .       # or: sha256sum -c SHA256SUMS\nthermorig list .\nthermorig "
      "inspect .\n"
      "```\n",
      totals.sessions, totals.calibrations, static_cast<double>(totals.bytes) / 1e6);
}

}  // namespace

std::string card_text(const Terms& terms, const std::vector<Entry>& entries) {
  const Totals totals = totals_of(entries);
  const std::string licence = licence_of(terms, entries);
  std::vector<std::string> authors;
  for (const std::string& author : terms.authors) authors.push_back(plain(author));
  std::string text = fmt::format("# {}\n\n{}\n\n", plain(terms.title), plain(description_of(terms, entries)));
  text += fmt::format(
      "Version {}, {}. Licence: {}. Authors: {}. How to cite: `CITATION.cff`.\n\n", plain(terms.version),
      plain(terms.date), licence.empty() ? "**not stated**" : plain(licence),
      authors.empty() ? "not given (use --author)" : fmt::format("{}", fmt::join(authors, ", ")));
  text += fmt::format("## Simulated or real\n\n{}\n\n## Where\n\n{}\n## With what\n\n{}\n## Files\n\n{}\n",
                      origin_section(totals), environments_section(entries), rigs_section(entries),
                      use_section(totals));
  text += fmt::format("## Splits\n\n{}\n## Known flaws\n\n{}\n", splits_section(entries),
                      flaws_section(terms, entries));
  return text + notes_section(entries);
}

}  // namespace thermorig::publication
