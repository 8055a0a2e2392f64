// SPDX-License-Identifier: MIT
#include "thermorig/io/spill/spill.h"

#include "blocks.h"

namespace thermorig::spill {

void arrays_near(const std::filesystem::path& near, const Limits& limits) {
  blocks().configure(near, limits);
  is_on = true;
}

void give_pages_back() {
  if (is_on) blocks().limit_resident();
}

std::size_t spilled_bytes() {
  return blocks().on_disk_bytes();
}

}  // namespace thermorig::spill
