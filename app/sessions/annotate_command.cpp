// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "print/annotation_text.h"
#include "print/inspect_text.h"
#include "print/output.h"
#include "session_files.h"
#include "thermorig/io/host.h"
#include "thermorig/io/port.h"
#include "thermorig/io/spill/spill.h"
#include "thermorig/rig/recording/session_file.h"
#include "thermorig/storage/session/annotations.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;
using session::Session;

[[noreturn]] void refuse_words(const std::string& what, const std::string& advice) {
  throw Error(ExitCode::bad_usage, what, "", advice);
}

double seconds_in(std::string_view text) {
  double seconds = 0.0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, seconds);
  if (error != std::errc() || at != end)
    refuse_words(fmt::format("--exclude: \"{}\" is no number of seconds", text), "--exclude 12.5..14.0");
  return seconds;
}

/// "12.5..14.0", or "all".
void read_span(const std::string& text, Annotation& annotation) {
  if (text == "all") return annotation.set_all();
  const std::size_t middle = text.find("..");
  if (middle == std::string::npos)
    refuse_words(fmt::format("--exclude: \"{}\" is not of the form A..B", text),
                 "--exclude 12.5..14.0, or --exclude all");
  annotation.begin_s = seconds_in(std::string_view(text).substr(0, middle));
  annotation.end_s = seconds_in(std::string_view(text).substr(middle + 2));
}

Annotation annotation_of(const AnnotateOptions& options) {
  Annotation annotation;
  annotation.made_utc = io::utc_text(io::now(), io::realtime_offset_ns());
  if (options.note) annotation.text = *options.note;
  if (options.environment) {
    annotation.kind = AnnotationKind::environment;
    annotation.text = *options.environment;
    annotation.acquisition = 1;  // until its folder has been looked at
    rig::check_environment(annotation.text);
  }
  if (options.exclude) {
    annotation.kind = AnnotationKind::exclusion;
    annotation.text = options.reason;
    read_span(*options.exclude, annotation);
  }
  if (const auto problem = session::problem_of(annotation))
    refuse_words(*problem, options.exclude ? "--exclude 12.5..14.0" : "thermorig annotate --help");
  return annotation;
}

/// The folder that holds those of the environments: recordings/garden/garden_acq-01_... lies in recordings.
fs::path output_of(const fs::path& file, const session::Place& place) {
  const fs::path folder = fs::absolute(file).parent_path();
  return folder.filename() == place.environment ? folder.parent_path() : folder;
}

std::string file_name(const Session& session, const session::Place& place) {
  return fmt::format("{}_acq-{:02}_{}.h5", place.environment, place.acquisition,
                     rig::compact_utc(session.raw.header.start_time_utc));
}

/// Whether a file of the folder has that number, whatever its date.
bool is_taken(const fs::path& folder, const session::Place& place) {
  const std::string prefix = fmt::format("{}_acq-{:02}_", place.environment, place.acquisition);
  const auto has_it = [&](const fs::directory_entry& entry) {
    return entry.path().filename().string().starts_with(prefix);
  };
  return std::any_of(fs::directory_iterator(folder), fs::directory_iterator(), has_it);
}

/// Gives a session that belongs to another environment its place there. Nothing is overwritten.
fs::path move_to(const fs::path& file, const fs::path& target) {
  std::error_code failure;
  fs::create_hard_link(file, target, failure);  // refuses a name that is taken, which rename() does not
  if (!failure) fs::remove(file, failure);
  if (failure)
    throw Error(ExitCode::storage, "the session was annotated, but could not be moved: " + failure.message(),
                target.string(),
                "move it yourself: mv " + shell_word(file.string()) + " " + shell_word(target.string()));
  return target;
}

/// One call of the command.
class Annotating {
 public:
  explicit Annotating(const AnnotateOptions& options)
      : options_(options), session_(session::read_session(options.file)), file_(options.file) {
    if (session_.format_major < 2)
      throw Error(ExitCode::bad_usage, "is of an older format, which has no annotations",
                  options.file.string(), "thermorig reprocess " + shell_word(options.file.string()));
  }

  void run() {
    const session::Place before = session::place_of(session_);
    if (options_.undo)
      take_back();
    else
      add(annotation_of(options_));
    if (session::place_of(session_) != before) return write_and_move(before);
    write();
  }

  const Session& session() const { return session_; }
  const fs::path& file() const { return file_; }
  const Annotation& annotation() const { return annotation_; }
  const std::vector<std::string>& left_out() const { return left_out_; }
  std::size_t frames_changed() const { return frames_changed_; }

 private:
  void take_back() {
    if (session_.annotations.empty())
      throw Error(ExitCode::bad_usage, "it has no annotation that could be taken back", file_.string(),
                  "thermorig inspect " + shell_word(file_.string()));
    annotation_ = session_.annotations.back();
    session_.annotations.pop_back();
    apply();
  }

  void add(Annotation annotation) {
    if (session_.annotations.size() >= session::most_annotations)
      throw Error(ExitCode::bad_usage, "it has as many annotations as a session can have", file_.string(),
                  "take some back: --undo");
    if (annotation.kind == AnnotationKind::environment &&
        annotation.text == session::place_of(session_).environment)
      refuse_words("it belongs to " + annotation.text + " already", "another environment");
    annotation_ = annotation;
    session_.annotations.push_back(std::move(annotation));
    apply();
    if (annotation_.kind == AnnotationKind::exclusion && frames_changed_ == 0)
      refuse_words("no frame that is not excluded already was exposed in that time",
                   fmt::format("seconds since its start, 0..{:.1f}",
                               to_s(session_.raw.end_time - session_.raw.header.time_reference)));
  }

  void apply() {
    std::vector<std::uint32_t> before;
    for (const LabelledSample& sample : session_.samples) before.push_back(sample.reason_bits);
    session::apply_exclusions(session_);
    for (std::size_t i = 0; i < before.size(); ++i)
      if (session_.samples[i].reason_bits != before[i]) ++frames_changed_;
  }

  void write() { left_out_ = session::replace_session(file_, session_); }

  /// Of a journal that is still there `recover` would make the session again, where it was.
  void require_no_journal() const {
    const fs::path journal = fs::path(file_).replace_extension(".journal");
    if (!fs::exists(journal)) return;
    throw Error(ExitCode::bad_usage, "its journal is still beside it, and would be made a session again",
                journal.string(),
                "thermorig recover " + shell_word(journal.string()) + ", then move the journal away");
  }

  /// The number is chosen, and the name taken, while nobody else may take one there.
  void write_and_move(const session::Place& before) {
    require_no_journal();
    const rig::FolderLock lock(output_of(file_, before), session::place_of(session_).environment);
    const rig::SessionFile next = lock.next(rig::compact_utc(session_.raw.header.start_time_utc));
    if (!options_.undo) session_.annotations.back().acquisition = annotation_.acquisition = next.acquisition;
    const session::Place place = session::place_of(session_);
    const fs::path folder = next.session.parent_path();
    if (is_taken(folder, place))
      throw Error(
          ExitCode::storage,
          fmt::format("another one has become {} acquisition {}", place.environment, place.acquisition),
          folder.string(), "annotate that one first: --environment NAME");
    write();
    const fs::path moved = move_to(file_, folder / file_name(session_, place));
    file_ = file_.is_relative() ? moved.lexically_proximate(fs::current_path()) : moved;
  }

  const AnnotateOptions& options_;
  Session session_;
  fs::path file_;
  Annotation annotation_;
  std::vector<std::string> left_out_;
  std::size_t frames_changed_ = 0;
};

void print_words(const Annotating& done, bool undone) {
  print("{}  {}\n", undone ? "taken back" : "annotated ", printable(words_of(done.annotation())));
  print("session     {}\n", printable(done.file().string()));
  const session::Quality quality = session::quality_of(done.session());
  if (done.annotation().kind == AnnotationKind::exclusion)
    print("frames      {} changed; {} of {} in legs are valid, verdict {}\n",
          count_text(done.frames_changed()), count_text(quality.valid), count_text(quality.swept),
          quality.verdict);
  if (!done.left_out().empty()) print("left out    {}\n", left_out_text(done.left_out()));
}

void print_object(const Annotating& done, bool undone) {
  nlohmann::json object = quality_json(session::quality_of(done.session()));
  object["file"] = done.file().string();
  object[undone ? "taken_back" : "annotated"] = annotation_json(done.annotation());
  object["frames_changed"] = done.frames_changed();
  object["annotations"] = done.session().annotations.size();
  object["left_out"] = done.left_out();
  print_json(object);
}

}  // namespace

ExitCode run(const AnnotateOptions& asked) {
  AnnotateOptions options = asked;
  options.file = one_session_at(asked.file);
  spill::arrays_near(options.file);
  Annotating annotating(options);
  annotating.run();
  if (options.json)
    print_object(annotating, options.undo);
  else
    print_words(annotating, options.undo);
  return ExitCode::ok;
}

}  // namespace thermorig::app
