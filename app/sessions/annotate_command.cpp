// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <memory>
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
    refuse_words(fmt::format("--exclude: \"{}\" is not a number of seconds", text), "--exclude 12.5..14.0");
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

std::string file_name(const Session& session, const session::Place& place) {
  return fmt::format("{}_acq-{:02}_{}.h5", place.environment, place.acquisition,
                     rig::compact_utc(session.raw.header.start_time_utc));
}

/// Has it ever been of that environment?
bool was_of(const Session& session, const std::string& environment) {
  const auto says_so = [&](const Annotation& annotation) {
    return annotation.kind == AnnotationKind::environment && annotation.text == environment;
  };
  return session.raw.header.environment == environment ||
         std::any_of(session.annotations.begin(), session.annotations.end(), says_so);
}

/// The folder that holds those of the environments: recordings/garden/garden_acq-01_... lies in recordings.
fs::path output_of(const fs::path& file, const Session& session) {
  const fs::path folder = fs::absolute(file).parent_path();
  return was_of(session, folder.filename()) ? folder.parent_path() : folder;
}

/// Whether a file of the folder has that number, whatever its date.
bool is_taken(const fs::path& folder, const session::Place& place) {
  const std::string prefix = fmt::format("{}_acq-{:02}_", place.environment, place.acquisition);
  const auto has_it = [&](const fs::directory_entry& entry) {
    return entry.path().filename().string().starts_with(prefix);
  };
  return std::any_of(fs::directory_iterator(folder), fs::directory_iterator(), has_it);
}

bool is_same_recording(const RawRecording& one, const RawRecording& other) {
  const auto has_same_bytes = [&](Device device) {
    return one.received[device].bytes == other.received[device].bytes;
  };
  return one.header.uuid == other.header.uuid &&
         std::all_of(all_devices.begin(), all_devices.end(), has_same_bytes);
}

/// Nothing of what is no session: what else has such a name is in nobody's way.
std::optional<Session> session_at(const fs::path& path) {
  try {
    return session::read_session(path);
  } catch (const Error& error) {
    if (error.code() == ExitCode::not_a_session) return std::nullopt;
    throw;
  }
}

/// One call of the command.
class Annotating {
 public:
  explicit Annotating(const AnnotateOptions& options)
      : options_(options),
        old_(locked_session(options.file)),
        session_(session::read_session(options.file)),
        output_(output_of(old_.path(), session_)),
        file_(options.file) {
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
    if (session::place_of(session_) != before || is_left_behind_)
      move();
    else
      write_in_place();
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
      return go_on_moving(annotation.text);
    annotation_ = annotation;
    session_.annotations.push_back(std::move(annotation));
    apply();
    if (annotation_.kind == AnnotationKind::exclusion && frames_changed_ == 0)
      refuse_words("no frame that is not excluded already was exposed in that time",
                   fmt::format("seconds since its start, 0..{:.1f}",
                               to_s(session_.raw.end_time - session_.raw.header.time_reference)));
  }

  /// A file that says where it belongs and still has its name of before: as earlier versions left it when
  /// they were killed.
  void go_on_moving(const std::string& environment) {
    Session before{.raw = {.header = session_.raw.header}, .annotations = session_.annotations};
    if (!before.annotations.empty()) before.annotations.pop_back();
    const session::Place place = session::place_of(before);
    is_left_behind_ =
        place != session::place_of(session_) && old_.path().filename() == file_name(before, place);
    if (!is_left_behind_) refuse_words("it belongs to " + environment + " already", "another environment");
    annotation_ = session_.annotations.back();
  }

  void apply() {
    std::vector<std::uint32_t> before;
    for (const LabelledSample& sample : session_.samples) before.push_back(sample.reason_bits);
    session::apply_exclusions(session_);
    for (std::size_t i = 0; i < before.size(); ++i)
      if (session_.samples[i].reason_bits != before[i]) ++frames_changed_;
  }

  void write_in_place() {
    files::PartFile part(std::move(old_));
    left_out_ = session::write_again(part, part.path(), session_);
    part.publish();
  }

  void require_movable() const {
    const fs::path journal = fs::path(old_.path()).replace_extension(".journal");
    if (fs::exists(journal))  // of which `recover` would make the session again, where it was
      throw Error(ExitCode::bad_usage, "its journal is still beside it, and would be made a session again",
                  journal.string(),
                  "thermorig recover " + shell_word(journal.string()) + ", then move the journal away");
    if (fs::is_symlink(file_))
      throw Error(ExitCode::bad_usage, "this symbolic link would then lead nowhere", file_.string(),
                  "name the file that it leads to: " + old_.path().string());
  }

  /// First the new file, whole and under its new name, then the old one goes. Killed in between, the same
  /// command finds both, and ends it.
  void move() {
    require_movable();
    const std::string environment = session::place_of(session_).environment;
    auto lock = std::make_unique<rig::FolderLock>(output_, environment);
    remove_left_parts(output_ / environment);
    const rig::SessionFile next = lock->next(rig::compact_utc(session_.raw.header.start_time_utc));
    const fs::path folder = next.session.parent_path();
    if (const fs::path moved = moved_before(folder); !moved.empty()) return leave(moved);
    if (!options_.undo) session_.annotations.back().acquisition = annotation_.acquisition = next.acquisition;
    const session::Place place = session::place_of(session_);
    const fs::path target = folder / file_name(session_, place);
    if (target == fs::absolute(old_.path())) {  // it has never left
      lock.reset();                             // as the file takes the same for its name
      return write_in_place();
    }
    if (is_taken(folder, place))
      throw Error(
          ExitCode::storage,
          fmt::format("another one has become {} acquisition {}", place.environment, place.acquisition),
          folder.string(), "annotate that one first: --environment NAME");
    files::PartFile part(target, old_);
    lock.reset();  // the part's name has the number, so that nobody else takes it
    left_out_ = session::write_again(part, old_.path(), session_);
    part.publish();
    leave(target);
  }

  /// The end of its name, wherever it is.
  std::string name_end() const { return "_" + rig::compact_utc(session_.raw.header.start_time_utc) + ".h5"; }

  /// Of this session, by the same command before it was killed: they hold a number.
  void remove_left_parts(const fs::path& folder) const {
    for (const files::FolderEntry& entry : files::real_disk().list(folder).value)
      if (const auto left = files::left_part_of(entry.path); left && left->string().ends_with(name_end()))
        files::remove_unless_held(entry.path);
  }

  /// The file that the same command made, before it was killed. Empty: there is none.
  fs::path moved_before(const fs::path& folder) {
    const std::string end = name_end();
    std::error_code hidden;
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (!entry.path().filename().string().ends_with(end) || !entry.is_regular_file(hidden) ||
          fs::equivalent(entry.path(), old_.path(), hidden))
        continue;
      const auto other = session_at(entry.path());
      if (!other || !is_same_recording(other->raw, session_.raw)) continue;
      require_same_words(*other, entry.path());
      session_.annotations = other->annotations;
      if (!options_.undo) annotation_ = other->annotations.back();
      return entry.path();
    }
    return {};
  }

  void require_same_words(const Session& other, const fs::path& path) const {
    const std::vector<Annotation>&own = session_.annotations, &there = other.annotations;
    std::size_t same = own.size();
    if (!options_.undo) --same;  // the last one has its own time and number
    if (there.size() == own.size() &&
        std::equal(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(same), there.begin()) &&
        session::place_of(other).environment == session::place_of(session_).environment)
      return;
    throw Error(ExitCode::bad_usage, "the same recording is there already, with other annotations",
                path.string(),
                "see which one to keep, and remove the other: thermorig inspect " + old_.path().string() +
                    " " + path.string());
  }

  /// All of it is at its new place.
  void leave(const fs::path& moved) {
    files::Disk& disk = files::real_disk();
    if (const int failed = disk.remove(old_.path()); failed != 0)
      throw Error(ExitCode::storage,
                  fmt::format("the session is at its new place, but its old file cannot be removed: {}",
                              std::strerror(failed)),
                  old_.path().string(), "remove it yourself: rm " + old_.path().string());
    disk.sync_folder(
        files::folder_of(old_.path()));  // else it comes back after a loss of power: and is moved again
    file_ = file_.is_relative() ? moved.lexically_proximate(fs::current_path()) : moved;
  }

  const AnnotateOptions& options_;
  files::ReplacedFile old_;
  Session session_;
  fs::path output_;  // the folder that holds those of the environments
  fs::path file_;
  Annotation annotation_;
  std::vector<std::string> left_out_;
  std::size_t frames_changed_ = 0;
  bool is_left_behind_ = false;
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
