// What the page may have the program do: the command line of a job that a browser asked for.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "station/serve/job.h"
#include "station/serve/workspace.h"

namespace station {

// The commands of a job. Its kinds, and what each needs beside "name" (of a calibration, session, queue or export):
//   check (calibration, may be empty), preview, home    no name
//   calibrate, rig
//   capture (calibration, spool, person), resume, reshoot (view), queue (calibration, person)
//   develop, invert (quick), report, cloth (draft, warp_colour, weft_colour, quick), add
//   digitize: capture, and then develop, invert, report and add; process: those of them that a session still lacks
//   export (number, format), design_export (design): the cloth of a design as glTF and textures
//   design (number, weft, draft, shape, size_px and the view of cloth_stage.h)
struct JobCommand {
  std::string title;  // for people
  std::vector<JobStep> steps;
};

// Every name is whitelisted before it becomes a part of a path, and no argument is anything but a name, a number or a
// text behind its option's "=". The name of what is new may be any text; its file is called by safe_name(). Throws
// Refused for what may not be asked.
JobCommand job_command(const nlohmann::json& asked, const Workspace& workspace, const std::filesystem::path& rig);

// The arguments that say which cloth a design is, for `cloth` and `look`: threads, draft and, where it is asked for,
// shape. Each thread is a number of the library's or the name of a ready one. Throws Refused likewise.
std::vector<std::string> design_words(const nlohmann::json& asked, const Workspace& workspace);

// The forms in which a thread of the library may be exported.
std::vector<std::string> export_formats();

// Ready weave drafts that `cloth` may be asked for, by name.
std::filesystem::path ready_draft(const std::string& name);
std::vector<std::string> ready_drafts();

// Threads that come with the program, by name: digitized on the simulated bench.
std::filesystem::path ready_thread(const std::string& name);
std::vector<std::string> ready_threads();

}  // namespace station
