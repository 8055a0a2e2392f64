// SPDX-License-Identifier: MIT
// Who tries files: a process that is forked off before the program has threads (thereafter a fork could find
// a lock taken for ever), and which forks a child for each file that it is handed. A child that lives to the
// end says so with one byte; one that does not leaves an end of file.
#include "thermorig/session/trial.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>

#include "cage.h"
#include "refusal.h"
#include "session_trial.h"
#include "thermorig/core/error.h"

namespace thermorig::session {

namespace {

namespace fs = std::filesystem;

constexpr std::uint8_t survived = 1;
constexpr std::size_t descriptors = 2;  // of a message: the copy, and where to answer

int to_trials = -1;  // a socket to the process that tries; none: nothing is tried

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

bool send_parcel(int socket, const std::array<int, descriptors>& fds) {
  Parcel parcel;
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

bool receive_parcel(int socket, std::array<int, descriptors>& fds) {
  Parcel parcel;
  ssize_t received = 0;
  do received = ::recvmsg(socket, &parcel.message, MSG_CMSG_CLOEXEC);
  while (received < 0 && errno == EINTR);
  const cmsghdr* header = CMSG_FIRSTHDR(&parcel.message);
  if (received != 1 || header == nullptr || header->cmsg_len != CMSG_LEN(sizeof fds)) return false;
  std::memcpy(fds.data(), CMSG_DATA(header), sizeof fds);
  return true;
}

[[noreturn]] void try_file(int file, int answer) {
  try {
    const SealedCopy copy(file, "session");
    ::prctl(PR_SET_NAME, "session-trial");
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
    enter_cage(copy.bytes().size());
    try {
      read_for_nothing(copy);
    } catch (const Error&) {  // refused in the ordinary way: the program will say why
    }
    [[maybe_unused]] const ssize_t written = ::write(answer, &survived, sizeof survived);
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
  while (receive_parcel(socket, fds)) {
    if (::fork() == 0) try_file(fds[0], fds[1]);
    for (const int fd : fds) ::close(fd);  // if there was no child, this alone is the answer
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
bool send_copy(const SealedCopy& copy, int answer) {
  if (copy.fd() >= 0) return send_parcel(to_trials, {copy.fd(), answer});
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) no_trials();
  const bool sent = send_parcel(to_trials, {ends[1], answer});
  ::close(ends[1]);
  if (sent) copy.send_bytes(ends[0]);  // if the child goes before it has them, its answer stays away
  ::close(ends[0]);
  return sent;
}

bool survives(const SealedCopy& copy) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) no_trials();
  const bool sent = send_copy(copy, ends[1]);
  ::close(ends[1]);
  std::uint8_t answer = 0;
  ssize_t size = 0;
  do size = sent ? ::read(ends[0], &answer, sizeof answer) : -1;
  while (size < 0 && sent && errno == EINTR);
  ::close(ends[0]);
  if (!sent) no_trials();
  return size == 1 && answer == survived;
}

}  // namespace

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

SealedCopy tried(SealedCopy copy) {
  if (to_trials >= 0 && !survives(copy))
    refuse(copy.path(), "is damaged or hostile: the process that tried to read it first did not survive it");
  return copy;
}

}  // namespace thermorig::session
