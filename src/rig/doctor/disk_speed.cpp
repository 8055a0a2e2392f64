// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "thermorig/rig/doctor/checks.h"

namespace thermorig::doctor {

namespace {

constexpr std::size_t part_bytes = 1U << 20U;
constexpr std::size_t parts = 8;
constexpr double least_spare = 4.0;        // times what a recording writes
constexpr double promised_loss_s = 0.125;  // of a loss of power

[[noreturn]] void refuse(const std::filesystem::path& file, int error_number) {
  throw Error(ExitCode::storage,
              fmt::format("a test file cannot be written: {}", std::strerror(error_number)), file.string(),
              "--output with another folder, or change its permissions");
}

/// Without a name from the beginning, so that nothing is left of it however the program ends.
class TestFile {
 public:
  TestFile(files::Disk& disk, const std::filesystem::path& folder)
      : path(folder / fmt::format(".thermorig-disk-test-{}", getpid())), disk_(disk) {
    disk.remove(path);  // of an earlier process of this number that was killed
    const auto made = disk.create(path, 0600);
    if (!made.good()) refuse(path, made.error_number);
    file = made.value;
    disk.remove(path);
  }
  ~TestFile() { disk_.close(file); }
  TestFile(const TestFile&) = delete;
  TestFile& operator=(const TestFile&) = delete;

  std::filesystem::path path;
  files::OpenFile file = files::OpenFile::none;

 private:
  files::Disk& disk_;
};

}  // namespace

DiskSpeed measure_disk(files::Disk& disk, const std::filesystem::path& folder,
                       const std::function<HostTime()>& now) {
  const TestFile test(disk, folder);
  std::vector<std::byte> bytes(part_bytes);
  std::uint32_t state = 1;  // nothing that a file system could compress
  for (std::byte& byte : bytes)
    byte = static_cast<std::byte>((state = state * 1664525U + 1013904223U) >> 24U);
  DiskSpeed speed;
  const HostTime begin = now();
  for (std::size_t i = 0; i < parts; ++i) {
    if (const auto written = append_all(disk, test.file, bytes); !written.good())
      refuse(test.path, written.error_number);
    const HostTime before = now();
    if (const int error = disk.sync(test.file); error != 0) refuse(test.path, error);
    speed.sync_s = std::max(speed.sync_s, to_s(now() - before));
  }
  speed.bytes_per_s = static_cast<double>(parts * part_bytes) / std::max(1e-6, to_s(now() - begin));
  return speed;
}

Check judge_disk(const DiskSpeed& speed, double needed_bytes_per_s) {
  Check check{.name = "disk speed",
              .result = fmt::format(
                  "{:.1f} MB/s, the longest sync of 1 MiB took {:.0f} ms; a recording writes {:.0f} kB/s",
                  1e-6 * speed.bytes_per_s, 1e3 * speed.sync_s, 1e-3 * needed_bytes_per_s)};
  const std::string advice =
      "a folder on a disk of this machine instead of a network, a memory card or a USB stick";
  if (speed.bytes_per_s < least_spare * needed_bytes_per_s) {
    check.code = ExitCode::storage;
    check.result += "; that is too slow";
    check.advice = advice;
  } else if (speed.sync_s > promised_loss_s) {
    check.warning = true;
    check.result += "; a power cut would cost more than 125 ms";
    check.advice = advice;
  }
  return check;
}

std::optional<Check> judge_left_parts(const std::filesystem::path& folder,
                                      const std::vector<std::filesystem::path>& left) {
  if (left.empty()) return std::nullopt;
  const std::string more = left.size() == 1 ? "" : fmt::format(", and {} more", left.size() - 1);
  return Check{.name = "left over",
               .result = "half written by a program that was killed: " + left.front().string() + more,
               .advice = "thermorig recover " + folder.string(),
               .warning = true};
}

}  // namespace thermorig::doctor
