// SPDX-License-Identifier: MIT
#pragma once

// The only place that includes Asio. Boost 1.74's awaitable.hpp uses std::exchange without including
// <utility>, which g++ 12 no longer brings along: it has to come first.
#include <utility>

// Asio's fences are beyond ThreadSanitizer, which g++ warns about where they are inlined. The loop runs on
// one thread; what it shares with others it shares through locks and atomics.
#if defined(__SANITIZE_THREAD__)
#pragma GCC diagnostic ignored "-Wtsan"
#endif

// Asio is slow to compile: only loop.cpp includes this header.
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
