// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "io/web/message_queue.h"

namespace thermorig::web {

inline Message message(Topic topic, std::string text) {
  return {topic, std::make_shared<const std::string>(std::move(text)), {}};
}

}  // namespace thermorig::web
