// SPDX-License-Identifier: MIT
// Who tries files: a process that is forked off before the program has threads (thereafter a fork could find
// a lock taken for ever), and which forks a child for each file that it is handed. A child that lives to the
// end says with one byte what it found, and one whose time is up says so too; one that dies leaves an end of
// file.
#include "thermorig/session/trial.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <sstream>
#include <string_view>

#include "cage.h"
#include "refusal.h"
#include "session_trial.h"
#include "thermorig/core/error.h"

namespace thermorig::session {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_answer = 1U << 20U;
constexpr auto alarm_margin = std::chrono::seconds(10);
constexpr std::size_t descriptors = 2;  // of a message: the copy, and where to answer

int to_trials = -1;  // a socket to the process that tries; none: nothing is tried

/// What a child is to do; the byte of the parcel.
enum class Task : std::uint8_t { read = 0, name_altered = 1 };

/// A message of one byte and two descriptors, as the system wants it.
struct Parcel {
  std::uint8_t byte = 0;
  iovec content{&byte, sizeof byte};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(descriptors * sizeof(int))> control{};
  msghdr message{};

  Parcel() {
    message.msg_iov = &content;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
  }
  Parcel(const Parcel&) = delete;
  Parcel& operator=(const Parcel&) = delete;
};

bool send_parcel(int socket, Task task, const std::array<int, descriptors>& fds) {
  Parcel parcel;
  parcel.byte = static_cast<std::uint8_t>(task);
  cmsghdr* header = CMSG_FIRSTHDR(&parcel.message);
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(sizeof fds);
  std::memcpy(CMSG_DATA(header), fds.data(), sizeof fds);
  ssize_t sent = 0;
  do sent = ::sendmsg(socket, &parcel.message, MSG_NOSIGNAL);
  while (sent < 0 && errno == EINTR);
  return sent == 1;
}

bool receive_parcel(int socket, Task& task, std::array<int, descriptors>& fds) {
  Parcel parcel;
  ssize_t received = 0;
  do received = ::recvmsg(socket, &parcel.message, MSG_CMSG_CLOEXEC);
  while (received < 0 && errno == EINTR);
  const cmsghdr* header = CMSG_FIRSTHDR(&parcel.message);
  if (received != 1 || header == nullptr || header->cmsg_len != CMSG_LEN(sizeof fds)) return false;
  std::memcpy(fds.data(), CMSG_DATA(header), sizeof fds);
  task = Task{parcel.byte};
  return true;
}

int answers = -1;  // of the child: where its answer goes

/// Async-signal-safe.
[[noreturn]] void answer_and_exit(TrialEnd end) {
  [[maybe_unused]] const ssize_t written = ::write(answers, &end, sizeof end);
  ::_exit(0);
}

/// Comes every second of processor time beyond the first limit: data that were read meanwhile excuse it.
void look_at_cpu_time(int /*signal*/) {
  static volatile std::sig_atomic_t seconds_beyond = 0;
  const std::sig_atomic_t seconds = seconds_beyond;
  if (static_cast<std::uint64_t>(seconds) >= inflated_bytes() / inflated_bytes_per_cpu_s)
    answer_and_exit(TrialEnd::no_cpu_time);
  seconds_beyond = seconds + 1;
}

void end_of_wall_time(int /*signal*/) {
  answer_and_exit(TrialEnd::no_wall_time);
}

TrialEnd end_of_reading(const SealedCopy& copy) {
  try {
    read_for_nothing(copy);
    return TrialEnd::read;
  } catch (const Error&) {
    return TrialEnd::refused;
  }
}

/// A line for each, behind the answer.
[[noreturn]] void answer_with_altered(const SealedCopy& copy) {
  std::string text(1, static_cast<char>(TrialEnd::read));
  try {
    for (const std::string& path : altered_in(copy)) text += path + "\n";
  } catch (const Error&) {
    answer_and_exit(TrialEnd::refused);
  }
  for (std::string_view left = text; !left.empty();) {
    const ssize_t written = ::write(answers, left.data(), left.size());
    if (written <= 0) break;
    left.remove_prefix(static_cast<std::size_t>(written));
  }
  ::_exit(0);
}

/// A Ctrl-C is the program's: its children end when it does.
[[noreturn]] void try_file(Task task, int file, int answer) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  answer_when_time_is_up(answer);
  try {
    const SealedCopy copy(file, "session");
    ::prctl(PR_SET_NAME, "session-trial");
    enter_cage(copy.bytes().size());
    if (task == Task::name_altered) answer_with_altered(copy);
    answer_and_exit(end_of_reading(copy));
  } catch (const std::exception&) {  // too little memory, for one: the answer stays away
  }
  ::_exit(0);
}

/// Ends with the program that it serves, whose end of the socket then is closed.
[[noreturn]] void serve(int socket) {
  ::prctl(PR_SET_NAME, "session-trials");
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP}) std::signal(signal, SIG_IGN);
  std::signal(SIGCHLD, SIG_IGN);  // children vanish by themselves
  std::array<int, descriptors> fds{};
  Task task{};
  while (receive_parcel(socket, task, fds)) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::close(socket);  // the files of others come there
      try_file(task, fds[0], fds[1]);
    }
    constexpr TrialEnd none = TrialEnd::no_child;
    if (child < 0) {
      [[maybe_unused]] const ssize_t written = ::write(fds[1], &none, sizeof none);
    }
    for (const int fd : fds) ::close(fd);
  }
  ::_exit(0);
}

/// The process that tries needs nothing of what the program has open.
void keep_only(int& socket) {
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (int fd = 0; fd <= STDERR_FILENO; ++fd) ::dup2(null, fd);
  constexpr int kept = STDERR_FILENO + 1;
  ::dup3(socket, kept, O_CLOEXEC);
  socket = kept;
  ::close_range(kept + 1, ~0U, 0);
}

[[noreturn]] void no_trials() {
  throw Error(ExitCode::failed, std::string("no process can be made to try files: ") + std::strerror(errno),
              "", "close other programs");
}

/// Hands over the copy, and where to answer.
bool send_copy(const SealedCopy& copy, Task task, int answer) {
  if (copy.fd() >= 0) return send_parcel(to_trials, task, {copy.fd(), answer});
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) no_trials();
  const bool sent = send_parcel(to_trials, task, {ends[1], answer});
  ::close(ends[1]);
  if (sent) copy.send_bytes(ends[0]);  // if the child goes before it has them, its answer stays away
  ::close(ends[0]);
  return sent;
}

/// Until there is something to read, or nobody who could write it. A child that was taken over may have lost
/// its alarm, so it is not waited for much longer than that.
bool is_answered(int answer, std::chrono::steady_clock::time_point until) {
  pollfd waiting{.fd = answer, .events = POLLIN, .revents = 0};
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    const int ready = ::poll(&waiting, 1, static_cast<int>(left.count()));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
}

/// All that a child says, but no more than is sensible.
std::string answer_to(const SealedCopy& copy, Task task) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) no_trials();
  const bool sent = send_copy(copy, task, ends[1]);
  ::close(ends[1]);
  std::string answer;
  std::array<char, 4096> part{};
  const auto until = std::chrono::steady_clock::now() +
                     std::chrono::seconds(time_limits(copy.bytes().size()).wall_s) + alarm_margin;
  while (sent && answer.size() < longest_answer) {
    if (!is_answered(ends[0], until)) {
      answer.assign(1, static_cast<char>(TrialEnd::no_wall_time));
      break;
    }
    const ssize_t size = ::read(ends[0], part.data(), part.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) break;
    answer.append(part.data(), static_cast<std::size_t>(size));
  }
  ::close(ends[0]);
  if (!sent) no_trials();
  return answer;
}

TrialEnd end_in(const std::string& answer) {
  return answer.empty() ? TrialEnd::died : TrialEnd{static_cast<std::uint8_t>(answer.front())};
}

/// Says nothing of the file: a slow computer, or a busy one, may have a sound one in its hands.
[[noreturn]] void no_time(const fs::path& path, const std::string& limit) {
  throw Error(ExitCode::failed, "could not be read within " + limit, path.string(),
              "try again when the computer has less to do; if that does not help, take a copy of it from "
              "elsewhere, or its journal with thermorig recover");
}

}  // namespace

void answer_when_time_is_up(int answer) {
  answers = answer;
  std::signal(SIGXCPU, look_at_cpu_time);
  std::signal(SIGALRM, end_of_wall_time);
}

void try_sessions_first() {
  if (to_trials >= 0) return;
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) no_trials();
  std::fflush(nullptr);  // or a child would print it once more
  const pid_t child = ::fork();
  if (child < 0) no_trials();
  if (child == 0) {
    keep_only(ends[1]);
    serve(ends[1]);
  }
  ::close(ends[1]);
  to_trials = ends[0];
}

SealedCopy tried_copy(const fs::path& path) {
  return tried(SealedCopy(path));
}

void require_harmless(TrialEnd end, const SealedCopy& copy) {
  const TimeLimits limits = time_limits(copy.bytes().size());
  switch (end) {
    case TrialEnd::read:
    case TrialEnd::refused:
      return;
    case TrialEnd::no_cpu_time:
      no_time(copy.path(), fmt::format("{} s of processor time and a second for every {} MiB of data in it",
                                       limits.cpu_s, inflated_bytes_per_cpu_s >> 20U));
    case TrialEnd::no_wall_time:
      no_time(copy.path(), std::to_string(limits.wall_s) + " s");
    case TrialEnd::no_child:
      no_trials();
    case TrialEnd::died:
      break;
  }
  refuse(copy.path(), "is damaged or hostile: the process that tried to read it first did not survive it");
}

SealedCopy tried(SealedCopy copy) {
  if (to_trials >= 0) require_harmless(end_in(answer_to(copy, Task::read)), copy);
  return copy;
}

void require_readable(SealedCopy copy) {
  const TrialEnd end = to_trials >= 0 ? end_in(answer_to(copy, Task::read)) : TrialEnd::refused;
  require_harmless(end, copy);
  if (end != TrialEnd::read) read_for_nothing(copy);  // says why it is refused; or nobody tries files
}

std::vector<std::string> altered_attributes(const SealedCopy& copy) {
  if (to_trials < 0) return altered_in(copy);
  const std::string answer = answer_to(copy, Task::name_altered);
  require_harmless(end_in(answer), copy);
  if (end_in(answer) == TrialEnd::refused) return altered_in(copy);  // says why
  std::vector<std::string> paths;
  std::istringstream lines(answer.substr(1));
  for (std::string path; std::getline(lines, path);) paths.push_back(path);
  return paths;
}

}  // namespace thermorig::session
