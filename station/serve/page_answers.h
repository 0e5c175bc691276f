// Answers of the technician's page as JSON, and what it reads out of a request.
#pragma once

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "station/serve/http_message.h"

namespace station {

inline constexpr std::size_t kLongestText = 200;  // that the page may send; UTF-8

// A request that is not served, with the status and the one line that it is answered with.
class Refused : public std::runtime_error {
 public:
  Refused(int status, const std::string& line) : std::runtime_error(line), status_(status) {}
  int status() const { return status_; }

 private:
  int status_;
};

HttpResponse answered(const nlohmann::json& document);   // 200
HttpResponse said(int status, const std::string& line);  // {"message": line}
// The text under `key`; empty without one, or when it is no text.
std::string text_of(const nlohmann::json& asked, const char* key);
// The name under `key`, which may become a part of a path. Throws Refused (400) for any other.
std::string name_of(const nlohmann::json& asked, const char* key);
// Returns `name`. Throws Refused (400) when it may not become a part of a path.
const std::string& checked_name(const std::string& name);

}  // namespace station
