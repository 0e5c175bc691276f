#include "station/serve/serve.h"

#include <iostream>
#include <memory>
#include <stdexcept>

#include "station/output/interrupt.h"
#include "station/serve/http_server.h"
#include "station/serve/page_guard.h"
#include "station/serve/technician_page.h"

namespace station {
namespace {

constexpr std::size_t kShortestToken = 16;

void check(const ServeRequest& request) {
  if (request.lan && request.token.empty())
    throw std::runtime_error(
        "--lan opens the station to everybody in the network, who could then move it; give a --token too");
  if (request.lan && request.hosts.empty())
    throw std::runtime_error("--lan needs the name or address under which this computer is asked; give it with --host");
  if (!request.token.empty() &&
      (request.token.size() < kShortestToken ||
       request.token.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_") !=
           std::string::npos))
    throw std::runtime_error("--token: expected at least 16 letters, digits, - and _; try `openssl rand -hex 16`");
}

}  // namespace

void serve(const ServeRequest& request) {
  check(request);
  watch_interrupts();
  std::unique_ptr<HttpServer> server;
  TechnicianPage page(request.rig, request.workspace, [&] { server->publish("changed"); });
  PageGuard guard{.hosts = {}, .token = request.token};
  server = std::make_unique<HttpServer>(
      request.lan ? "0.0.0.0" : "127.0.0.1", request.port,
      [&](const HttpRequest& asked) -> std::optional<HttpResponse> {
        if (auto refused = refusal(asked, guard)) return refused;
        return page.urgent(asked);
      },
      [&](const HttpRequest& asked) { return page.handle(asked); });
  guard.hosts = loopback_hosts(server->port());
  for (const std::string& host : request.hosts) guard.hosts.push_back(host + ":" + std::to_string(server->port()));
  const std::string host = request.lan ? guard.hosts.back() : guard.hosts.front();
  std::cout << "http://" << host << "/" << (request.token.empty() ? "" : "?token=" + request.token) << std::endl;
  const StopOnInterrupt on_interrupt([&] { server->stop(); });
  server->run();
}

}  // namespace station
