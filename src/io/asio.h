// SPDX-License-Identifier: MIT
#pragma once

// Asio's fences are beyond ThreadSanitizer, which g++ warns about where they are inlined. The loop runs on
// one thread; what it shares with others it shares through locks and atomics.
#if defined(__SANITIZE_THREAD__)
#pragma GCC diagnostic ignored "-Wtsan"
#endif

// Asio is slow to compile: only loop.cpp includes this header.
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
