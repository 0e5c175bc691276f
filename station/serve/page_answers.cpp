#include "station/serve/page_answers.h"

#include "station/documents/disk/file_name.h"

namespace station {
namespace {

using nlohmann::json;

// What a command said, or a client asked for, may be any bytes.
std::string written(const json& document) {
  return document.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace

HttpResponse said(int status, const std::string& line) {
  return {.status = status, .content_type = "application/json", .body = written({{"message", line}})};
}

HttpResponse answered(const json& document) {
  return {.content_type = "application/json", .body = written(document)};
}

std::string text_of(const json& asked, const char* key) {
  const auto found = asked.find(key);
  return found != asked.end() && found->is_string() ? found->get<std::string>() : std::string();
}

const std::string& checked_name(const std::string& name) {
  if (const auto problem = problem_with_name(name)) throw Refused(400, *problem);
  return name;
}

std::string name_of(const json& asked, const char* key) {
  return checked_name(text_of(asked, key));
}

}  // namespace station
