#include "station/serve/design_look.h"

#include <utility>

#include "station/cloth/preview/cloth_look.h"
#include "station/cloth/preview/cloth_stage.h"
#include "station/documents/disk/whole_file.h"
#include "station/serve/job_command.h"
#include "station/serve/page_answers.h"

namespace station {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

}  // namespace

DesignLook::DesignLook(const Workspace& workspace, fs::path program)
    : workspace_(workspace), program_(std::move(program)) {}

DesignLook::~DesignLook() {
  end();
}

fs::path DesignLook::folder() const {
  return workspace_.folder() / "look" / std::to_string(processes_);
}

int DesignLook::show(const json& asked) {
  const ClothView view = cloth_view_of(asked);
  if (const auto problem = problem_of(view)) throw Refused(400, *problem);
  const std::vector<std::string> cloth = design_words(asked, workspace_);
  const std::scoped_lock lock(mutex_);
  const bool same = job_ && job_->running() && cloth == cloth_;
  if (!same) {
    end_running();
    std::error_code ignored;
    fs::remove_all(workspace_.folder() / "look", ignored);
    ++processes_;
    fs::create_directories(folder());
    std::vector<std::string> words = cloth;
    words.insert(words.begin(), "look");
    words.insert(words.end(), {"--out", folder().string()});
    job_ = std::make_unique<Job>(
        JobRequest{.title = "look", .steps = {{"look", words}}, .said = folder() / "said", .program = program_}, [] {});
    cloth_ = cloth;
  }
  json line = to_json(view);
  line["look"] = ++looks_;
  if (!job_->tell(line)) throw Refused(409, "the look at the cloth does not answer; choose it again");
  return looks_;
}

void DesignLook::end() {
  const std::scoped_lock lock(mutex_);
  end_running();
}

// A process that has not ended yet is waited for by the next call, or by the system.
void DesignLook::end_running() {
  std::erase_if(ending_, [](const std::unique_ptr<Job>& one) { return !one->running(); });
  if (!job_) return;
  job_->stop_now();
  ending_.push_back(std::move(job_));
  cloth_.clear();
}

json DesignLook::state() const {
  const std::scoped_lock lock(mutex_);
  json document{{"running", job_ && job_->running()},
                {"look", looks_},
                {"shown", nullptr},
                {"of", processes_},
                {"problem", nullptr},
                {"label", ""}};
  if (!job_) return document;
  const json state = job_->state();
  document["shown"] = job_->shown();
  document["label"] = state["label"];
  if (state["outcome"] == "badly") document["problem"] = state["lines"].empty() ? json("") : state["lines"].back();
  return document;
}

HttpResponse DesignLook::picture() const {
  const std::scoped_lock lock(mutex_);
  const fs::path file = folder() / kLookPicture;
  if (!job_ || !fs::is_regular_file(file)) throw Refused(404, "there is no look at cloth");
  return {.content_type = "image/png", .body = text_of_file(file)};
}

}  // namespace station
