// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>
#include <variant>

#include "commands.h"
#include "options.h"
#include "print/error_output.h"
#include "print/output.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/session/trial.h"

namespace {

using namespace thermorig;

/// Opens /dev/null on those of the descriptors 0 to 2 that are closed. A file, a port or a socket that came
/// to lie there would be taken for standard input, output or errors: before anything else is opened.
void open_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    // The system gives the lowest number that is free, and those below are not.
    if (open("/dev/null", O_RDWR) != descriptor) std::_Exit(static_cast<int>(ExitCode::failed));
  }
}

/// Known before parsing, so that an error in the command line is told in the form that was asked for.
bool asks_for_json(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i)
    if (std::string_view(argv[i]) == "--json") return true;
  return false;
}

int run(int argc, const char* const* argv) {
  const app::CommandLine line = app::parse(argc, argv);
  if (!line.command) {
    app::write_to(stdout, line.help);
    return static_cast<int>(ExitCode::ok);
  }
  session::try_sessions_first();  // whatever a command reads of sessions may come from others
  return static_cast<int>(std::visit([](const auto& options) { return app::run(options); }, *line.command));
}

int printed(int code) {
  app::require_printed();
  return code;
}

Error not_enough_memory() {
  return {ExitCode::failed, "there is not enough memory", "", "close other programs"};
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_descriptors();
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is then an error of write(), as a full disk is
  std::signal(SIGPIPE, SIG_IGN);  // and so is a reader that goes away: it ends neither a run nor a training
  const bool json = asks_for_json(argc, argv);
  try {
    return printed(run(argc, argv));
  } catch (const Error& error) {
    return app::report(error, json);
  } catch (const std::filesystem::filesystem_error& error) {
    const ExitCode code = error.code() == std::errc::permission_denied ? ExitCode::no_permission
                          : error.code() == std::errc::too_many_symbolic_link_levels
                              ? ExitCode::bad_usage  // a link that leads in a circle
                              : ExitCode::storage;
    return app::report(Error(code, error.code().message(), error.path1().string(),
                             "see what is there: ls -l " + shell_word(error.path1().string())),
                       json);
  } catch (const std::bad_alloc&) {
    return app::report(not_enough_memory(), json);
  } catch (const std::system_error& error) {  // of a thread: its stack finds no room
    const bool lacks_memory = error.code() == std::errc::resource_unavailable_try_again;
    return app::report(lacks_memory ? not_enough_memory() : Error(ExitCode::failed, error.what(), "", ""),
                       json);
  } catch (const std::exception& error) {
    return app::report(Error(ExitCode::failed, error.what(), "", ""), json);
  }
}
