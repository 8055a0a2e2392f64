// SPDX-License-Identifier: MIT
#include "enumeration.h"

#include <algorithm>

namespace thermorig::storage_test {

namespace {

constexpr auto promised = std::chrono::milliseconds(125);
constexpr int cuts_per_write = 3;

using Data = PowerLoss::Data;
using Kept = PowerLoss::Names;
constexpr std::array<PowerLoss, 6> losses{{{Data::lost, Kept::lost},
                                           {Data::zeros, Kept::kept},
                                           {Data::some_sectors, Kept::some},
                                           {Data::garbage, Kept::kept},
                                           {Data::torn, Kept::some},
                                           {Data::kept, Kept::some}}};
constexpr std::array<const char*, 6> loss_names{
    "all that was not synced is lost",    "length kept, bytes zero",
    "some sectors lost, some names lost", "some sectors hold garbage",
    "torn at a byte, some names lost",    "all bytes kept, some names lost"};

constexpr std::array faults{FaultKind::io_error, FaultKind::no_space, FaultKind::short_write,
                            FaultKind::done_but_error, FaultKind::not_supported};
constexpr std::array<const char*, 5> fault_names{"EIO", "ENOSPC", "short write", "done, but EIO",
                                                 "not supported"};

std::uint64_t mixed(std::uint64_t a, std::uint64_t b) {
  std::uint64_t hash = (a + 0x9E3779B97F4A7C15U) ^ (b * 0xBF58476D1CE4E5B9U);
  hash = (hash ^ (hash >> 30U)) * 0x94D049BB133111EBU;
  return hash ^ (hash >> 31U);
}

/// Which path each open file of a log of calls was created under.
using CreatedFiles = std::map<files::OpenFile, std::string>;

class Enumerator {
 public:
  Enumerator(const RecordedSession& truth, const EnumerationSettings& settings)
      : truth_(truth), settings_(settings), judge_(truth, settings.recover_stride) {
    if (!settings.samples.empty()) judge_.keep_samples(settings.samples, 100);
  }

  Enumeration run() {
    walk_recording();
    fail_recording();
    walk_recoveries();
    result_.recoveries = judge_.recoveries();
    result_.readings = judge_.readings();
    return std::move(result_);
  }

 private:
  /// Is this point one of ours, and drawn?
  bool draw(std::uint64_t call, std::uint64_t variant, double share) const {
    const std::uint64_t number = mixed(mixed(settings_.seed, call), variant);
    return call % settings_.parts == settings_.part && static_cast<double>(number >> 11U) < share * 0x1p53;
  }
  std::mt19937_64 random_at(std::uint64_t call, std::uint64_t variant) const {
    return std::mt19937_64(mixed(mixed(settings_.seed + 1, call), variant));
  }

  bool is_left_out(const Call& call) const {
    return (settings_.mutation == Mutation::no_sync && call.kind == CallKind::sync) ||
           (settings_.mutation == Mutation::no_folder_sync && call.kind == CallKind::sync_folder);
  }

  void count(const std::string& line, Outcome outcome, const Found& found, const std::string& where) {
    Tally& tally = result_.lines[line];
    ++tally.points;
    ++tally.outcomes[static_cast<std::size_t>(outcome)];
    if (outcome != Outcome::silent && outcome != Outcome::beyond) return;
    if (tally.example.empty())
      tally.example = where + ": " + (found.wrong.empty() ? "less than was promised" : found.wrong) +
                      (found.said.empty() ? "" : " (" + found.said + ")");
  }

  void judge(const std::string& line, const DiskImage& image, const Chunks& required,
             const std::string& where) {
    const Found& found = judge_.found(image);
    count(line, outcome_of(found, required), found, where);
  }

  void note_loss(const std::string& line, const DiskImage& image, HostTime now) {
    const Found& found = judge_.found(image);
    double& worst = result_.lines[line].worst_loss_ms;
    for (const Device device : all_devices) {
      const auto& times = truth_.received[device].chunks.time_ns;
      const std::size_t kept = found.kept[device];
      if (kept >= times.size() || times[kept] > to_ns(now)) continue;
      worst = std::max(worst, to_s(now - host_time_ns(times[kept])) * 1e3);
    }
  }

  // ---- the recording ----------------------------------------------------------------------------------

  Chunks taken(std::size_t calls) const {
    Chunks chunks;
    for (const Device device : all_devices) chunks[device] = truth_.taken(device, calls);
    return chunks;
  }

  Chunks promised_at(std::size_t calls, HostTime now) const {
    if (calls >= truth_.concluded) return taken(calls);
    Chunks chunks;
    for (const Device device : all_devices)
      chunks[device] = std::min(truth_.taken(device, calls), truth_.arrived(device, now - promised));
    return chunks;
  }

  void walk_recording() {
    MemoryDisk disk = new_disk();
    CreatedFiles created;
    for (std::size_t k = 0; k < truth_.calls.size(); ++k) {
      const Call& call = truth_.calls[k];
      const std::string where =
          "call " + std::to_string(k) + ", " + std::string(call_names[static_cast<std::size_t>(call.kind)]);
      cut_write("process ends inside a write of the recording", disk, created, call, k, settings_.share,
                taken(k), where);
      make(disk, created, call);
      if (draw(k, 100, settings_.share))
        judge("process ends between calls of the recording", disk.after_end(), taken(k + 1), where);
      for (std::size_t i = 0; i < losses.size(); ++i) {
        if (!draw(k, 200 + i, settings_.share)) continue;
        std::mt19937_64 random = random_at(k, i);
        const std::string line = std::string("power lost, recording: ") + loss_names[i];
        const DiskImage image = disk.after_power_loss(losses[i], random);
        judge(line, image, promised_at(k + 1, call.time), where);
        if (k + 1 < truth_.concluded) note_loss(line, image, call.time);
      }
    }
  }

  void make(MemoryDisk& disk, CreatedFiles& created, const Call& call) const {
    if (call.kind == CallKind::create) created[static_cast<files::OpenFile>(disk.next_open())] = call.path;
    if (!is_left_out(call)) apply(disk, call);
  }

  void cut_write(const std::string& line, const MemoryDisk& disk, const CreatedFiles& created,
                 const Call& call, std::size_t k, double share, const Chunks& required,
                 const std::string& where) {
    if (call.kind != CallKind::append || call.bytes.size() < 2) return;
    for (std::uint64_t i = 0; i < cuts_per_write; ++i) {
      if (!draw(k, 300 + i, share)) continue;
      std::mt19937_64 random = random_at(k, 300 + i);
      DiskImage image = disk.after_end();
      auto& file = image.files.at(created.at(call.file));
      Bytes bytes = *file;
      const auto cut = 1 + random() % (call.bytes.size() - 1);
      bytes.insert(bytes.end(), call.bytes.begin(), call.bytes.begin() + static_cast<std::ptrdiff_t>(cut));
      file = std::make_shared<const Bytes>(std::move(bytes));
      judge(line, image, required, where);
    }
  }

  // ---- errors while recording -------------------------------------------------------------------------

  void fail_recording() {
    if (settings_.error_stride == 0) return;
    std::size_t appends = 0;
    for (std::size_t k = 0; k < truth_.calls.size(); ++k) {
      const CallKind kind = truth_.calls[k].kind;
      const bool is_chunk = kind == CallKind::append && k + 40 < truth_.calls.size();
      const bool is_often = is_chunk || kind == CallKind::sync || kind == CallKind::free_bytes;
      const std::size_t stride = !is_often  ? 1
                                 : is_chunk ? settings_.error_stride
                                            : settings_.error_stride / 4 + 1;
      if (is_often && ++appends % stride != 0) continue;
      for (std::size_t i = 0; i < faults.size(); ++i)
        for (const bool lasting : {false, true})
          if (can_fail(kind, faults[i]) && draw(k, 400 + 2 * i + lasting, settings_.error_share))
            fail_call({faults[i], k, lasting}, fault_names[i]);
    }
  }

  void fail_call(const Fault& fault, const std::string& name) {
    MemoryDisk memory = new_disk();
    HostTime clock{};
    FaultDisk disk(memory, fault);
    disk.set_clock(&clock);
    const RecordedAgain again = record_again(truth_, disk, &clock);
    const std::string where = "call " + std::to_string(fault.call) + ", " +
                              std::string(call_names[static_cast<std::size_t>(disk.kind_hit())]) +
                              (again.announced ? "" : ", " + again.error);
    const std::string line = "recording: " + name + (fault.lasting ? " from a call on" : " at one call");
    Found found = judge_.found(memory.after_end());
    if (!again.announced && again.code != ExitCode::storage) found.wrong = "another exit code";
    if (!again.announced && again.end - disk.time_hit() > promised && !fault.lasting)
      found.wrong = "went on for more than a frame";
    found.is_loud = found.is_loud || !again.announced;
    count(line, outcome_of(found, again.taken), found, where);
    fail_then_lose_power(memory, again, disk.time_hit(), line + ", then power lost", where);
  }

  void fail_then_lose_power(const MemoryDisk& memory, const RecordedAgain& again, HostTime time_hit,
                            const std::string& line, const std::string& where) {
    Chunks required = again.taken;
    if (!again.announced)
      for (const Device device : all_devices)
        required[device] = std::min(again.taken[device], truth_.arrived(device, time_hit - promised));
    std::mt19937_64 random(settings_.seed);
    for (const PowerLoss loss : {losses[0], losses[2]}) {
      Found found = judge_.found(memory.after_power_loss(loss, random));
      found.is_loud = found.is_loud || !again.announced;
      count(line, outcome_of(found, required), found, where);
    }
  }

  // ---- recovery ---------------------------------------------------------------------------------------

  /// Disks as a crash early in the recording leaves them, and as one at its end does.
  std::vector<DiskImage> starts() const {
    std::vector<DiskImage> images;
    const std::size_t closed = truth_.calls.size() - 40;
    const std::size_t early = truth_.calls.size() / 8;
    MemoryDisk disk = new_disk();
    CreatedFiles created;
    for (std::size_t k = 0; k < truth_.calls.size(); ++k) {
      make(disk, created, truth_.calls[k]);
      const bool is_early = k < early && k % (early / settings_.starts + 1) == 0;
      if (is_early || (k > closed && settings_.starts > 8 && k % 10 == 0)) images.push_back(disk.after_end());
    }
    return images;
  }

  void walk_recoveries() {
    std::uint64_t number = 1'000'000;
    for (const DiskImage& image : starts()) {
      number += 1'000;
      if ((number / 1'000) % settings_.parts != settings_.part) continue;
      if (image.files.empty()) continue;
      const Found start = judge_.recovered(image);
      walk_recovery(image, start.kept, number);
      fail_recovery(image, start.kept);
    }
  }

  void walk_recovery(const DiskImage& image, const Chunks& required, std::uint64_t number) {
    MemoryDisk first(image);
    FaultDisk logged(first);
    logged.keep_calls(nullptr);
    recover_on(logged);
    MemoryDisk disk(image);
    CreatedFiles created;
    const unsigned parts = settings_.parts;
    for (std::size_t k = 0; k < logged.calls().size(); ++k) {
      const Call& call = logged.calls()[k];
      const std::string where = "call " + std::to_string(k) + " of a recovery, " +
                                std::string(call_names[static_cast<std::size_t>(call.kind)]);
      const std::uint64_t id = (number + k) * parts + settings_.part;  // all of them are ours
      cut_write("process ends inside a write of recovery", disk, created, call, id, 1.0, required, where);
      make(disk, created, call);
      judge("process ends between calls of recovery", disk.after_end(), required, where);
      for (std::size_t i = 0; i < losses.size(); ++i) {
        std::mt19937_64 random = random_at(id, i);
        judge("power lost, recovery", disk.after_power_loss(losses[i], random), required, where);
      }
    }
    calls_of_recovery_ = logged.calls();
  }

  void fail_recovery(const DiskImage& image, const Chunks& required) {
    for (std::size_t k = 0; k < calls_of_recovery_.size(); ++k)
      for (std::size_t i = 0; i < faults.size(); ++i)
        for (const bool lasting : {false, true})
          if (can_fail(calls_of_recovery_[k].kind, faults[i]) &&
              draw(k * settings_.parts + settings_.part, 500 + 2 * i + lasting, settings_.error_share))
            fail_recovery_call(image, required, {faults[i], k, lasting}, fault_names[i]);
  }

  void fail_recovery_call(const DiskImage& image, const Chunks& required, const Fault& fault,
                          const std::string& name) {
    MemoryDisk memory(image);
    FaultDisk disk(memory, fault);
    const Found first = recover_on(disk);
    const std::string where = "call " + std::to_string(fault.call) + " of a recovery, " +
                              std::string(call_names[static_cast<std::size_t>(disk.kind_hit())]) + ", " +
                              first.said;
    std::mt19937_64 random(settings_.seed);
    for (const bool power_lost : {false, true}) {
      Found found =
          judge_.found(power_lost ? memory.after_power_loss(losses[0], random) : memory.after_end());
      found.is_loud = found.is_loud || first.is_loud;
      const std::string line =
          "recovery: " + name + (power_lost ? ", then power lost" : "") + ", then run again";
      count(line, outcome_of(found, required), found, where);
    }
  }

  const RecordedSession& truth_;
  const EnumerationSettings settings_;
  Judge judge_;
  Enumeration result_;
  std::vector<Call> calls_of_recovery_;
};

}  // namespace

Enumeration enumerate(const RecordedSession& truth, const EnumerationSettings& settings) {
  return Enumerator(truth, settings).run();
}

void add(Enumeration& sum, const Enumeration& part) {
  for (const auto& [line, tally] : part.lines) {
    Tally& to = sum.lines[line];
    to.points += tally.points;
    for (std::size_t i = 0; i < tally.outcomes.size(); ++i) to.outcomes[i] += tally.outcomes[i];
    to.worst_loss_ms = std::max(to.worst_loss_ms, tally.worst_loss_ms);
    if (to.example.empty()) to.example = tally.example;
  }
  sum.recoveries += part.recoveries;
  sum.readings += part.readings;
}

std::uint64_t points_of(const Enumeration& enumeration) {
  std::uint64_t points = 0;
  for (const auto& [line, tally] : enumeration.lines) points += tally.points;
  return points;
}

std::uint64_t count_of(const Enumeration& enumeration, Outcome outcome) {
  std::uint64_t count = 0;
  for (const auto& [line, tally] : enumeration.lines)
    count += tally.outcomes[static_cast<std::size_t>(outcome)];
  return count;
}

}  // namespace thermorig::storage_test
