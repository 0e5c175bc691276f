// A small HTTP/1.1 server with limits that no client can lift: what comes from the network never holds a run up.
//
//   one thread reads and writes all connections, so that the number of sockets costs no threads
//   `urgent` answers in that thread, whatever else is under way: refusals and the emergency stop
//   `handle` answers in two others; when too many of its requests wait, more are refused (503)
//   a request has a time to arrive in (slow and half-open sockets are closed), and sizes
//   when there are too many connections, the one that has waited longest without a request goes
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "station/serve/http_message.h"

namespace station {

struct HttpLimits {
  std::uint32_t header_bytes = 16 << 10;
  std::uint64_t body_bytes = 256 << 10;
  // From the connection, or the answer before, to the request's last byte.
  std::chrono::milliseconds request_time{10'000};
  std::size_t connections = 256, streams = 32, waiting_requests = 64;
  double requests_per_s = 200;           // of all clients together, on average; more are refused (429)
  std::size_t stream_bytes = 256 << 10;  // that a watcher may lag behind before it is dropped
  // The clock by which requests per second are counted.
  std::function<std::chrono::steady_clock::time_point()> now = std::chrono::steady_clock::now;
};

class HttpServer {
 public:
  using Urgent = std::function<std::optional<HttpResponse>(const HttpRequest&)>;  // nothing: `handle` answers
  using Handle = std::function<HttpResponse(const HttpRequest&)>;  // what it throws becomes a 500 with the message

  // Listens from now on; port 0: a free one. Errors: std::runtime_error with one line for an address or port that
  // cannot be had.
  HttpServer(const std::string& address, std::uint16_t port, Urgent urgent, Handle handle,
             const HttpLimits& limits = {});
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  std::uint16_t port() const;
  void run();   // until stop()
  void stop();  // from any thread
  // One event for everybody who has a stream open, from any thread. `data` is one line.
  void publish(const std::string& data);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace station
