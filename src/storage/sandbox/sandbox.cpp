// SPDX-License-Identifier: MIT
// Who does the tasks: a process that is forked off before the program has threads (thereafter a fork could
// find a lock taken for ever), and which forks a child for each copy that it is handed. A child that lives to
// the end says with one byte how it ended, with its lines behind it, and one whose time is up says so too;
// one that dies leaves an end of file.
#include "thermorig/storage/sandbox/sandbox.h"

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
#include <string_view>

#include "child_limits.h"
#include "refusal_text.h"
#include "thermorig/core/error.h"

namespace thermorig::sandbox {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t answer_part_bytes = 1U << 16U;  // as much as a pipe holds
constexpr auto alarm_margin = std::chrono::seconds(10);
constexpr std::size_t descriptors = 2;  // of a message: the copy, and where to answer

int to_children = -1;  // a socket to the process that forks them; none: it was not started
std::vector<Task> tasks;

/// A message of one byte, the task's number, what is asked behind it, and two descriptors, as the system
/// wants it.
struct Parcel {
  std::array<char, 1 + request_bytes_max> bytes{};
  iovec content{bytes.data(), bytes.size()};
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

bool send_parcel(int socket, std::size_t task, std::string_view request,
                 const std::array<int, descriptors>& fds) {
  Parcel parcel;
  parcel.bytes[0] = static_cast<char>(task);
  parcel.content.iov_len = 1 + request.copy(&parcel.bytes[1], request_bytes_max);
  cmsghdr* header = CMSG_FIRSTHDR(&parcel.message);
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(sizeof fds);
  std::memcpy(CMSG_DATA(header), fds.data(), sizeof fds);
  ssize_t sent = 0;
  do sent = ::sendmsg(socket, &parcel.message, MSG_NOSIGNAL);
  while (sent < 0 && errno == EINTR);
  return sent == static_cast<ssize_t>(parcel.content.iov_len);
}

/// What a child is to do.
struct Order {
  std::size_t task = 0;
  std::string request;
  std::array<int, descriptors> fds{};  // the copy, and where to answer
};

bool receive_parcel(int socket, Order& order) {
  Parcel parcel;
  ssize_t received = 0;
  do received = ::recvmsg(socket, &parcel.message, MSG_CMSG_CLOEXEC);
  while (received < 0 && errno == EINTR);
  const cmsghdr* header = CMSG_FIRSTHDR(&parcel.message);
  if (received < 1 || header == nullptr || header->cmsg_len != CMSG_LEN(sizeof order.fds)) return false;
  std::memcpy(order.fds.data(), CMSG_DATA(header), sizeof order.fds);
  order.task = static_cast<std::uint8_t>(parcel.bytes[0]);
  order.request.assign(&parcel.bytes[1], static_cast<std::size_t>(received) - 1);
  return true;
}

int answers = -1;  // of the child: where its answer goes

/// Async-signal-safe.
[[noreturn]] void answer_and_exit(End end) {
  [[maybe_unused]] const ssize_t written = ::write(answers, &end, sizeof end);
  ::_exit(0);
}

/// Comes every second of processor time beyond the first limit: data that were read meanwhile excuse it.
void look_at_cpu_time(int /*signal*/) {
  static volatile std::sig_atomic_t seconds_beyond = 0;
  const std::sig_atomic_t seconds = seconds_beyond;
  if (static_cast<std::uint64_t>(seconds) >= inflated_bytes() / inflated_bytes_per_cpu_s)
    answer_and_exit(End::no_cpu_time);
  seconds_beyond = seconds + 1;
}

void end_of_wall_time(int /*signal*/) {
  answer_and_exit(End::no_wall_time);
}

std::string answer_to(const Order& order, const SealedCopy& copy) {
  try {
    return static_cast<char>(End::done) + tasks.at(order.task)(copy, order.request);
  } catch (const Error& refusal) {
    return static_cast<char>(End::refused) + refusal_text(refusal);
  }
}

/// How it ended, then what was made, or why it is refused.
[[noreturn]] void do_and_answer(const Order& order, const SealedCopy& copy) {
  const std::string text = answer_to(order, copy);
  for (std::string_view left = text; !left.empty();) {
    const ssize_t written = ::write(answers, left.data(), left.size());
    if (written <= 0) break;
    left.remove_prefix(static_cast<std::size_t>(written));
  }
  ::_exit(0);
}

/// A Ctrl-C is the program's: its children end when it does.
[[noreturn]] void be_child(const Order& order) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  answer_when_time_is_up(order.fds[1]);
  try {
    const SealedCopy copy(order.fds[0], name_in_children);
    ::prctl(PR_SET_NAME, "sandboxed");
    enter(copy.bytes().size());
    do_and_answer(order, copy);
  } catch (const std::exception&) {  // too little memory, for one: the answer stays away
  }
  ::_exit(0);
}

/// Ends with the program that it serves, whose end of the socket then is closed.
[[noreturn]] void serve(int socket) {
  ::prctl(PR_SET_NAME, "sandbox");
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP}) std::signal(signal, SIG_IGN);
  std::signal(SIGCHLD, SIG_IGN);  // children vanish by themselves
  Order order;
  while (receive_parcel(socket, order)) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::close(socket);  // the files of others come there
      be_child(order);
    }
    constexpr End none = End::no_child;
    if (child < 0) {
      [[maybe_unused]] const ssize_t written = ::write(order.fds[1], &none, sizeof none);
    }
    for (const int fd : order.fds) ::close(fd);
  }
  ::_exit(0);
}

/// The process that forks them needs nothing of what the program has open.
void keep_only(int& socket) {
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (int fd = 0; fd <= STDERR_FILENO; ++fd) ::dup2(null, fd);
  constexpr int kept = STDERR_FILENO + 1;
  ::dup3(socket, kept, O_CLOEXEC);
  socket = kept;
  ::close_range(kept + 1, ~0U, 0);
}

[[noreturn]] void no_child_possible() {
  throw Error(ExitCode::failed, std::string("no process can be made to try files: ") + std::strerror(errno),
              "", "close other programs");
}

/// Hands over the copy, and where to answer.
bool send_copy(const SealedCopy& copy, std::size_t task, std::string_view request, int answer) {
  if (copy.fd() >= 0) return send_parcel(to_children, task, request, {copy.fd(), answer});
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) no_child_possible();
  const bool sent = send_parcel(to_children, task, request, {ends[1], answer});
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
std::string text_of_answer(const SealedCopy& copy, std::size_t task, std::string_view request,
                           std::size_t bytes_max) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) no_child_possible();
  const bool sent = send_copy(copy, task, request, ends[1]);
  ::close(ends[1]);
  std::string answer;
  std::vector<char> part(answer_part_bytes);
  const auto until = std::chrono::steady_clock::now() +
                     std::chrono::seconds(time_limits(copy.bytes().size()).wall_s) + alarm_margin;
  while (sent && answer.size() <= bytes_max) {
    if (!is_answered(ends[0], until)) {
      answer.assign(1, static_cast<char>(End::no_wall_time));
      break;
    }
    const ssize_t size = ::read(ends[0], part.data(), part.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) break;
    answer.append(part.data(), static_cast<std::size_t>(size));
  }
  ::close(ends[0]);
  if (!sent) no_child_possible();
  return answer;
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

void start(std::vector<Task> tasks_to_do) {
  if (is_started()) return;
  tasks = std::move(tasks_to_do);
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) no_child_possible();
  std::fflush(nullptr);  // or a child would print it once more
  const pid_t child = ::fork();
  if (child < 0) no_child_possible();
  if (child == 0) {
    keep_only(ends[1]);
    serve(ends[1]);
  }
  ::close(ends[1]);
  to_children = ends[0];
}

bool is_started() {
  return to_children >= 0;
}

Answer ask(const SealedCopy& copy, std::size_t task, std::string_view request, std::size_t bytes_max) {
  const std::string text = text_of_answer(copy, task, request, bytes_max);
  Answer answer;
  if (text.empty()) return answer;
  answer.end = End{static_cast<std::uint8_t>(text.front())};
  answer.bytes = text.substr(1, bytes_max);
  return answer;
}

void require_done(const Answer& answer, const SealedCopy& copy) {
  const TimeLimits limits = time_limits(copy.bytes().size());
  switch (answer.end) {
    case End::done:
      return;
    case End::refused:
      refuse_as_told(answer.bytes, copy.path());
    case End::no_cpu_time:
      no_time(copy.path(), fmt::format("{} s of processor time and a second for every {} MiB of data in it",
                                       limits.cpu_s, inflated_bytes_per_cpu_s >> 20U));
    case End::no_wall_time:
      no_time(copy.path(), std::to_string(limits.wall_s) + " s");
    case End::no_child:
      no_child_possible();
    case End::died:
      break;
  }
  refuse_as_hostile(copy.path());
}

}  // namespace thermorig::sandbox
