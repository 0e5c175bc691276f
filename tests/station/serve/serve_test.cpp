// The technician's page: what it refuses, what it survives, and that a run is none of the network's business.
#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <thread>

#include "station/serve/http_server.h"
#include "station/serve/page_guard.h"
#include "tests/places.h"
#include "tests/station/commands/program.h"

namespace station_test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using namespace std::chrono_literals;
using asio::ip::tcp;
using station::HttpRequest;
using station::HttpResponse;
using station::HttpServer;
using station::PageGuard;

// ---- who is answered

HttpRequest asked(const std::string& method = "GET") {
  HttpRequest request{.method = method, .path = "/api/state", .headers = {{"host", "127.0.0.1:8017"}}};
  if (method == "POST") request.headers.insert({{"content-type", "application/json"}, {station::kPageHeader, "page"}});
  return request;
}

int status_of(const HttpRequest& request, const PageGuard& guard = {station::loopback_hosts(8017), ""}) {
  const auto refused = station::refusal(request, guard);
  return refused ? refused->status : 200;
}

HttpRequest with(HttpRequest request, const std::string& name, const std::string& value) {
  request.headers[name] = value;
  return request;
}

TEST(PageGuard, TheStationsOwnPageIsAnswered) {
  EXPECT_EQ(status_of(asked()), 200);
  EXPECT_EQ(status_of(asked("POST")), 200);
  EXPECT_EQ(status_of(with(asked("POST"), "origin", "http://127.0.0.1:8017")), 200);
  EXPECT_EQ(status_of(with(with(asked(), "host", "localhost:8017"), "sec-fetch-site", "none")), 200);
}

TEST(PageGuard, OtherNamesForThisMachineAreRefused) {
  for (const char* host : {"attacker.example:8017", "127.0.0.1:80", "127.0.0.1", "", "127.0.0.1:8017.attacker.example"})
    EXPECT_EQ(status_of(with(asked(), "host", host)), 403) << host;
  HttpRequest none = asked();
  none.headers.erase("host");
  EXPECT_EQ(status_of(none), 403);
}

TEST(PageGuard, OtherPagesMayNotAsk) {
  for (const char* origin : {"http://attacker.example", "null", "http://localhost:8017", "https://127.0.0.1:8017"})
    EXPECT_EQ(status_of(with(asked("POST"), "origin", origin)), 403) << origin;
  for (const char* site : {"cross-site", "same-site"})
    EXPECT_EQ(status_of(with(asked(), "sec-fetch-site", site)), 403) << site;
  HttpRequest form = asked("POST");
  form.headers.erase(station::kPageHeader);
  EXPECT_EQ(status_of(form), 403);
  EXPECT_EQ(status_of(with(asked("POST"), "content-type", "text/plain")), 415);
  for (const char* method : {"OPTIONS", "PUT", "DELETE", "TRACE"}) EXPECT_EQ(status_of(asked(method)), 405) << method;
}

TEST(PageGuard, WithATokenNobodyElseIsAnswered) {
  const PageGuard guard{station::loopback_hosts(8017), "0123456789abcdef"};
  EXPECT_EQ(status_of(asked(), guard), 401);
  EXPECT_EQ(status_of(with(asked(), "cookie", "threadstation_token=0123456789abcdeX"), guard), 401);
  EXPECT_EQ(status_of(with(asked(), "cookie", "threadstation_token=0123456789abcde"), guard), 401);
  EXPECT_EQ(status_of(with(asked(), "cookie", "xthreadstation_token=0123456789abcdef"), guard), 401);
  EXPECT_EQ(status_of(with(asked(), "cookie", "a=b; threadstation_token=0123456789abcdef"), guard), 200);
  EXPECT_EQ(status_of(with(asked(), "authorization", "Bearer 0123456789abcdef"), guard), 200);
  HttpRequest first = asked();
  first.path = "/";
  first.query["token"] = "0123456789abcdef";
  const auto kept = station::refusal(first, guard);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->status, 303);
  EXPECT_NE(kept->headers.at("Set-Cookie").find("HttpOnly; SameSite=Strict"), std::string::npos);
  first.query["token"] = "wrong";
  EXPECT_EQ(status_of(first, guard), 401);
}

// ---- what the server survives

class RunningServer {
 public:
  explicit RunningServer(station::HttpLimits limits = {}, HttpServer::Handle handle = {})
      : server_("127.0.0.1", 0, [](const HttpRequest& request) -> std::optional<HttpResponse> {
          if (request.path == "/stop") return HttpResponse{.body = "stopped"};
          return std::nullopt;
        },
        handle ? handle : [](const HttpRequest& request) {
          if (request.path == "/events") return HttpResponse{.stream = true};
          return HttpResponse{.body = request.path + request.body};
        }, limits),
        thread_([this] { server_.run(); }) {}
  ~RunningServer() { server_.stop(); }

  HttpServer& operator*() { return server_; }
  HttpServer* operator->() { return &server_; }

  tcp::socket connected() {
    tcp::socket socket(io_);
    socket.connect({asio::ip::address_v4::loopback(), server_.port()});
    return socket;
  }

  // Status and body; 0 when the connection ends without an answer.
  std::pair<int, std::string> send(const std::string& text) {
    tcp::socket socket = connected();
    boost::system::error_code error;
    asio::write(socket, asio::buffer(text), error);
    beast::flat_buffer buffer;
    http::response<http::string_body> answer;
    http::read(socket, buffer, answer, error);
    if (error) return {0, error.message()};
    return {answer.result_int(), answer.body()};
  }

  std::pair<int, std::string> get(const std::string& path) {
    return send("GET " + path + " HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  }

 private:
  asio::io_context io_;
  HttpServer server_;
  std::jthread thread_;
};

TEST(HttpServer, AnswersDecodedAddressesAndBodies) {
  RunningServer server;
  EXPECT_EQ(server.get("/a%20b"), std::pair(200, std::string("/a b")));
  EXPECT_EQ(server.send("POST /x HTTP/1.1\r\nHost: x\r\nContent-Length: 3\r\n\r\nabc"),
            std::pair(200, std::string("/xabc")));
}

TEST(HttpServer, RubbishAndWhatIsTooLargeIsRefused) {
  RunningServer server;
  EXPECT_EQ(server.send("\x16\x03\x01 hello\r\n\r\n").first, 400);
  EXPECT_EQ(server.send("GET /%zz HTTP/1.1\r\n\r\n").first, 400);
  EXPECT_EQ(server.send("GET /%00 HTTP/1.1\r\n\r\n").first, 400);
  EXPECT_EQ(server.send("GET nowhere HTTP/1.1\r\n\r\n").first, 400);
  EXPECT_EQ(server.send("GET / HTTP/1.1\r\nA: " + std::string(100'000, 'a')).first, 431);
  EXPECT_EQ(server.send("POST / HTTP/1.1\r\nContent-Length: 99999999\r\n\r\n").first, 413);
  EXPECT_EQ(server.get("/still").first, 200);
}

TEST(HttpServer, ARequestThatDoesNotComeInTimeIsDropped) {
  RunningServer server({.request_time = 200ms});
  tcp::socket slow = server.connected();
  std::thread drip([&] {
    boost::system::error_code error;
    while (!error) {
      asio::write(slow, asio::buffer(std::string("G")), error);
      std::this_thread::sleep_for(20ms);
    }
  });
  char byte = 0;
  boost::system::error_code error;
  slow.read_some(asio::buffer(&byte, 1), error);
  EXPECT_TRUE(error);
  drip.join();
}

TEST(HttpServer, AThousandHalfOpenConnectionsDoNotKeepAnybodyOut) {
  RunningServer server({.connections = 64});
  std::vector<tcp::socket> sockets;
  for (int i = 0; i < 1000; ++i) {
    sockets.push_back(server.connected());
    boost::system::error_code error;
    asio::write(sockets.back(), asio::buffer(std::string("GET / HTTP/1.1\r\nHo")), error);
    if (i % 100 == 0) EXPECT_EQ(server.get("/in").first, 200) << i;
  }
  EXPECT_EQ(server.get("/after").first, 200);
}

TEST(HttpServer, TheEmergencyStopPassesWhileEverythingElseHangs) {
  std::atomic<bool> go_on = false;
  RunningServer server({.waiting_requests = 4}, [&](const HttpRequest&) {
    while (!go_on) std::this_thread::sleep_for(1ms);
    return HttpResponse{};
  });
  std::vector<tcp::socket> waiting;
  for (int i = 0; i < 4; ++i) {
    waiting.push_back(server.connected());
    asio::write(waiting.back(), asio::buffer(std::string("GET /slow HTTP/1.1\r\nHost: x\r\n\r\n")));
  }
  int refused = 0;
  for (int i = 0; i < 200 && refused != 503; ++i) {  // until all four wait
    if (i > 0) std::this_thread::sleep_for(5ms);
    tcp::socket one = server.connected();
    asio::write(one, asio::buffer(std::string("GET /slow HTTP/1.1\r\nHost: x\r\n\r\n")));
    std::this_thread::sleep_for(20ms);
    if (one.available() == 0) continue;
    std::string answer(64, '\0');
    answer.resize(one.read_some(asio::buffer(answer)));
    refused = answer.find(" 503 ") != std::string::npos ? 503 : -1;
  }
  EXPECT_EQ(refused, 503);
  EXPECT_EQ(server.get("/stop"), std::pair(200, std::string("stopped")));
  go_on = true;
}

TEST(HttpServer, TooManyRequestsAreRefusedForAWhile) {
  std::atomic<std::chrono::steady_clock::duration> now{};
  RunningServer server({.requests_per_s = 5, .now = [&] { return std::chrono::steady_clock::time_point(now.load()); }});
  int answered = 0;
  for (int i = 0; i < 40; ++i) answered += server.get("/").first == 200;
  EXPECT_GE(answered, 5);
  EXPECT_LT(answered, 40) << "no time has gone by";
  EXPECT_EQ(server.get("/").first, 429);
  EXPECT_EQ(server.get("/stop").first, 200);
  now = 500ms;
  EXPECT_EQ(server.get("/").first, 200);
}

TEST(HttpServer, WatchersHearOfEachChangeAndMayGo) {
  RunningServer server({.streams = 2});
  const auto watch = [&] {
    tcp::socket socket = server.connected();
    asio::write(socket, asio::buffer(std::string("GET /events HTTP/1.1\r\nHost: x\r\n\r\n")));
    std::string text;
    asio::read_until(socket, asio::dynamic_buffer(text), ": here\n\n");
    EXPECT_NE(text.find("text/event-stream"), std::string::npos);
    return socket;
  };
  tcp::socket first = watch();
  {
    tcp::socket second = watch();
    EXPECT_EQ(server.get("/events").first, 503);
  }
  for (int i = 0; i < 100; ++i) server->publish("changed");
  std::string heard;
  asio::read_until(first, asio::dynamic_buffer(heard), "data: changed\n\n");
}

TEST(Serve, WhatOpensTheStationToOthersNeedsATokenAndAName) {
  const TemporaryFolder folder;
  const std::string rig = std::string(DATA_DIR) + "/rigs/simulated.json";
  const auto refused = [&](std::vector<std::string> more, const std::string& named) {
    std::vector<std::string> words{"serve", "--rig", rig, "--workspace", folder / "bench", "--port", "0"};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramResult result = run_threadstation(words);
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.error_lines(), 1) << result.error;
    EXPECT_NE(result.error.find(named), std::string::npos) << result.error;
  };
  refused({"--lan"}, "--token");
  refused({"--lan", "--token", "0123456789abcdef"}, "--host");
  refused({"--token", "short"}, "16");
}

}  // namespace
}  // namespace station_test
