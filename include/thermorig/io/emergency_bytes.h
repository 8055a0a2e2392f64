// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace thermorig::io {

/// Bytes that a port gets whatever ends the program while it is open: a fatal signal (also abort(), and with
/// it std::terminate and a failed assertion), exit(), an exception that leaves the loop. What cannot run code
/// any more, as after kill -9, says nothing: a device needs a watchdog all the same.

/// From now on `fd` gets `bytes` (up to 4). At most 4 descriptors. The first call makes this program catch
/// the signals that would end it and have been left at their default; after the bytes each does what it did.
/// Not from several threads at once.
void keep_emergency_bytes(int fd, std::span<const std::uint8_t> bytes);

/// The port is about to be closed in peace. Does nothing if there are none for it.
void forget_emergency_bytes(int fd);

/// Sends them now, once more if need be. Allocates nothing, and may be called from a signal handler.
void send_emergency_bytes();

}  // namespace thermorig::io
