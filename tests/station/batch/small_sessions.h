// Small captured sessions of an earlier day, developed and fitted in a second, and what a batch makes of them.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace station_test {

// Copies of one session of fixtures/formats in FOLDER/sessions, s00, s01 ... `developed`: so far, and without its raw
// pictures.
void make_sessions(const std::filesystem::path& folder, int count, bool developed = false);

// Writes a plan over these sessions, FOLDER/plan.json, and returns its name.
std::string written_plan(const std::filesystem::path& folder, const nlohmann::json& steps,
                         const nlohmann::json& more = nlohmann::json::object());

// The hashes of all that a batch in FOLDER/batch has made, by name from FOLDER: results of its own and of the sessions.
std::map<std::string, std::string> made_in(const std::filesystem::path& folder);

// The record of a task of the batch in FOLDER/batch; null when there is none.
nlohmann::json record_in(const std::filesystem::path& folder, const std::string& step, const std::string& item);

}  // namespace station_test
