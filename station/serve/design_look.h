// The cloth that somebody designs at the page, as `look` shows it (cloth/preview/cloth_look.h): a process beside the
// jobs, which needs nothing of the bench, so that an emergency stop leaves it alone.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "station/serve/http_message.h"
#include "station/serve/job.h"
#include "station/serve/workspace.h"

namespace station {

class DesignLook {
 public:
  // `workspace` must outlive it.
  DesignLook(const Workspace& workspace, std::filesystem::path program);
  ~DesignLook();  // ends it
  DesignLook(const DesignLook&) = delete;
  DesignLook& operator=(const DesignLook&) = delete;

  // Shows what is asked for: {"number", "weft" (threads: numbers in the library, or names of ready ones), "draft",
  // "shape", and of the view what cloth_stage.h has}, and returns the look's number. Other threads, drafts and shapes
  // begin another process. Throws Refused for what may not be asked.
  int show(const nlohmann::json& asked);
  void end();

  // {"running", "look" (the number of the last one that was asked for), "shown" (cloth_look.h; null before the first
  // picture), "of": what is shown is another picture when this is, "problem": the line with which it ended badly,
  // "label": what it does before there is a picture}
  nlohmann::json state() const;
  // The picture shown. Throws Refused (404) before there is one.
  HttpResponse picture() const;

 private:
  void end_running();
  std::filesystem::path folder() const;  // of the present process

  const Workspace& workspace_;
  const std::filesystem::path program_;
  mutable std::mutex mutex_;
  std::unique_ptr<Job> job_;
  std::vector<std::unique_ptr<Job>> ending_;  // that were told to
  std::vector<std::string> cloth_;            // what the present process was begun with
  int processes_ = 0, looks_ = 0;
};

}  // namespace station
