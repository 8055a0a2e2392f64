// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <functional>

#include "thermorig/io/files/descriptor.h"
#include "thermorig/storage/session/stored_file.h"

namespace thermorig::session {

/// Whether this was built with a sanitizer that needs more than the program: terabytes of addresses, and a
/// pipe by which it asks whether an object can be read.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define THERMORIG_IS_SANITIZED
#elif defined(__has_feature)  // Clang's way of telling
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define THERMORIG_IS_SANITIZED
#endif
#endif

/// A child process that reads a file. The child is a copy of this thread alone: a lock that another thread
/// holds at that moment stays locked in it, so that who makes one holds those that `read` needs (memory is
/// the C library's affair: it sees to that).
class Trial {
 public:
  /// `read` may throw Error: then the file is refused in its words. Throws Error(failed) if there can be no
  /// child.
  Trial(const StoredFile& file, const std::function<void()>& read);
  ~Trial();
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;

  /// Waits. Throws what `read` threw; Error(not_a_session) for a file that ends its reader, or keeps it busy
  /// for longer than any sound file of its size keeps a slow computer.
  void require_good();

 private:
  void end();

  const StoredFile& file_;
  pid_t child_ = -1;
  int status_ = 0;  // as waitpid() gives it
  files::Descriptor answer_;
};

/// Whether try_sessions_first() was called.
bool are_sessions_tried();

/// Reads the whole file and keeps nothing of it, in a child process if files are tried first. Throws as
/// read_session() does.
void require_readable(const StoredFile& file);

}  // namespace thermorig::session
