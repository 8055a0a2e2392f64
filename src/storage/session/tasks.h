// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "thermorig/storage/sandbox/sealed_copy.h"
#include "thermorig/storage/session/salvage.h"

namespace thermorig::session {

/// Everything that reading the copy asks of libhdf5 and of this program, for nothing: throws as
/// read_session() does.
void read_for_nothing(const sandbox::SealedCopy& copy);

/// What salvage() makes of the copy of a file that was cut short, with zeros in place of the rest, in this
/// process.
Salvaged salvaged_from(const sandbox::SealedCopy& padded, std::uint64_t bytes_there);

/// What altered_attributes() looks for, in this process.
std::vector<std::string> altered_in(const sandbox::SealedCopy& copy);

/// Whether whoever opens this copy as a session gets one: as a program does that reads a stranger's file, a
/// child process first. Throws as tried_copy() and read_session() do.
void require_readable(const sandbox::SealedCopy& copy);

}  // namespace thermorig::session
