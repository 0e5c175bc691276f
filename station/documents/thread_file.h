// A thread file (kind "thread", thread.json): a digitized thread, its scattering parameters and where they come from;
// keys in station/data/threads/README.md.
//
// Errors: those of reader.h; also refused is a lambda that is negative at some angle.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "renderer/scattering/thread.h"
#include "station/documents/digitized_thread.h"

namespace station {

using ThreadFile = DigitizedThread<renderer::ThreadParameters>;

// The rules by which light leaves a thread, by the names that files give them.
const std::map<std::string, renderer::ThreadExit>& thread_exits();

ThreadFile parse_thread(const nlohmann::json& document, const std::string& source);
ThreadFile read_thread(const std::filesystem::path& file);
nlohmann::json to_json(const ThreadFile& thread);

}  // namespace station
