// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <thread>

#include "chunk_writer.h"
#include "hdf5_handle.h"
#include "session_image.h"
#include "thermorig/core/error.h"
#include "thermorig/files/part_file.h"
#include "thermorig/session/session.h"

namespace thermorig::session {

namespace {

namespace fs = std::filesystem;

std::string advice_for(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "free some space or choose another disk, then run thermorig recover: the journal is still there";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder that you may write to with --output";
    case EEXIST:
      return "choose another name: a session is never overwritten";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first, or choose another with --output";
    default:
      return "check the disk (dmesg), then run thermorig recover: the journal is still there";
  }
}

[[noreturn]] void refuse_to_write(const std::string& action, int error_number, const fs::path& path) {
  throw Error(ExitCode::storage, fmt::format("{}: {}", action, std::strerror(error_number)), path.string(),
              advice_for(error_number));
}

void write_file(const fs::path& path, const Session& session, bool overwrite, files::Disk& disk) {
  if (!overwrite) {
    const auto taken = disk.look(path);
    if (!taken.good()) refuse_to_write("cannot look at the folder", taken.error_number, path);
    if (taken.value != files::FileKind::missing) refuse_to_write("the session exists already", EEXIST, path);
  }
  files::PartFile part(path, "the session", advice_for, disk);
  SessionImage image = build_image(session, std::thread::hardware_concurrency());
  part.write(image.bytes);
  image.release();  // or there would be two of it
  check_written(part.read_back(), image);
  part.sync();
  part.publish(overwrite);
}

void write_or_explain(const fs::path& path, const Session& session, bool overwrite, files::Disk& disk) {
  try {
    write_file(path, session, overwrite, disk);
  } catch (const Hdf5Failure& failure) {
    throw Error(ExitCode::storage, failure.what(), path.string(), advice_for(EIO));
  }
}

}  // namespace

void write_session(const fs::path& path, const Session& session, files::Disk& disk) {
  write_or_explain(path, session, false, disk);
}

void replace_session(const fs::path& path, const Session& session, files::Disk& disk) {
  write_or_explain(path, session, true, disk);
}

}  // namespace thermorig::session
