#include "station/serve/page_guard.h"

#include <openssl/crypto.h>

#include <algorithm>

namespace station {
namespace {

HttpResponse refused(int status, const std::string& line) {
  return {.status = status, .body = line + "\n"};
}

bool same_secret(const std::string& a, const std::string& b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

std::string cookie(const HttpRequest& request, const std::string& name) {
  const std::string cookies = "; " + request.header("cookie");
  const std::size_t at = cookies.find("; " + name + "=");
  if (at == std::string::npos) return {};
  const std::size_t from = at + name.size() + 3;
  return cookies.substr(from, cookies.find(';', from) - from);
}

}  // namespace

std::vector<std::string> loopback_hosts(std::uint16_t port) {
  std::vector<std::string> hosts;
  for (const char* name : {"127.0.0.1", "localhost", "[::1]"}) hosts.push_back(name + (":" + std::to_string(port)));
  return hosts;
}

std::optional<HttpResponse> refusal(const HttpRequest& request, const PageGuard& guard) {
  const std::string host = request.header("host");
  if (std::ranges::find(guard.hosts, host) == guard.hosts.end())
    return refused(403, "this station does not answer to the name \"" + host.substr(0, 80) + "\"; open it as http://" +
                            guard.hosts.front());
  if (request.method != "GET" && request.method != "HEAD" && request.method != "POST")
    return refused(405, "only GET and POST are answered");
  const std::string origin = request.header("origin"), site = request.header("sec-fetch-site");
  if (!origin.empty() && origin != "http://" + host) return refused(403, "another page may not ask this one");
  if (!site.empty() && site != "same-origin" && site != "none")
    return refused(403, "another page may not ask this one");
  if (!guard.token.empty()) {
    if (request.method == "GET" && request.path == "/" && request.query.contains("token") &&
        same_secret(request.query.at("token"), guard.token))
      return HttpResponse{.status = 303,
                          .headers = {{"Location", "/"},
                                      {"Set-Cookie", std::string(kTokenCookie) + "=" + guard.token +
                                                         "; HttpOnly; SameSite=Strict; Path=/"}}};
    const std::string bearer = request.header("authorization");
    if (!same_secret(cookie(request, kTokenCookie), guard.token) && !same_secret(bearer, "Bearer " + guard.token))
      return refused(401, "the token is missing or wrong; open the address that `threadstation serve` printed");
  }
  if (request.method == "POST") {
    if (!request.headers.contains(kPageHeader)) return refused(403, "only the station's own page may ask for this");
    if (!request.header("content-type").starts_with("application/json"))
      return refused(415, "expected application/json");
  }
  return std::nullopt;
}

}  // namespace station
