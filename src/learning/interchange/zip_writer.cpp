// SPDX-License-Identifier: MIT
#include "zip_writer.h"

#include "checked_sink.h"
#include "little_endian_text.h"

namespace thermorig::interchange {

namespace {

constexpr std::uint16_t version = 45;  // that of ZIP64
constexpr std::uint16_t utf8_names = 0x800;
constexpr std::uint16_t stored = 0;
constexpr std::uint16_t no_time = 0, first_date = 0x21;  // 1980-01-01: the same session gives the same bytes
constexpr std::uint16_t zip64_field = 1;
constexpr std::uint32_t elsewhere = 0xFFFFFFFF;  // the number stands in a field of ZIP64
constexpr std::uint16_t elsewhere_16 = 0xFFFF;

}  // namespace

void ZipWriter::write(const std::string& bytes) {
  sink_.write(bytes);
  written_ += bytes.size();
}

void ZipWriter::add(const std::string& name, const std::function<void(Sink&)>& produce) {
  CheckedSink dry;
  produce(dry);
  members_.push_back({name, dry.crc(), dry.size(), written_});
  const auto length = static_cast<std::uint16_t>(name.size());
  std::string header = "PK\x03\x04";
  append_little_endian(header, version, utf8_names, stored, no_time, first_date, dry.crc(), elsewhere,
                       elsewhere, length, std::uint16_t{20});
  header += name;
  append_little_endian(header, zip64_field, std::uint16_t{16}, dry.size(), dry.size());
  write(header);
  produce(sink_);
  written_ += dry.size();
}

void ZipWriter::finish() {
  const std::uint64_t begin = written_;
  for (const Member& member : members_) {
    std::string entry = "PK\x01\x02";
    append_little_endian(entry, version, version, utf8_names, stored, no_time, first_date, member.crc,
                         elsewhere, elsewhere, static_cast<std::uint16_t>(member.name.size()),
                         std::uint16_t{28}, std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0},
                         std::uint32_t{0}, elsewhere);
    entry += member.name;
    append_little_endian(entry, zip64_field, std::uint16_t{24}, member.size, member.size, member.begin);
    write(entry);
  }
  write_ends(begin);
}

void ZipWriter::write_ends(std::uint64_t directory_begin) {
  const std::uint64_t directory_end = written_, count = members_.size();
  std::string ends = "PK\x06\x06";
  append_little_endian(ends, std::uint64_t{44}, version, version, std::uint32_t{0}, std::uint32_t{0}, count,
                       count, directory_end - directory_begin, directory_begin);
  ends += "PK\x06\x07";
  append_little_endian(ends, std::uint32_t{0}, directory_end, std::uint32_t{1});
  ends += "PK\x05\x06";
  append_little_endian(ends, std::uint16_t{0}, std::uint16_t{0}, elsewhere_16, elsewhere_16, elsewhere,
                       elsewhere, std::uint16_t{0});
  write(ends);
}

}  // namespace thermorig::interchange
