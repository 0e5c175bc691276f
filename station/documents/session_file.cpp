#include "station/documents/session_file.h"

#include "station/documents/plan_file.h"
#include "station/documents/reader.h"

namespace station {

namespace {

constexpr const char* kMeasuredElsewhere = "none: views that were measured elsewhere";

nlohmann::json document_of(const std::string& utc, const nlohmann::json& spool, const Plan& plan,
                           const std::string& person) {
  nlohmann::json document = {{"format", "threadstation/session"}, {"version", 1},   {"utc", utc},
                             {"software", software_version()},    {"spool", spool}, {"plan", plan_to_json(plan)}};
  if (!person.empty()) document["operator"] = person;
  return document;
}

}  // namespace

nlohmann::json make_measured_document(const std::string& utc, const nlohmann::json& spool, const Plan& plan,
                                      const DevelopedViews& measured, const std::string& person) {
  nlohmann::json document = document_of(utc, spool, plan, person);
  document["measured"] = to_json(measured);
  return document;
}

void require_captured(const SessionFile& session, const std::filesystem::path& folder, const std::string& so) {
  if (session.measured) throw std::runtime_error(folder.string() + " has views that were measured elsewhere; " + so);
}

nlohmann::json make_session_document(const std::string& utc, const nlohmann::json& rig, const nlohmann::json& spool,
                                     const Plan& plan, const std::string& person, const std::optional<Sample>& sample) {
  nlohmann::json document = document_of(utc, spool, plan, person);
  document["rig"] = rig;
  if (sample) document["sample"] = to_json(*sample);
  return document;
}

SessionFile read_session_file(const std::filesystem::path& session) {
  const std::filesystem::path file = session / "session.json";
  if (!std::filesystem::exists(file))
    throw std::runtime_error(session.string() +
                             " is not a session folder (no session.json); give the folder that capture made");
  const nlohmann::json document = read_json_file(file);
  ObjectReader reader(document, file.string(), "session");
  SessionFile result;
  result.utc = reader.text("utc");
  result.software = reader.text("software");
  if (reader.has("operator")) result.person = reader.text("operator");
  if (reader.has("sample")) {
    ObjectReader sample = reader.object("sample");
    result.sample = read_sample(sample);
  }
  if (reader.has("measured")) {
    result.measured = parse_views(reader.raw("measured"), file.string() + " (measured)");
    result.rig.name = kMeasuredElsewhere;
  } else {
    result.rig = parse_rig(reader.raw("rig"), file.string() + " (rig)");
  }
  result.spool = parse_spool(reader.raw("spool"), file.string() + " (spool)");
  result.plan = plan_from_json(reader.raw("plan"), file.string() + " (plan)");
  reader.finish();
  return result;
}

std::string software_version() {
  return std::string("threadstation ") + THREADSTATION_VERSION;
}

}  // namespace station
