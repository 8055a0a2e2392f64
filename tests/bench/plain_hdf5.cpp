// SPDX-License-Identifier: MIT
// What recorders that write HDF5 themselves lose: rows of frames appended to extendible datasets, flushed
// after each frame, with and without SWMR; every prefix of what the library writes is opened by a child
// process and held against what was appended. The counterpart of fault_table.cpp.
#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

namespace {

struct Write {
  std::int64_t offset = 0;
  std::int64_t length = -1;  // of a truncation
  std::vector<char> bytes;
  int frames = 0;  // flushed when it was made
};

std::vector<Write>* the_log = nullptr;  // while a recording is made
int logged_frames = 0;

void note(const void* bytes, std::size_t size, std::int64_t offset) {
  if (the_log == nullptr) return;
  const char* const from = static_cast<const char*>(bytes);
  the_log->push_back({offset, -1, std::vector<char>(from, from + size), logged_frames});
}

void note_length(std::int64_t length) {
  if (the_log != nullptr) the_log->push_back({0, length, {}, logged_frames});
}

}  // namespace

// The library's calls come here first: what it writes is seen as the system sees it.
extern "C" ssize_t pwrite(int file, const void* bytes, size_t size, off_t offset) {
  note(bytes, size, offset);
  return ::syscall(SYS_pwrite64, file, bytes, size, offset);
}
extern "C" ssize_t pwrite64(int file, const void* bytes, size_t size, off_t offset) {
  return pwrite(file, bytes, size, offset);
}
extern "C" int ftruncate(int file, off_t length) noexcept {
  note_length(length);
  return static_cast<int>(::syscall(SYS_ftruncate, file, length));
}
extern "C" int ftruncate64(int file, off_t length) noexcept {
  return ftruncate(file, length);
}

namespace {

constexpr int frames = 60;
constexpr int gyro_per_frame = 25;
constexpr hsize_t pixels = 24 * 32;
constexpr int writeback_frames = 30;  // so long the system keeps what nobody syncs
constexpr unsigned patience_s = 2;    // of a reader

float pixel(hsize_t frame, hsize_t at) {
  return 20.0F + static_cast<float>((frame * 31 + at * 7) % 977) * 0.01F;
}
float rate(hsize_t row) {
  return static_cast<float>(row % 613) - 300.0F;
}

struct Dataset {
  const char* name;
  hsize_t row_values;
  hsize_t rows_per_frame;
  float (*value)(hsize_t row, hsize_t at);
};
constexpr std::array<Dataset, 3> datasets{
    {{"temperature", pixels, 1, [](hsize_t row, hsize_t at) { return pixel(row + 1, at); }},
     {"label", 1, 1, [](hsize_t row, hsize_t) { return 1.0F + static_cast<float>(row); }},
     {"rate", 1, gyro_per_frame, [](hsize_t row, hsize_t) { return rate(row + 1); }}}};

std::vector<float> rows_of(const Dataset& dataset, hsize_t first, hsize_t count) {
  std::vector<float> values;
  for (hsize_t row = first; row < first + count; ++row)
    for (hsize_t at = 0; at < dataset.row_values; ++at) values.push_back(dataset.value(row, at));
  return values;
}

hid_t create(hid_t file, const Dataset& dataset) {
  const hsize_t dims[2] = {0, dataset.row_values}, most[2] = {H5S_UNLIMITED, dataset.row_values};
  const hsize_t chunk[2] = {8 * dataset.rows_per_frame, dataset.row_values};
  const hid_t space = H5Screate_simple(2, dims, most), properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(properties, 2, chunk);
  return H5Dcreate2(file, dataset.name, H5T_IEEE_F32LE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
}

void append(hid_t id, const Dataset& dataset, int frame) {
  const hsize_t rows = dataset.rows_per_frame, first = static_cast<hsize_t>(frame) * rows;
  const hsize_t size[2] = {first + rows, dataset.row_values}, start[2] = {first, 0},
                count[2] = {rows, dataset.row_values};
  H5Dset_extent(id, size);
  const hid_t space = H5Dget_space(id), memory = H5Screate_simple(2, count, nullptr);
  H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, count, nullptr);
  H5Dwrite(id, H5T_NATIVE_FLOAT, memory, space, H5P_DEFAULT, rows_of(dataset, first, rows).data());
  H5Sclose(space);
  H5Sclose(memory);
}

std::vector<Write> record(const std::string& path, bool swmr) {
  std::vector<Write> log;
  the_log = &log;
  logged_frames = 0;
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  if (swmr) H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  std::array<hid_t, datasets.size()> ids{};
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = create(file, datasets[i]);
  if (swmr) H5Fstart_swmr_write(file);
  for (int frame = 0; frame < frames; ++frame) {
    for (std::size_t i = 0; i < ids.size(); ++i) append(ids[i], datasets[i], frame);
    if (swmr)
      for (const hid_t id : ids) H5Dflush(id);
    else
      H5Fflush(file, H5F_SCOPE_GLOBAL);
    logged_frames = frame + 1;
  }
  for (const hid_t id : ids) H5Dclose(id);
  H5Fclose(file);
  the_log = nullptr;
  return log;
}

// ---- reading ------------------------------------------------------------------------------------------

enum Verdict : int { whole = 0, flag = 1, short_ = 2, wrong = 3, unreadable = 4 };

/// Rows that every dataset has, in frames; -1: a value that was never written.
int frames_in(hid_t file) {
  int least = frames;
  for (const Dataset& dataset : datasets) {
    const hid_t id = H5Dopen2(file, dataset.name, H5P_DEFAULT);
    if (id < 0) return -2;
    hsize_t dims[2] = {0, 0};
    H5Sget_simple_extent_dims(H5Dget_space(id), dims, nullptr);
    std::vector<float> values(dims[0] * dataset.row_values);
    if (!values.empty() && H5Dread(id, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      return -2;
    if (values != rows_of(dataset, 0, dims[0])) return -1;
    least = std::min(least, static_cast<int>(dims[0] / dataset.rows_per_frame));
  }
  return least;
}

/// In a child: a damaged file can kill its reader, or hold it for ever.
Verdict read_in_child(const std::string& path, int flushed) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(patience_s);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const bool is_plain = file >= 0;
    if (!is_plain) file = H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, H5P_DEFAULT);
    if (file < 0) std::_Exit(flushed == 0 ? whole : unreadable);
    const int has = frames_in(file);
    if (has == -1) std::_Exit(wrong);
    if (has < flushed - 1) std::_Exit(has == -2 ? unreadable : short_);
    std::_Exit(is_plain ? whole : flag);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? static_cast<Verdict>(WEXITSTATUS(status)) : unreadable;
}

void put(std::vector<char>& content, const Write& write, std::size_t size) {
  if (write.length >= 0) return content.resize(static_cast<std::size_t>(write.length));
  const auto end = static_cast<std::size_t>(write.offset) + size;
  if (content.size() < end) content.resize(end);
  std::memcpy(content.data() + write.offset, write.bytes.data(), size);
}

void store(const std::string& path, const std::vector<char>& content) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  for (std::size_t done = 0; done < content.size();) {
    const ssize_t count = ::write(file, content.data() + done, content.size() - done);
    if (count <= 0) std::abort();
    done += static_cast<std::size_t>(count);
  }
  ::close(file);
}

struct Line {
  int points = 0;
  std::array<int, 5> verdicts{};
};

Line kills(const std::vector<Write>& log, const std::string& left, bool torn) {
  Line line;
  std::vector<char> content;
  for (const Write& write : log) {
    if (write.length < 0 && torn) {
      std::vector<char> half = content;
      put(half, write, write.bytes.size() / 2);
      store(left, half);
    } else {
      put(content, write, write.bytes.size());
      store(left, content);
    }
    ++line.points;
    ++line.verdicts[read_in_child(left, write.frames)];
    if (torn) put(content, write, write.bytes.size());
  }
  return line;
}

/// Nothing is ever synced: of what was written in the last frames each write may be missing.
Line power_losses(const std::vector<Write>& log, const std::string& left, int points) {
  Line line;
  std::mt19937 random(1);
  for (int i = 0; i < points; ++i) {
    const std::size_t end = 1 + random() % log.size();
    const int safe = log[end - 1].frames - writeback_frames;
    std::vector<char> content;
    for (std::size_t k = 0; k < end; ++k)
      if (log[k].frames <= safe || random() % 2 == 0 || log[k].length >= 0)
        put(content, log[k], log[k].bytes.size());
    store(left, content);
    ++line.points;
    ++line.verdicts[read_in_child(left, log[end - 1].frames)];
  }
  return line;
}

}  // namespace

int main(int count, char** words) {
  const bool json = count > 1 && std::string(words[1]) == "--json";
  // In memory: a disk would sync each of the thousands of files that take the place of another.
  std::string folder =
      std::string(::access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp") + "/plain-hdf5-XXXXXX";
  if (::mkdtemp(folder.data()) == nullptr) return 1;
  const std::string recorded = folder + "/recorded.h5";
  const std::string left = folder + "/left.h5";
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  ::setenv("HDF5_USE_FILE_LOCKING", "FALSE", 1);
  nlohmann::json lines = nlohmann::json::array();
  if (!json)
    fmt::print("{:<46} {:>7} {:>9} {:>9} {:>9} {:>9} {:>10}\n", "plain HDF5", "points", "good", "flag",
               "short", "silent", "unreadable");
  for (const bool swmr : {false, true}) {
    const std::vector<Write> log = record(recorded, swmr);
    const std::string mode = swmr ? "SWMR, flush each frame" : "H5Fflush each frame";
    const std::array<std::pair<const char*, Line>, 3> results{
        {{"killed between writes", kills(log, left, false)},
         {"killed inside a write", kills(log, left, true)},
         {"power lost", power_losses(log, left, 200)}}};
    for (const auto& [what, line] : results) {
      const auto& [good, with_flag, too_short, silent, dead] = line.verdicts;
      lines.push_back({{"mode", mode},
                       {"fault", what},
                       {"points", line.points},
                       {"good", good},
                       {"needs_flag", with_flag},
                       {"short", too_short},
                       {"silent", silent},
                       {"unreadable", dead}});
      if (!json)
        fmt::print("{:<46} {:>7} {:>9} {:>9} {:>9} {:>9} {:>10}\n", mode + ", " + what, line.points, good,
                   with_flag, too_short, silent, dead);
    }
  }
  if (json) fmt::print("{}\n", lines.dump(2));
  ::unlink(recorded.c_str());
  ::unlink(left.c_str());
  ::rmdir(folder.c_str());
  return 0;
}
