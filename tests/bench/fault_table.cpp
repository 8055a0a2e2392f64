// SPDX-License-Identifier: MIT
// Every kind of fault of a disk, at every call of a recording of 200 frames and of its recovery: what is
// left, held against what had been received. See docs/evidence/reliability.md.
#include <fmt/format.h>
#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "storage/enumeration.h"

namespace {

using namespace thermorig::storage_test;

struct Options {
  EnumerationSettings settings;
  int frames = 200;
  unsigned jobs = 2;
  bool json = false;
};

nlohmann::json json_of(const Enumeration& enumeration) {
  nlohmann::json lines = nlohmann::json::array();
  for (const auto& [name, tally] : enumeration.lines)
    lines.push_back({{"fault", name},
                     {"points", tally.points},
                     {"clean", tally.outcomes[0]},
                     {"loud", tally.outcomes[1]},
                     {"beyond", tally.outcomes[2]},
                     {"silent", tally.outcomes[3]},
                     {"worst_loss_ms", tally.worst_loss_ms},
                     {"example", tally.example}});
  return {{"lines", lines}, {"recoveries", enumeration.recoveries}, {"readings", enumeration.readings}};
}

Enumeration enumeration_of(const nlohmann::json& json) {
  Enumeration enumeration;
  enumeration.recoveries = json["recoveries"];
  enumeration.readings = json["readings"];
  for (const auto& line : json["lines"]) {
    Tally& tally = enumeration.lines[line["fault"]];
    tally.points = line["points"];
    tally.outcomes = {line["clean"], line["loud"], line["beyond"], line["silent"]};
    tally.worst_loss_ms = line["worst_loss_ms"];
    tally.example = line["example"];
  }
  return enumeration;
}

/// Each part in a process of its own: HDF5 does one thing at a time in one.
std::FILE* start(const RecordedSession& session, EnumerationSettings settings, unsigned part) {
  int ends[2];
  if (::pipe(ends) != 0) std::abort();
  if (::fork() == 0) {
    ::close(ends[0]);
    settings.part = part;
    const std::string text = json_of(enumerate(session, settings)).dump();
    std::FILE* const out = ::fdopen(ends[1], "w");
    std::fputs(text.c_str(), out);
    std::fclose(out);
    std::_Exit(0);
  }
  ::close(ends[1]);
  return ::fdopen(ends[0], "r");
}

Enumeration finish(std::FILE* in) {
  std::string text;
  std::array<char, 4096> some;
  for (std::size_t count = 0; (count = std::fread(some.data(), 1, some.size(), in)) > 0;)
    text.append(some.data(), count);
  std::fclose(in);
  int status = 0;
  ::wait(&status);
  if (status != 0 || text.empty()) {
    fmt::print(stderr, "fault_table: a part of the enumeration died (status {})\n", status);
    std::exit(1);
  }
  return enumeration_of(nlohmann::json::parse(text));
}

void print_table(const Enumeration& sum) {
  fmt::print("{:<62} {:>7} {:>7} {:>7} {:>7} {:>7} {:>9}\n", "fault", "points", "clean", "loud", "beyond",
             "silent", "lost, ms");
  for (const auto& [name, tally] : sum.lines)
    fmt::print("{:<62} {:>7} {:>7} {:>7} {:>7} {:>7} {:>9}\n", name, tally.points, tally.outcomes[0],
               tally.outcomes[1], tally.outcomes[2], tally.outcomes[3],
               tally.worst_loss_ms > 0 ? fmt::format("{:.0f}", tally.worst_loss_ms) : "");
  for (const auto& [name, tally] : sum.lines)
    if (!tally.example.empty()) fmt::print("! {}: {}\n", name, tally.example);
}

int run(const Options& options) {
  // Megabytes are made and dropped at every point: the system is not asked for each of them.
  ::mallopt(M_MMAP_THRESHOLD, 1 << 30);
  ::mallopt(M_TRIM_THRESHOLD, 1 << 30);
  const auto begin = std::chrono::steady_clock::now();
  const RecordedSession session = record_session(options.frames);
  EnumerationSettings settings = options.settings;
  settings.parts = options.jobs;
  std::vector<std::FILE*> parts;
  for (unsigned part = 0; part < options.jobs; ++part) parts.push_back(start(session, settings, part));
  Enumeration sum;
  for (std::FILE* const part : parts) add(sum, finish(part));
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const auto points = points_of(sum);
  const auto silent = count_of(sum, Outcome::silent), beyond = count_of(sum, Outcome::beyond);
  if (options.json) {
    nlohmann::json json = json_of(sum);
    json["frames"] = session.frames;
    json["calls"] = session.calls.size();
    json["points"] = points;
    json["clean"] = count_of(sum, Outcome::clean);
    json["loud"] = count_of(sum, Outcome::loud);
    json["beyond"] = beyond;
    json["silent"] = silent;
    json["took_s"] = took_s;
    fmt::print("{}\n", json.dump(2));
  } else {
    print_table(sum);
    fmt::print(
        "\n{} frames, {} calls; {} crash points: {} clean, {} loud, {} beyond the promise, {} silent;\n"
        "{} different disks, {} of them recovered to a session; {:.0f} s\n",
        session.frames, session.calls.size(), points, count_of(sum, Outcome::clean),
        count_of(sum, Outcome::loud), beyond, silent, sum.readings, sum.recoveries, took_s);
  }
  return silent + beyond == 0 ? 0 : 1;
}

Options options_of(int count, char** words) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const auto value = [&] { return i + 1 < count ? std::string(words[++i]) : std::string(); };
    if (word == "--json")
      options.json = true;
    else if (word == "--share")
      options.settings.share = std::stod(value());
    else if (word == "--seed")
      options.settings.seed = std::stoull(value());
    else if (word == "--jobs")
      options.jobs = static_cast<unsigned>(std::stoul(value()));
    else if (word == "--starts")
      options.settings.starts = std::stoul(value());
    else if (word == "--error-stride")
      options.settings.error_stride = std::stoul(value());
    else if (word == "--recover-stride")
      options.settings.recover_stride = std::stoul(value());
    else if (word == "--samples")
      options.settings.samples = value();
    else if (word == "--without-sync")
      options.settings.mutation = Mutation::no_sync;
    else if (word == "--without-folder-sync")
      options.settings.mutation = Mutation::no_folder_sync;
    else {
      fmt::print(
          stderr,
          "usage: fault_table [--json] [--share 0..1] [--seed N] [--jobs N] [--starts N] [--error-stride N] "
          "[--recover-stride N] [--samples DIR] [--without-sync] [--without-folder-sync]\n");
      std::exit(2);
    }
  }
  return options;
}

}  // namespace

int main(int count, char** words) {
  return run(options_of(count, words));
}
