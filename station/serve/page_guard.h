// Which requests the technician's page may answer at all: those of the browser of whoever sits at the bench, and of no
// page in it but ours.
//
//   Host        one of ours: a page of another name that points at this machine (DNS rebinding) is refused
//   Origin      that Host, when there is one; the same is asked of Sec-Fetch-Site
//   POST        JSON, and with a header that only our own page's script sets: no form of another page can
//   token       when there is one: as a cookie that our page got at ?token=..., or as a bearer
// No answer ever allows another origin to read it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "station/serve/http_message.h"

namespace station {

inline constexpr const char* kPageHeader = "x-threadstation";  // any value
inline constexpr const char* kTokenCookie = "threadstation_token";

struct PageGuard {
  std::vector<std::string> hosts;  // as in Host, with the port
  std::string token;               // empty: none is asked for
};

// The hosts of a loopback address.
std::vector<std::string> loopback_hosts(std::uint16_t port);

// The answer to a request that may not pass; to one that brings the token in its address, the redirect that keeps it.
std::optional<HttpResponse> refusal(const HttpRequest& request, const PageGuard& guard);

}  // namespace station
