// A request and its answer, as the server's parts pass them on.
#pragma once

#include <map>
#include <string>

namespace station {

struct HttpRequest {
  std::string method;                          // upper case
  std::string path;                            // decoded, without the query; begins with '/'
  std::map<std::string, std::string> query;    // decoded
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;

  std::string header(const std::string& name) const {
    const auto found = headers.find(name);
    return found == headers.end() ? std::string() : found->second;
  }
};

struct HttpResponse {
  int status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string body;
  std::map<std::string, std::string> headers{};
  bool stream = false;  // an event stream (text/event-stream) that stays open: HttpServer::publish
};

}  // namespace station
