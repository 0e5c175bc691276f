#include "station/serve/thread_pictures.h"

#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "station/serve/job_command.h"
#include "station/session/record/session_folder.h"

namespace station {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char *kDraft = "twill_2_2", *kShape = "swatch";
constexpr int kSize_px = 320;

}  // namespace

ThreadPictures::ThreadPictures(const Workspace& workspace, std::function<void()> changed, fs::path program)
    : workspace_(workspace), changed_(std::move(changed)), program_(std::move(program)) {}

ThreadPictures::~ThreadPictures() {
  constexpr auto kPause = std::chrono::milliseconds(20);
  constexpr int kMostPauses = 100;
  if (job_) job_->stop_now();
  for (int i = 0; i < kMostPauses && job_ && job_->running(); ++i) std::this_thread::sleep_for(kPause);
}

void ThreadPictures::mark(json& thread_lines, bool may_make) {
  const std::scoped_lock lock(mutex_);
  if (job_ && !job_->running()) keep_made();
  if (job_ && !may_make && !given_up_) {
    job_->stop_now();
    given_up_ = true;
  }
  for (json& line : thread_lines) {
    const std::string sha256 = line.at("sha256");
    line["pictured"] = is_session(workspace_.session(line.at("session").get<std::string>())) ||
                       fs::exists(workspace_.thread_picture(sha256));
    if (line["pictured"] == false && may_make && !job_ && !in_vain_.contains(sha256))
      make(line.at("number").get<int>(), sha256);
  }
}

fs::path ThreadPictures::cloth() const {
  return workspace_.thread_picture(making_).replace_extension();
}

void ThreadPictures::make(int number, const std::string& sha256) {
  making_ = sha256;
  given_up_ = false;
  fs::create_directories(cloth().parent_path());
  // Whoever follows the station hears of the picture when it is there.
  const std::vector<std::string> arguments{"cloth",   workspace_.thread_in_library(number).string(),
                                           "--out",   cloth().string(),
                                           "--draft", ready_draft(kDraft).string(),
                                           "--shape", kShape,
                                           "--size",  std::to_string(kSize_px),
                                           "--quick"};
  job_ = std::make_unique<Job>(
      JobRequest{
          .title = "picture", .steps = {{"cloth", arguments}}, .said = cloth(), .watched = false, .program = program_},
      changed_);
}

// The picture alone; what was given up is gone on with some other time.
void ThreadPictures::keep_made() {
  job_.reset();
  if (given_up_) return;
  std::error_code error;
  fs::rename(cloth() / (std::string(kShape) + ".png"), workspace_.thread_picture(making_), error);
  if (error) in_vain_.insert(making_);
  fs::remove_all(cloth(), error);
  for (const char* ending : {".out", ".progress"}) fs::remove(cloth() += ending, error);
}

}  // namespace station
