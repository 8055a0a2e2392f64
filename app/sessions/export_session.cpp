// SPDX-License-Identifier: MIT
#include "export_session.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <list>
#include <nlohmann/json.hpp>

#include "export_files.h"
#include "print/output.h"
#include "session_files.h"
#include "thermorig/io/spill/spill.h"
#include "thermorig/learning/dataset/dataset.h"
#include "thermorig/learning/interchange/formats.h"

namespace thermorig::app {

namespace {

using interchange::Sink;

/// One file that a session becomes.
struct Output {
  std::string ending;  // of its name, behind the session's: "-nf3-nr1.npz"
  std::function<void(Sink&)> write;
};

/// Standard output. Throws as soon as nobody takes it any more.
class StandardOutput final : public Sink {
 public:
  void write(std::span<const std::byte> bytes) override {
    write_to(stdout, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    if (std::ferror(stdout) != 0) require_printed();
  }
};

/// A session, and all that it is to become.
class SessionExport {
 public:
  explicit SessionExport(const ExportOptions& options)
      : options_(options), session_(session::read_session(options.file)) {
    if ((options.tum || options.mcap) && !interchange::has_unix_times(session_.raw))
      throw Error(ExitCode::check_failed,
                  fmt::format("its clock said {}, and times before 1970 and after 2262 cannot be written so",
                              session_.raw.header.start_time_utc),
                  options.file.string(), "--csv or --npz=rows, whose times count from its start");
    if (options.npz) add_npz();
    if (options.csv) add_csv();
    if (options.tum) add_tum();
    if (options.mcap) add_mcap();
  }

  void write_to_standard_output() const {
    if (outputs_.size() != 1 || options_.json)
      throw Error(ExitCode::bad_usage, "standard output takes one file, and nothing else", "-o -",
                  options_.json ? "leave out --json" : "ask for one form; of TUM for one, as --tum=shaft");
    StandardOutput output;
    outputs_.front().write(output);
    require_printed();
  }

  /// To be published by the caller.
  std::vector<std::filesystem::path> write_files(std::list<ExportFile>& files) const {
    std::vector<std::filesystem::path> paths;
    for (const Output& output : outputs_)
      paths.push_back(options_.output / (options_.file.stem().string() + output.ending));
    for (const auto& path : paths) require_new(path);
    for (std::size_t i = 0; i < outputs_.size(); ++i) outputs_[i].write(files.emplace_back(paths[i]));
    return paths;
  }

  bool is_simulated() const { return session_.raw.header.simulated; }

 private:
  void add_npz() {
    if (*options_.npz == "rows") {
      outputs_.push_back({"-rows.npz", [this](Sink& sink) { interchange::write_rows_npz(session_, sink); }});
      return;
    }
    const interchange::WindowShape shape{.frames = options_.frames.value_or(3),
                                         .reduction = options_.reduction.value_or(1)};
    outputs_.push_back(
        {fmt::format("-nf{}-nr{}.npz", shape.frames, shape.reduction), [this, shape](Sink& sink) {
           interchange::write_windows_npz(session_, acquisition(), shape, sink);
         }});
  }

  network::Acquisition acquisition() const {
    return dataset::acquisition_of(session_, dataset::name_of(session_));
  }

  void add_csv() {
    outputs_.push_back({fmt::format("-{}.csv", *options_.csv), [this](Sink& sink) {
                          interchange::write_csv(interchange::table_of(session_, *options_.csv), sink);
                        }});
  }

  void add_tum() {
    trajectories_ = interchange::trajectories_of(session_);
    std::vector<std::string> names;
    for (const interchange::Trajectory& trajectory : trajectories_) {
      names.push_back(trajectory.name);
      if (*options_.tum != "all" && *options_.tum != trajectory.name) continue;
      outputs_.push_back({fmt::format("-{}.tum", trajectory.name), [&](Sink& sink) {
                            interchange::write_tum(session_.raw.header, trajectory, sink);
                          }});
    }
    if (*options_.tum != "all" && std::find(names.begin(), names.end(), *options_.tum) == names.end())
      throw Error(ExitCode::bad_usage, fmt::format("the session has no trajectory \"{}\"", *options_.tum),
                  options_.file.string(), fmt::format("--tum={}", fmt::join(names, ", ")));
  }

  void add_mcap() {
    const auto compression =
        *options_.mcap == "zstd" ? interchange::McapCompression::zstd : interchange::McapCompression::none;
    outputs_.push_back(
        {".mcap", [this, compression](Sink& sink) { interchange::write_mcap(session_, sink, compression); }});
  }

  const ExportOptions& options_;
  session::Session session_;
  std::vector<interchange::Trajectory> trajectories_;
  std::vector<Output> outputs_;
};

/// What a session was written to.
struct Written {
  std::filesystem::path session;
  bool simulated = false;
  std::vector<std::filesystem::path> paths;
};

void print_written(const Written& written, bool json) {
  if (json) {
    nlohmann::json object{{"session", written.session.string()},
                          {"simulated", written.simulated},
                          {"files", nlohmann::json::array()}};
    for (const auto& path : written.paths) object["files"].push_back(path.string());
    return print_json(object);
  }
  print("session   {}\n{}", printable(written.session.string()),
        written.simulated ? "rig       SIMULATED\n" : "");
  for (const auto& path : written.paths) print("written   {}\n", printable(path.string()));
}

/// All files of all sessions, or none.
void export_all(const ExportOptions& options, const std::vector<std::filesystem::path>& sessions) {
  std::list<ExportFile> files;
  std::vector<Written> all;
  for (const auto& session : sessions) {
    ExportOptions one = options;
    one.file = session;
    spill::arrays_near(session);
    const SessionExport exported(one);
    all.push_back({session, exported.is_simulated(), exported.write_files(files)});
  }
  for (ExportFile& file : files) file.publish();
  for (const Written& written : all) print_written(written, options.json);
}

}  // namespace

bool is_of_a_session(const ExportOptions& options) {
  return options.npz || options.csv || options.tum || options.mcap;
}

ExitCode export_session(const ExportOptions& options) {
  if (options.c_header || options.batch)
    throw Error(ExitCode::bad_usage, "--c-header and --batch are for models, the other forms for sessions",
                "", "thermorig export --help");
  if ((options.frames || options.reduction) && options.npz.value_or("") != "windows")
    throw Error(ExitCode::bad_usage, "--nf and --nr are for windows: they need --npz", "", "--npz");
  if (options.output != "-") {
    export_all(options, session_files_at(options.file));
    return ExitCode::ok;
  }
  ExportOptions one = options;
  one.file = one_session_at(options.file);
  spill::arrays_near(one.file);
  SessionExport(one).write_to_standard_output();
  return ExitCode::ok;
}

}  // namespace thermorig::app
