// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <thread>
#include <utility>

#include "chunk_writer.h"
#include "hdf5_handle.h"
#include "session_image.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/replaced_file.h"
#include "thermorig/storage/session/session.h"
#include "thermorig/storage/session/trial.h"
#include "trial.h"

namespace thermorig::session {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t write_bytes = 8U << 20U;  // at a time: one call brings all that it writes into memory

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

/// Of a session that takes the place of one: there is no journal, and no --output.
std::string advice_to_replace(int error_number) {
  const std::string kept = "; the session is as it was";
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "free as much as the session takes on its disk" + kept;
    case EACCES:
    case EPERM:
    case EROFS:
      return "a folder that you may write to: copy the session there" + kept;
    default:
      return files::usual_advice(error_number) + kept;
  }
}

[[noreturn]] void refuse_to_write(const std::string& action, int error_number, const fs::path& path) {
  throw Error(ExitCode::storage, fmt::format("{}: {}", action, std::strerror(error_number)), path.string(),
              advice_for(error_number));
}

/// What a reader would refuse never gets its name: nobody shall remove what it was made of.
void require_readable_again(const StoredFile& written) {
  try {
    require_readable(written);
  } catch (const Error& error) {
    throw Error(error.code(), "what was made of it could not be read again: " + error.what_happened(),
                written.path().string(),
                "nothing was changed: its journal, or the session that it was to replace, is still there");
  }
}

/// It is built in memory: no disk has to do with what fails there.
SessionImage image_of(const Session& session, const std::vector<StoredAttribute>& added,
                      const fs::path& path) {
  try {
    return build_image(session, std::thread::hardware_concurrency(), added);
  } catch (const Hdf5Failure& failure) {
    throw Error(ExitCode::failed, fmt::format("{}: there is not enough memory", failure.what()),
                path.string(), "close other programs, or raise its limit (ulimit -v), then try again");
  }
}

void write_image(files::PartFile& part, const Session& session, const std::vector<StoredAttribute>& added) {
  SessionImage image = image_of(session, added, part.path());
  part.reserve(image.bytes.size());
  for (auto left = image.bytes; !left.empty(); left = left.subspan(std::min(left.size(), write_bytes)))
    part.write(left.first(std::min(left.size(), write_bytes)));
  part.begin_sync();
  image.release();  // or there would be two of it
  const auto read_back = [&part](std::uint64_t offset, std::span<std::byte> out) {
    part.read_back(offset, out);
  };
  const StoredFile written(part.size(), read_back, part.path());
  check_written(written, image);
  require_readable_again(written);
  part.sync();
}

}  // namespace

void write_session(const fs::path& path, const Session& session, files::Disk& disk) {
  const auto taken = disk.look(path);
  if (!taken.good()) refuse_to_write("cannot look at the folder", taken.error_number, path);
  if (taken.value != files::FileKind::missing) refuse_to_write("the session exists already", EEXIST, path);
  files::PartFile part(path, "the session", advice_for, disk);
  try {
    write_image(part, session, {});
  } catch (const Hdf5Failure& failure) {
    throw Error(ExitCode::storage, failure.what(), path.string(), advice_for(EIO));
  }
  part.publish();
}

files::ReplacedFile replaced_session(const fs::path& path, files::Disk& disk) {
  std::error_code hidden;
  const fs::file_status status = fs::status(path, hidden);
  if (fs::exists(status) && !fs::is_regular_file(status)) const StoredFile refuses(path);  // and says why
  return files::ReplacedFile(path, "the session", advice_to_replace, disk);
}

std::vector<std::string> write_again(files::PartFile& part, const fs::path& old, const Session& session,
                                     files::Disk& disk) {
  try {
    AddedByOthers added = added_by_others(StoredFile(disk, old));
    write_image(part, session, added.attributes);
    return std::move(added.objects);
  } catch (const Hdf5Failure& failure) {
    throw Error(ExitCode::storage, failure.what(), part.path().string(), advice_to_replace(EIO));
  }
}

}  // namespace thermorig::session
