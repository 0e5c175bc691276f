// The versions of threadstation's documents: one table, in which each kind has the steps by which files of earlier days
// are read.
//
// A version goes up when a document of the version before can no longer be read as it is. The step from it then stands
// here for ever, with files of that day in fixtures/formats/, which a test reads. A key that may be left out, and
// means what it always meant when it is, needs no new version.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace station {

// All kinds of documents.
std::vector<std::string> document_kinds();

// The version that this program writes. Errors: std::out_of_range for a kind that is not in the table.
int current_version(const std::string& kind);

// A document of this kind and version, 1 or later, as the current version has it.
nlohmann::json migrated(nlohmann::json document, const std::string& kind, int version);

// The document with all documents inside it, such as the rig in a session's, in their current versions; equal to
// `document` when they are. Of kinds that are not in the table, and of what is no document, nothing is changed.
// Errors: std::runtime_error, one line, for a version that is later than the current one.
nlohmann::json up_to_date(const nlohmann::json& document, const std::string& source);

// "made by a later threadstation ..."
std::string later_version_problem(const std::string& source, const std::string& kind, int version);

}  // namespace station
