// SPDX-License-Identifier: MIT
#include "page_address.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

#include "print/output.h"

namespace thermorig::app {

namespace {

/// Is it a file whose text others can read as well? A terminal, a pipe or a socket leads to whoever began
/// this.
bool is_read_by_others(std::FILE* stream) {
  struct stat info {};
  if (::fstat(::fileno(stream), &info) != 0 || !S_ISREG(info.st_mode)) return false;
  return (info.st_mode & (S_IRGRP | S_IROTH)) != 0 || info.st_uid != ::geteuid();
}

/// Where the address is that the output may not have.
std::string whereabouts(const web::Server& page, bool on_standard_error) {
  if (!page.kept_in().empty())
    return fmt::format("the address with its token is {}under \"url\" in {}",
                       on_standard_error ? "on standard error, and " : "",
                       printable(page.kept_in().string()));
  if (on_standard_error) return "the address with its token is on standard error";
  return "the address with its token is kept nowhere; print to a terminal, or to a file that is yours alone";
}

/// The address alone, and where the token is; standard error, if it is another and nobody else's, gets both.
void tell_without_token(const web::Server& page, std::FILE* stream) {
  const bool shown_beside = stream != stderr && !is_read_by_others(stderr);
  if (shown_beside) print(stderr, "page  {}\n", page.url());
  print(stream, "page  http://127.0.0.1:{}/ (others may read this output: {})\n", page.port(),
        whereabouts(page, shown_beside));
}

/// The browser of somebody who came by SSH is elsewhere; SSH_CONNECTION has the address that they came to.
/// The command has a line of its own, which is not broken.
void tell_tunnel(const web::Server& page, std::FILE* stream) {
  const char* connection = std::getenv("SSH_CONNECTION");
  if (connection == nullptr) return;
  std::istringstream words(connection);
  std::string word, address;
  for (int i = 0; i < 3 && words >> word; ++i) address = word;  // client's address and port, our address
  print(stream, "note  for a browser on your own computer:\n      ssh -L {0}:127.0.0.1:{0} {1}\n",
        page.port(), printable(address));
}

}  // namespace

void tell_page(const web::Server& page, bool json) {
  std::FILE* stream = json ? stderr : stdout;
  if (is_read_by_others(stream))
    tell_without_token(page, stream);
  else
    print(stream, "page  {}\n", page.url());
  if (!web::page_is_built())
    print(stream,
          "note  this program was built without its page: bash app/setup.sh page, then cmake --preset "
          "release && cmake --build build\n");
  tell_tunnel(page, stream);
  if (!page.note().empty()) print(stream, "note  {}\n", printable(page.note()));
  std::fflush(stream);
}

}  // namespace thermorig::app
