// SPDX-License-Identifier: MIT
#pragma once

// The only place that includes Beast. Boost 1.74's awaitable.hpp uses std::exchange without including
// <utility>, which g++ 12 no longer brings along: it has to come first.
#include <utility>

// Asio's fences are beyond ThreadSanitizer, which g++ warns about where they are inlined. The loop runs on
// one thread; what it shares with others it shares through locks and atomics.
#if defined(__SANITIZE_THREAD__)
#pragma GCC diagnostic ignored "-Wtsan"
#endif

// Beast is slow to compile: only page_loop.cpp and streams.cpp include this header.
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

namespace thermorig::web {

// g++ 12 destroys a class that is made within a co_await expression twice: what a coroutine of this folder is
// handed there is a variable of the caller's. (A reference and a token, as here, are no such class.)

/// Whoever waits for the socket gets an error.
inline void close(boost::asio::ip::tcp::socket& socket) {
  boost::system::error_code no_matter;
  socket.close(no_matter);
}

/// Makes a coroutine wait for an operation, and get its error as a value.
inline auto into(boost::system::error_code& error) {
  return boost::asio::redirect_error(boost::asio::use_awaitable, error);
}

}  // namespace thermorig::web
