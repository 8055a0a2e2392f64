// SPDX-License-Identifier: MIT
#include "thermorig/rig/setup/flash.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>

#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"

extern char** environ;

namespace thermorig::rig {

namespace {

constexpr std::array flash_bauds{115200, 57600};  // Uno and Nano since 2018, older Nano

std::vector<std::string> flash_words(const FlashOptions& options, int baud) {
  return {options.avrdude,
          "-p",
          "atmega328p",
          "-c",
          "arduino",
          "-P",
          options.port,
          "-b",
          std::to_string(baud),
          "-U",
          "flash:w:" + options.image + ":i"};
}

/// SIGINT, SIGTERM and SIGHUP wait in a descriptor instead of ending this program.
class HeldSignals {
 public:
  HeldSignals() {
    sigset_t requests;
    sigemptyset(&requests);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&requests, signal);
    pthread_sigmask(SIG_BLOCK, &requests, &before_);
    descriptor_ = signalfd(-1, &requests, SFD_CLOEXEC | SFD_NONBLOCK);
  }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
  ~HeldSignals() {
    while (is_pending()) {  // or it would end the program now
    }
    close(descriptor_);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }

  int descriptor() const { return descriptor_; }
  const sigset_t& before() const { return before_; }
  bool is_pending() const {
    signalfd_siginfo signal;
    return read(descriptor_, &signal, sizeof signal) == sizeof signal;
  }

 private:
  sigset_t before_{};
  int descriptor_ = -1;
};

/// avrdude with its words, of a process group of its own: a Ctrl-C on the terminal reaches it through us.
class Avrdude {
 public:
  Avrdude(const std::vector<std::string>& words, const HeldSignals& signals) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw_not_run(words[0], errno);
    output_ = ends[0];
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    posix_spawnattr_setsigmask(&attributes, &signals.before());
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const int failure =
        posix_spawnp(&process_, words[0].c_str(), &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (failure == 0) return;
    close(output_);
    throw_not_run(words[0], failure);
  }
  Avrdude(const Avrdude&) = delete;
  Avrdude& operator=(const Avrdude&) = delete;
  ~Avrdude() {
    close(output_);
    end();
    wait();
  }

  int output() const { return output_; }
  void end() const {
    if (process_ > 0) kill(process_, SIGTERM);
  }
  /// Its exit code, or 128 and its signal.
  int wait() {
    if (process_ <= 0) return code_;
    int status = 0;
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  [[noreturn]] static void throw_not_run(const std::string& program, int error_number) {
    if (error_number == ENOENT)
      throw Error(ExitCode::failed, "avrdude, which flashes the board, is not installed", program,
                  "sudo apt-get install avrdude; nothing was written to the board");
    throw Error(ExitCode::failed, "avrdude cannot be run: " + std::generic_category().message(error_number),
                program, "nothing was written to the board");
  }

  int output_ = -1, code_ = 0;
  pid_t process_ = -1;
};

struct FlashRun {
  int code = 0;
  std::string text;
  bool is_interrupted = false;
  bool is_unheard = false;  // by a boot loader
};

bool says(const FlashRun& run, std::string_view words) {
  return run.text.find(words) != std::string::npos;
}

/// Were so many attempts to be heard in vain? It counts them, and waits 6 s for each.
bool was_unheard(const FlashRun& run, int attempts) {
  return says(run, fmt::format("attempt {} of ", attempts));
}

/// No answer to a page means none to the next: avrdude would ask for minutes.
bool is_left_alone(const FlashRun& run) {
  const std::size_t begin = run.text.find("Writing |");
  return begin != std::string::npos && run.text.find("not responding", begin) != std::string::npos;
}

FlashRun run_avrdude(const FlashOptions& options, int baud) {
  const HeldSignals signals;
  Avrdude avrdude(flash_words(options, baud), signals);
  FlashRun run;
  std::array<pollfd, 2> watched{pollfd{avrdude.output(), POLLIN, 0}, {signals.descriptor(), POLLIN, 0}};
  while (true) {
    if (poll(watched.data(), watched.size(), -1) < 0 && errno != EINTR) break;
    if (signals.is_pending()) run.is_interrupted = true;
    run.is_unheard = was_unheard(run, options.attempts);
    if (run.is_interrupted || run.is_unheard || is_left_alone(run)) break;
    if (watched[0].revents == 0) continue;
    std::array<char, 1024> bytes;
    const ssize_t size = read(avrdude.output(), bytes.data(), bytes.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) {
      run.code = avrdude.wait();
      run.is_interrupted = signals.is_pending();
      return run;
    }
    run.text.append(bytes.data(), static_cast<std::size_t>(size));
  }
  avrdude.end();
  run.code = std::max(1, avrdude.wait());
  return run;
}

/// avrdude's last error, without its own name before it.
std::string last_error(const FlashRun& run) {
  std::string found;
  std::size_t begin = 0;
  while (begin < run.text.size()) {
    const std::size_t end = std::min(run.text.find_first_of("\r\n", begin), run.text.size());
    const std::string_view line = std::string_view(run.text).substr(begin, end - begin);
    constexpr std::string_view mark = "error: ";
    if (const auto at = line.find(mark); at != std::string_view::npos && line.find("TIOCMGET") == line.npos)
      found = line.substr(at + mark.size());
    begin = end + 1;
  }
  return found;
}

/// "0x1e9801 (probably m2560)"
std::string signature_of(const FlashRun& run) {
  constexpr std::string_view mark = "device signature = ";
  const auto begin = run.text.find(mark);
  if (begin == std::string::npos) return "unknown";
  const auto end = std::min(run.text.find_first_of("\r\n", begin), run.text.size());
  return run.text.substr(begin + mark.size(), end - begin - mark.size());
}

/// Of a board that was written to in part its boot loader is still there: it cannot overwrite itself.
constexpr const char* flash_again = "its boot loader is still there: plug it in again and repeat this";

/// Why the board was not flashed, in so far as the other speed cannot help. Nothing: its boot loader was not
/// heard.
std::optional<Error> flash_error(const FlashRun& run, const std::string& port) {
  const bool has_written = says(run, "Writing |");
  if (run.is_interrupted)
    return Error(ExitCode::interrupted,
                 has_written ? "stopped while the board was being flashed: its program is incomplete"
                             : "stopped before the board was flashed: it is unchanged",
                 port, has_written ? flash_again : "");
  if (says(run, "expected signature"))
    return Error(ExitCode::failed,
                 fmt::format("the board's chip is not an ATmega328P; its signature is {}", signature_of(run)),
                 port, "the firmware is for an Uno or a Nano with an ATmega328P; nothing was written");
  if (has_written && says(run, "verif") && says(run, "mismatch"))
    return Error(ExitCode::failed, "the board's memory differs from what was written", port,
                 "flash it again; if that fails, its memory is worn out: use another board");
  if (has_written)
    return Error(ExitCode::failed,
                 "the board stopped answering while it was being flashed: its program is incomplete", port,
                 flash_again);
  for (const char* words : {"Permission denied", "resource busy"})
    if (says(run, words))
      return Error(ExitCode::no_permission, fmt::format("avrdude cannot open the port ({})", words), port,
                   "thermorig doctor shows who may open it, and who has it open");
  if (says(run, "No such file"))
    return Error(ExitCode::device_missing, "there is no such port", port,
                 "plug the board in with a USB data cable (some cables only charge)");
  if (run.is_unheard || says(run, "not in sync")) return std::nullopt;
  return Error(ExitCode::failed, "avrdude did not flash the board: " + last_error(run), port,
               "run the command above by hand to see all of its output");
}

}  // namespace

std::vector<std::string> flash_commands(const std::string& port, const std::string& image) {
  std::vector<std::string> commands;
  for (const int baud : flash_bauds) {
    std::vector<std::string> words = flash_words({.port = port, .image = image}, baud);
    for (std::string& word : words) word = shell_word(word);
    commands.push_back(fmt::format("{}", fmt::join(words, " ")));
  }
  return commands;
}

void flash_firmware(const FlashOptions& options) {
  const std::vector<std::string> commands = flash_commands(options.port, options.image);
  bool answers = false;
  for (std::size_t i = 0; i < flash_bauds.size(); ++i) {
    if (options.say) options.say(commands[i] + "\n");
    const FlashRun run = run_avrdude(options, flash_bauds[i]);
    if (run.code == 0) return;
    if (const auto error = flash_error(run, options.port)) throw *error;
    answers |= !says(run, "not responding");
  }
  throw Error(
      ExitCode::failed,
      answers ? "the port answers, but not as a boot loader at 115200 or 57600 baud"
              : "no boot loader answers at 115200 or 57600 baud",
      options.port,
      "is it the servo's board, an Uno or a Nano (ATmega328P)? Nothing was written. If it is: disconnect its "
      "pins 0, 1 and reset, press reset when flashing begins, or burn a boot loader (Arduino: Tools)");
}

}  // namespace thermorig::rig
