// SPDX-License-Identifier: MIT
#include "thermorig/io/web/server.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <fstream>
#include <future>

#include "served_page.h"
#include "thermorig/core/error.h"
#include "web/private_folder.h"

namespace thermorig::web {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class PageServer : public ServedPage {
 protected:
  /// The next messages of a stream, or "closed".
  static std::vector<std::string> take(PageClient& client, std::size_t count) {
    std::vector<std::string> texts;
    while (texts.size() < count) {
      const Arrival arrival = client.receive();
      texts.push_back(arrival.kind == Arrival::Kind::text ? arrival.text : "closed");
      if (arrival.kind != Arrival::Kind::text) break;
    }
    return texts;
  }
};

// --- the page ---------------------------------------------------------------------------------------------

TEST_F(PageServer, ServesThePageWithTheHeadersThatProtectIt) {
  PageClient client = connect();
  const auto page = client.get("/", "Accept-Encoding: gzip\r\n");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.field("Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(page.field("Content-Encoding"), "gzip");
  EXPECT_EQ(
      page.field("Content-Security-Policy"),
      fmt::format("default-src 'self'; connect-src 'self' ws://{}; frame-ancestors 'none'; base-uri 'none'; "
                  "form-action 'none'",
                  host()));
  EXPECT_EQ(page.field("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(page.field("Referrer-Policy"), "no-referrer");
  EXPECT_EQ(page.field("Cache-Control"), "no-store");
  EXPECT_EQ(page.field("Cross-Origin-Resource-Policy"), "same-origin");
  EXPECT_EQ(page.field("Cross-Origin-Opener-Policy"), "same-origin");
  EXPECT_EQ(page.field("Set-Cookie"), "");
  EXPECT_THAT(page.body, ::testing::StartsWith("\x1f\x8b"));
}

TEST_F(PageServer, ServesEveryFileOnOneConnection) {
  PageClient client = connect();
  for (const std::string target : {"/", "/page.js", "/page.css", "/licences.txt"}) {
    const auto file = client.get(target);
    EXPECT_EQ(file.status, 200) << target;
    EXPECT_EQ(file.field("Content-Encoding"), "") << target;
    EXPECT_NE(file.field("ETag"), "") << target;
  }
}

TEST_F(PageServer, AnswersHeadWithoutABody) {
  PageClient client = connect();
  client.send(fmt::format("HEAD / HTTP/1.1\r\nHost: {}\r\nAccept-Encoding: gzip\r\n\r\n", host()));
  const auto head = client.reply(true);
  EXPECT_EQ(head.status, 200);
  EXPECT_GT(std::stoi(head.field("Content-Length")), 0);
  EXPECT_EQ(client.get("/page.css").status, 200) << "the next answer begins where the headers ended";
}

TEST_F(PageServer, PutsTheHeadersOnRefusalsAndStreamsAsWell) {
  EXPECT_EQ(get_with_host("a.example").field("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(connect().get("/none").field("Cache-Control"), "no-store");
  EXPECT_EQ(reply_to("garbage\r\n\r\n").field("Referrer-Policy"), "no-referrer");
  EXPECT_EQ(connect().upgrade().field("X-Content-Type-Options"), "nosniff");
}

TEST_F(PageServer, NamesNoProductInItsAnswers) {
  for (const Reply& reply : {connect().get("/"), connect().get("/none"), connect().upgrade()})
    EXPECT_EQ(reply.field("Server"), "") << reply.headers;
}

TEST_F(PageServer, ListensOnLoopbackAlone) {
  // Columns of /proc/net/tcp: number, address:port, other side, state (0A: listens); addresses as in memory.
  const std::string port = fmt::format(":{:04X}", server().port());
  std::vector<std::string> addresses;
  for (const auto table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    std::ifstream lines(table);
    for (std::string number, address, other, rest;
         lines >> number >> address >> other && std::getline(lines, rest);)
      if (address.ends_with(port) && rest.starts_with(" 0A")) addresses.push_back(address);
  }
  ASSERT_FALSE(addresses.empty());
  for (const auto& address : addresses)
    EXPECT_TRUE(address == "0100007F" + port || address == "00000000000000000000000001000000" + port)
        << address;
}

TEST_F(PageServer, AnswersOneAfterTheOtherToRequestsThatComeTogether) {
  PageClient client = connect();
  const std::string request = fmt::format("GET /page.css HTTP/1.1\r\nHost: {}\r\n\r\n", host());
  client.send(request + request + request);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(client.reply().status, 200);
}

TEST_F(PageServer, HasATokenInTheFragmentOfItsAddress) {
  EXPECT_THAT(server().url(), MatchesRegex("http://127\\.0\\.0\\.1:[0-9]+/#t=[0-9a-f]{32}"));
  EXPECT_EQ(server().note(), "");
}

// --- orders -----------------------------------------------------------------------------------------------

TEST_F(PageServer, TakesOrders) {
  options_.control = true;
  PageClient client = connect();
  EXPECT_EQ(client.post("/stop", token(), "{}").status, 204);
  EXPECT_EQ(client.post("/mark", token(), R"({"note":"a bird, 3 \u00b0C, \ud83d\udc26"})").status, 204);
  EXPECT_EQ(client.post("/mark", token(), "{}").status, 204);
  EXPECT_EQ(client.post("/start", token(), "{}").status, 204);
  const auto taken = orders();
  ASSERT_EQ(taken.size(), 4U);
  EXPECT_EQ(taken[0].kind, OrderKind::stop);
  EXPECT_EQ(taken[1].kind, OrderKind::mark);
  EXPECT_EQ(taken[1].note, "a bird, 3 \u00b0C, \U0001F426");
  EXPECT_EQ(taken[2].note, "");
  EXPECT_EQ(taken[3].kind, OrderKind::start);
}

TEST(PageServerOrders, ThatThrowAreRefusedAndTheServerGoesOn) {
  ServerOptions options;
  options.port = 0;
  Server server(options, [](const Order&) { throw std::runtime_error("no"); });
  EXPECT_EQ(PageClient(server.port()).post("/stop", token_of(server.url()), "{}").status, 500);
  EXPECT_EQ(PageClient(server.port()).get("/").status, 200);
}

// --- streams ----------------------------------------------------------------------------------------------

TEST_F(PageServer, TellsANewClientTheRunSoFarInOrder) {
  server().publish(Topic::state, "state 1");
  server().publish(Topic::image, "image 1");
  server().publish(Topic::hello, "hello");
  server().publish(Topic::frame, "frame 1");
  server().publish(Topic::event, "event 1");
  server().publish(Topic::frame, "frame 2");
  server().publish(Topic::state, "state 2");
  server().publish(Topic::ended, "ended");
  PageClient client = open_stream(server().port(), token());
  EXPECT_THAT(take(client, 7),
              ElementsAre("hello", "event 1", "frame 1", "frame 2", "state 2", "image 1", "ended"));
}

TEST_F(PageServer, SendsNothingBeforeTheToken) {
  PageClient client = connect();
  ASSERT_EQ(client.upgrade().status, 101);
  server().publish(Topic::frame, "frame");
  EXPECT_EQ(client.receive(300ms).kind, Arrival::Kind::silence);
}

TEST_F(PageServer, AClientThatAnswersNoPingIsClosed) {
  PageClient gone = open_stream(server().port(), token());
  ASSERT_TRUE(comes_true([&] { return server().clients() == 1; }));
  EXPECT_TRUE(clock_.advance_until([&] { return server().clients() == 0; }, 1s));
}

TEST_F(PageServer, AClientThatAnswersPingsStays) {
  PageClient client = open_stream(server().port(), token());
  ASSERT_TRUE(comes_true([&] { return server().clients() == 1; }));
  for (int ping = 0; ping < 5; ++ping) {
    clock_.advance(options_.silent_time / 2);
    ASSERT_TRUE(client.answer_ping()) << ping;
  }
  server().publish(Topic::frame, "frame");
  EXPECT_THAT(take(client, 1), ElementsAre("frame"));
}

TEST_F(PageServer, NobodyIsClosedBeforeItWasAsked) {
  PageClient client = open_stream(server().port(), token());
  ASSERT_TRUE(comes_true([&] { return server().clients() == 1; }));
  clock_.advance(1h);  // the program was stopped for so long
  EXPECT_TRUE(client.answer_ping());
  EXPECT_EQ(server().clients(), 1U);
}

TEST_F(PageServer, AClientThatTookAllItWasSentIsNotTakenForStalled) {
  PageClient client = open_stream(server().port(), token());
  ASSERT_TRUE(comes_true([&] { return server().clients() == 1; }));
  server().publish(Topic::frame, "frame");
  EXPECT_THAT(take(client, 1), ElementsAre("frame"));
  EXPECT_EQ(connect().get("/page.css").status, 200);  // by then its thread knows that the frame is written
  clock_.advance(1h);
  EXPECT_TRUE(client.answer_ping());
  EXPECT_EQ(server().clients(), 1U);
}

TEST_F(PageServer, CountsAClientUntilItLeaves) {
  {
    PageClient client = open_stream(server().port(), token());
    EXPECT_TRUE(comes_true([&] { return server().clients() == 1; }));
  }
  EXPECT_TRUE(comes_true([&] { return server().clients() == 0; }));
}

TEST_F(PageServer, SevenClientsGetEveryFrameWhileAnotherIsStalled) {
  constexpr int frames = 10'000;
  options_.queue_bytes = 256 * 1024;
  std::vector<PageClient> clients;
  for (int i = 0; i < 7; ++i) clients.push_back(open_stream(server().port(), token()));
  PageClient stalled = open_stream(server().port(), token(), 4096);
  ASSERT_TRUE(comes_true([&] { return server().clients() == 8; }));

  std::array<std::atomic<int>, 7> seen{};
  std::vector<std::thread> readers;
  for (std::size_t i = 0; i < clients.size(); ++i)
    readers.emplace_back([&client = clients[i], &count = seen[i]] {
      while (count < frames && client.receive().text.starts_with(fmt::format("{:05}", count.load()))) ++count;
    });
  const std::string filling(500, 'x');
  for (int number = 0; number < frames; ++number) {
    server().publish(Topic::frame, fmt::format("{:05} {}", number, filling));
    // As fast as the seven can take it: a hundred messages are less than their queues hold. The eighth takes
    // none.
    const auto take_it = [&] {
      return std::all_of(seen.begin(), seen.end(), [&](int count) { return count > number - 100; });
    };
    if (number % 50 == 0 && !comes_true(take_it)) break;
  }
  for (auto& reader : readers) reader.join();
  for (const int count : seen) EXPECT_EQ(count, frames);

  // The stalled one finds a beginning, gaps that are told, and each frame once or counted.
  server().publish(Topic::ended, "ended");
  int numbers = 0, dropped = 0;
  for (;;) {
    const Arrival arrival = stalled.receive();
    ASSERT_EQ(arrival.kind, Arrival::Kind::text);
    if (arrival.text == "ended") break;
    int more = 0;
    if (std::sscanf(arrival.text.c_str(), R"({"event":"dropped","frames":%d})", &more) == 1)
      dropped += more;
    else
      ++numbers;
  }
  EXPECT_GT(dropped, 0);
  EXPECT_EQ(numbers + dropped, frames);
}

TEST_F(PageServer, AClientThatTakesNothingIsClosed) {
  options_.silent_time = 24h;  // its pings wait behind what it does not take
  PageClient stalled = open_stream(server().port(), token(), 4096);
  ASSERT_TRUE(comes_true([&] { return server().clients() == 1; }));
  const std::string filling(10'000, 'x');
  for (int number = 0; number < 200; ++number) server().publish(Topic::frame, filling);
  EXPECT_TRUE(clock_.advance_until([&] { return server().clients() == 0; }, 250ms));
}

TEST_F(PageServer, PublishingIsBoundedWhileTheServersThreadIsBusy) {
  options_.queue_bytes = 64 * 1024;
  std::mutex busy;
  std::unique_lock hold(busy);
  std::atomic<bool> entered = false;
  Server slow(options_, [&](const Order&) {
    entered = true;
    const std::lock_guard wait(busy);
  });
  PageClient client = open_stream(slow.port(), token_of(slow.url()));
  ASSERT_TRUE(comes_true([&] { return slow.clients() == 1; }));
  std::thread order([&] { PageClient(slow.port()).post("/stop", token_of(slow.url()), "{}"); });
  EXPECT_TRUE(comes_true([&] { return entered.load(); }));
  for (int number = 0; number < 10'000; ++number)
    slow.publish(Topic::frame, fmt::format("frame {:6}", number));
  slow.publish(Topic::ended, "ended");
  hold.unlock();
  order.join();
  int numbers = 0, dropped = 0;
  for (Arrival next = client.receive(); next.text != "ended"; next = client.receive()) {
    ASSERT_EQ(next.kind, Arrival::Kind::text);
    int more = 0;
    if (std::sscanf(next.text.c_str(), R"({"event":"dropped","frames":%d})", &more) == 1)
      dropped += more;
    else
      ++numbers;
  }
  EXPECT_EQ(numbers + dropped, 10'000);
  EXPECT_GT(dropped, 8'000);
}

TEST_F(PageServer, SaysGoodbyeWithItsLastWords) {
  auto last = std::make_unique<Server>(options_, nullptr);
  std::future<void> end;  // goes after the clients, whose going would end it
  std::optional<PageClient> client = open_stream(last->port(), token_of(last->url()));
  PageClient idle(last->port());
  ASSERT_TRUE(comes_true([&] { return last->clients() == 1; }));
  last->publish(Topic::ended, "ended");
  end = std::async(std::launch::async, [&] { last.reset(); });
  EXPECT_THAT(take(*client, 1), ElementsAre("ended"));
  EXPECT_EQ(client->receive().close_code, 1001);
  client.reset();
  EXPECT_EQ(end.wait_for(10s), std::future_status::ready) << "nobody is waited for who is done";
  EXPECT_TRUE(idle.is_closed());
}

TEST_F(PageServer, WaitsForAStalledClientAtItsEndForAFractionOfASecondOnly) {
  auto last = std::make_unique<Server>(options_, nullptr);
  std::future<void> end;  // goes after the client, whose going would end it
  PageClient stalled = open_stream(last->port(), token_of(last->url()), 4096);
  ASSERT_TRUE(comes_true([&] { return last->clients() == 1; }));
  for (int number = 0; number < 50; ++number) last->publish(Topic::frame, std::string(10'000, 'x'));
  end = std::async(std::launch::async, [&] { last.reset(); });
  const auto is_over = [&] { return end.wait_for(1ms) == std::future_status::ready; };
  const auto begin = clock_.now();
  EXPECT_TRUE(clock_.advance_until(is_over, 1ms));
  EXPECT_GE(clock_.now() - begin, 300ms);
  EXPECT_LE(clock_.now() - begin, 3s);  // of a clock that is a third as fast as time, or slower
}

// --- restarts ---------------------------------------------------------------------------------------------

class RestartedServer : public ::testing::Test {
 protected:
  RestartedServer() {
    options_.port = 0;
    options_.state_file = folder_.path() / "state" / "page.json";
  }
  std::unique_ptr<Server> start() const { return std::make_unique<Server>(options_, nullptr); }
  std::string state() const {
    std::ifstream file(options_.state_file);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  PrivateFolder folder_;
  ServerOptions options_;
};

TEST_F(RestartedServer, HasTheSamePortAndAcceptsTheOldToken) {
  const std::string before = start()->url();
  const auto again = start();
  EXPECT_EQ(again->url(), before);
  EXPECT_EQ(PageClient(again->port()).post("/stop", token_of(before), "{}").status, 204);
}

TEST_F(RestartedServer, BindsAtOnceThoughAStreamWasOpen) {
  auto first = start();
  options_.port = first->port();
  PageClient client = open_stream(first->port(), token_of(first->url()));
  ASSERT_TRUE(comes_true([&] { return first->clients() == 1; }));
  first.reset();
  EXPECT_EQ(start()->port(), options_.port);
}

TEST_F(RestartedServer, HasANewTokenIfThatIsAskedFor) {
  const std::string before = start()->url();
  options_.new_token = true;
  const auto again = start();
  EXPECT_EQ(PageClient(again->port()).post("/stop", token_of(before), "{}").status, 401);
  EXPECT_EQ(PageClient(again->port()).post("/stop", token_of(again->url()), "{}").status, 204);
  EXPECT_THAT(state(), HasSubstr(token_of(again->url())));
}

TEST_F(RestartedServer, KeepsItsStateForItsUserAloneWithTheAddressThatOpensThePage) {
  const auto first = start();
  struct stat info {};
  ASSERT_EQ(::stat(options_.state_file.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0600U);
  EXPECT_THAT(state(), HasSubstr("\"url\":\"" + first->url() + "\""));
}

TEST_F(RestartedServer, MakesANewTokenIfTheOldOneCannotBeBelievedAndSaysSo) {
  const std::string url = start()->url();
  const std::filesystem::path file = options_.state_file, other = folder_.path() / "other.json";
  const auto expect_new_token = [&](const std::string& before, const char* why) {
    const auto again = start();
    EXPECT_NE(token_of(again->url()), before) << why;
    EXPECT_THAT(again->note(), HasSubstr(why));
    struct stat info {};
    EXPECT_EQ(::lstat(file.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode, S_IFREG | 0600U);
    return token_of(again->url());
  };
  ::chmod(file.c_str(), 0644);
  std::string token = expect_new_token(token_of(url), "this user alone");
  std::filesystem::rename(file, other);
  std::filesystem::create_symlink(other, file);
  token = expect_new_token(token, "this user alone");
  for (const std::string content : {"", "{", "[]", R"({"port":8650})", R"({"port":0,"token":"short"})"}) {
    std::ofstream(file) << content;
    token = expect_new_token(token, "damaged");
  }
}

TEST_F(RestartedServer, IsRefusedIfItsPortIsInUse) {
  const auto first = start();
  const std::string kept = state();
  options_.port = first->port();
  try {
    start();
    FAIL() << "two servers on one port";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::no_permission);
    EXPECT_THAT(error.what_happened(), HasSubstr("in use"));
    EXPECT_THAT(error.advice(), HasSubstr("--page-port"));
    EXPECT_THAT(error.advice(), HasSubstr("'sport = :" + std::to_string(first->port()) + "'"));
  }
  EXPECT_EQ(state(), kept);
}

TEST_F(RestartedServer, LeavesTheStateOfAnotherThatStillRuns) {
  const auto first = start();
  const std::string kept = state();
  const auto second = start();
  EXPECT_NE(second->port(), first->port());
  EXPECT_NE(token_of(second->url()), token_of(first->url()));
  EXPECT_EQ(first->kept_in(), options_.state_file);
  EXPECT_EQ(second->kept_in(), "") << "what is not there is not where to look for the address";
  EXPECT_THAT(second->note(), HasSubstr("another live view"));
  EXPECT_EQ(state(), kept);
}

/// Without the rights of root, where the test has them.
class AsNobody {
 public:
  explicit AsNobody(const std::filesystem::path& folder) {
    if (::geteuid() != 0) return;
    was_root_ = ::chown(folder.c_str(), nobody, nobody) == 0 && ::seteuid(nobody) == 0;
  }
  ~AsNobody() {
    if (was_root_ && ::seteuid(0) != 0) ADD_FAILURE() << "the test's own rights do not come back";
  }
  AsNobody(const AsNobody&) = delete;
  AsNobody& operator=(const AsNobody&) = delete;

 private:
  static constexpr uid_t nobody = 65'534;
  bool was_root_ = false;
};

TEST_F(RestartedServer, TakesNoPortThatItMayNotOpenForARunningServer) {
  const AsNobody guard(folder_.path());
  std::uint16_t lowest = 0;
  std::ifstream("/proc/sys/net/ipv4/ip_unprivileged_port_start") >> lowest;
  if (lowest <= 1 || ::geteuid() == 0) GTEST_SKIP() << "every port may be opened here";
  const std::string kept(32, 'a');
  std::filesystem::create_directories(options_.state_file.parent_path());
  std::ofstream(options_.state_file) << fmt::format(R"({{"port":1,"token":"{}"}})", kept);
  ASSERT_EQ(::chmod(options_.state_file.c_str(), 0600), 0);
  const auto server = start();
  EXPECT_EQ(token_of(server->url()), kept);
  EXPECT_EQ(server->note(), "");
}

TEST_F(RestartedServer, KeepsNothingWithoutAStateFile) {
  options_.state_file.clear();
  const std::string before = start()->url();
  EXPECT_NE(token_of(start()->url()), token_of(before));
}

TEST(StateFile, LiesInTheUsersStateFolder) {
  ::setenv("XDG_STATE_HOME", "/somewhere/state", 1);
  EXPECT_EQ(default_state_file(), "/somewhere/state/thermorig/page.json");
  ::setenv("XDG_STATE_HOME", "not/absolute", 1);
  ::setenv("HOME", "/home/someone", 1);
  EXPECT_EQ(default_state_file(), "/home/someone/.local/state/thermorig/page.json");
  ::unsetenv("XDG_STATE_HOME");
  ::unsetenv("HOME");
  EXPECT_EQ(default_state_file(), "");
}

}  // namespace thermorig::web
