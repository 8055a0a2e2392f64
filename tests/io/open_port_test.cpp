// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "io/port_list.h"
#include "one_loop.h"
#include "support/as_nobody.h"

namespace thermorig::io {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

void open_and_close(const std::string& path) {
  Loop loop;
  Collected collected;
  loop.open(port_at(path), collected.handlers());
}

Error refusal_at(const std::string& path) {
  return refusal_of([&] { open_and_close(path); });
}

/// A folder of its own for each test, gone at its end.
class PortNames : public testing::Test {
 protected:
  PortNames() { folder_ = mkdtemp(name_.data()); }
  ~PortNames() override { std::filesystem::remove_all(folder_); }
  std::string in_folder(const std::string& name) const { return folder_ + "/" + name; }

 private:
  std::string name_ = testing::TempDir() + "/thermorig_io_XXXXXX";
  std::string folder_;
};

/// A process that holds a port as a second recorder would, or as `cat` does, which takes no lock.
class OtherRecorder {
 public:
  explicit OtherRecorder(const std::string& path, bool locks = true) : locks_(locks) {
    std::array<int, 2> ready{};
    EXPECT_EQ(pipe(ready.data()), 0);
    pid_ = fork();
    if (pid_ == 0) hold(path, ready[1]);
    close(ready[1]);
    char byte = 0;
    EXPECT_EQ(read(ready[0], &byte, 1), 1);
    close(ready[0]);
  }
  ~OtherRecorder() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  pid_t pid() const { return pid_; }

 private:
  [[noreturn]] void hold(const std::string& path, int ready) const {
    const int fd = open(path.c_str(), (locks_ ? O_RDWR : O_RDONLY) | O_NOCTTY);
    if (fd < 0 || (locks_ && flock(fd, LOCK_EX | LOCK_NB) != 0) || write(ready, "1", 1) != 1) _exit(1);
    while (true) pause();
  }
  bool locks_;
  pid_t pid_ = -1;
};

/// The lock is the kernel's on any file: here on an ordinary one.
class PortLock : public PortNames {
 protected:
  PortLock() { std::ofstream(path()) << "a port"; }
  std::string path() const { return in_folder("ttyUSB0"); }
  files::Descriptor lock(Refusal refusal = Refusal::names_holder) const {
    return lock_exclusively(files::Descriptor(open(path().c_str(), O_RDWR | O_CLOEXEC)), path(), refusal);
  }
};

TEST_F(PortLock, NamesTheProcessThatHoldsThePort) {
  const OtherRecorder other(path());
  const Error error = refusal_of([&] { lock(); });
  EXPECT_EQ(error.code(), ExitCode::no_permission);
  EXPECT_THAT(error.what_happened(),
              HasSubstr("in use by process " + std::to_string(other.pid()) + " (test_io)"));
  EXPECT_EQ(error.where(), path());
}

TEST_F(PortLock, NamesThisProgramWhereItHoldsThePortItself) {
  const files::Descriptor held = lock();
  const Error error = refusal_of([&] { lock(); });
  EXPECT_EQ(error.code(), ExitCode::no_permission);
  EXPECT_THAT(error.what_happened(), HasSubstr("in use by this process"));
}

TEST_F(PortLock, DoesNotLookForItsHolderWhereItIsToBeBrief) {
  const OtherRecorder other(path());
  const Error error = refusal_of([&] { lock(Refusal::brief); });
  EXPECT_EQ(error.code(), ExitCode::no_permission);
  EXPECT_EQ(error.what_happened(), "port is in use");
}

TEST_F(PortLock, IsFreeAgainAfterItsHolderWasKilled) {
  { const OtherRecorder killed(path()); }
  EXPECT_TRUE(lock());
}

TEST_F(PortNames, OfNoPortAreAnsweredWithThePortsThatExist) {
  const Error error = refusal_at("/dev/ttyUSB987");
  EXPECT_EQ(error.code(), ExitCode::device_missing);
  EXPECT_EQ(error.where(), "/dev/ttyUSB987");
  EXPECT_THAT(error.advice(),
              AnyOf(HasSubstr("the ports that exist are /dev/"), HasSubstr("no serial port is connected")));
  for (const PortInfo& port : list_ports()) EXPECT_THAT(error.advice(), HasSubstr(port.path));
}

TEST_F(PortNames, ThatAreEmptyAreRefused) {
  const Error error = refusal_at("");
  EXPECT_EQ(error.code(), ExitCode::device_missing);
  EXPECT_EQ(error.what_happened(), "no port is chosen");
}

TEST_F(PortNames, OfRegularFilesFoldersAndOtherDevicesAreRefused) {
  std::ofstream(in_folder("notes.txt")) << "not a port";
  for (const std::string& path : {in_folder("notes.txt"), in_folder(""), std::string("/dev/null")}) {
    const Error error = refusal_at(path);
    EXPECT_EQ(error.code(), ExitCode::device_missing) << path;
    EXPECT_THAT(error.what_happened(), HasSubstr("not a serial port")) << path;
  }
}

TEST_F(PortNames, ThatAreLinksLeadToTheDevice) {
  std::filesystem::create_symlink("/dev/null", in_folder("inner"));
  std::filesystem::create_symlink("inner", in_folder("camera"));
  EXPECT_EQ(resolve_port(in_folder("camera")), "/dev/null");
}

TEST_F(PortNames, ThatAreDanglingLinksAreMissing) {
  std::filesystem::create_symlink("/dev/ttyUSB987", in_folder("camera"));
  EXPECT_EQ(refusal_at(in_folder("camera")).code(), ExitCode::device_missing);
}

TEST_F(PortNames, OfPortsThatOnlyAGroupMayOpenComeWithThatAdvice) {
  const std::string path = in_folder("ttyUSB0");
  std::ofstream{path};
  std::filesystem::permissions(in_folder(""), std::filesystem::perms::others_exec,
                               std::filesystem::perm_options::add);
  ASSERT_EQ(chmod(path.c_str(), 0), 0);
  const auto open = [&] { open_exclusively(path, Refusal::names_holder); };
  EXPECT_EQ(tests::code_as_nobody(open, "dialout"), static_cast<int>(ExitCode::no_permission));
}

/// What only a terminal shows.
class OpenPort : public PortNames {};

TEST_F(OpenPort, IsRefusedToAllOthersUnderWhateverName) {
  Pty device;
  std::filesystem::create_symlink(device.path(), in_folder("camera"));
  Loop loop;
  Collected collected;
  loop.open(port_at(in_folder("camera")), collected.handlers());
  const Error error = refusal_at(device.path());
  EXPECT_EQ(error.code(), ExitCode::no_permission);
  EXPECT_THAT(error.what_happened(), HasSubstr("in use by this process"));
  const Error brief =
      refusal_of([&] { loop.open(port_at(device.path()), collected.handlers(), Refusal::brief); });
  EXPECT_EQ(brief.what_happened(), "port is in use");
}

/// `cat /dev/ttyUSB0 &`: each byte would go to one of the two.
TEST_F(OpenPort, IsRefusedBesideOneWhoOnlyReadsAndHeIsNamed) {
  Pty device;
  const OtherRecorder reader(device.path(), false);
  Loop loop;
  Collected collected;
  const Error error = refusal_of([&] { loop.open(port_at(device.path()), collected.handlers()); });
  EXPECT_EQ(error.code(), ExitCode::no_permission);
  EXPECT_THAT(error.what_happened(),
              HasSubstr("in use by process " + std::to_string(reader.pid()) + " (test_io)"));
}

TEST_F(OpenPort, MakesThePortRawAndLetsOneByteWakeTheReader) {
  Pty device;
  Loop loop;
  Collected collected;
  termios cooked{};
  tcgetattr(device.fd(), &cooked);
  cooked.c_lflag |= ICANON | ECHO;
  cooked.c_oflag |= OPOST | ONLCR;
  tcsetattr(device.fd(), TCSANOW, &cooked);
  const auto port = loop.open(port_at(device.path()), collected.handlers());
  const Bytes control{0x03, 0x0A, 0x0D, 0x11, 0x13, 0x00, 0xFF, 0x7F};
  device.write(control);
  run_until(loop, [&] { return collected.bytes.size() >= control.size(); });
  EXPECT_EQ(collected.bytes, control);
  loop.write(port, control);
  EXPECT_EQ(device.read(), control);
}

TEST(Pty, TakesNothingWhileNoProgramHasItOpen) {
  Pty device;
  EXPECT_FALSE(device.is_open());
  EXPECT_EQ(device.write(Bytes{1, 2}), 0U);
  EXPECT_TRUE(device.read().empty());
}

TEST(Pty, TakesNoMoreThanItHasRoomFor) {
  Pty device;
  Loop loop;
  Collected collected;
  loop.open(port_at(device.path()), collected.handlers());
  const Bytes sent = numbered_bytes(1'000'000);
  const std::size_t written = device.write(sent);
  EXPECT_GT(written, 1000U);
  EXPECT_LT(written, sent.size());
  run_until(loop, [&] { return collected.bytes.size() >= written; });
  EXPECT_EQ(collected.bytes, Bytes(sent.begin(), sent.begin() + static_cast<std::ptrdiff_t>(written)));
}

TEST(Pty, IsRawForAProgramThatSetsNothing) {
  Pty device;
  for (int opened = 0; opened < 2; ++opened) {
    const int program = open(device.path().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
    ASSERT_GE(program, 0);
    EXPECT_EQ(device.write(Bytes{'a', '\r', 0x03}), 3U);
    Bytes received(8);
    const ssize_t size = read(program, received.data(), received.size());
    received.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
    EXPECT_EQ(received, (Bytes{'a', '\r', 0x03}));
    EXPECT_TRUE(device.read().empty()) << "the terminal echoes";
    close(program);
    EXPECT_FALSE(device.is_open());
  }
}

TEST(Pty, KeepsWhatAProgramWroteBeforeItClosed) {
  Pty device;
  const int program = open(device.path().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_EQ(write(program, "!", 1), 1);
  close(program);
  EXPECT_EQ(device.read(), Bytes{'!'});
}

}  // namespace
}  // namespace thermorig::io
