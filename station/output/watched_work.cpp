#include "station/output/watched_work.h"

#include "station/documents/number_text.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

// True now and then: after a second, then every five.
class NowAndThen {
 public:
  explicit NowAndThen(const ProgressDisplay& progress) : progress_(progress), next_s_(progress.seconds() + 1) {}
  bool operator()() {
    const double now_s = progress_.seconds();
    if (now_s < next_s_) return false;
    next_s_ = now_s + 5;
    return true;
  }

 private:
  const ProgressDisplay& progress_;
  double next_s_;
};

}  // namespace

renderer::RelaxedPatch weave_watched(const renderer::Draft& draft, ProgressDisplay& progress) {
  NowAndThen now_and_then(progress);
  int looks = 0;
  renderer::RelaxationOptions options;
  options.progress = [&](const renderer::RelaxationReport& so_far) {
    ++looks;
    if (now_and_then())
      progress.show(0, 0,
                    formatted("yarns of %s come to rest: step %d, they overlap by %.2g %% of a radius",
                              draft.name.c_str(), looks, 100 * so_far.overlap));
    return !interrupted();
  };
  return renderer::woven_patch(draft, options);
}

renderer::UvMesh garment_watched(const renderer::GarmentShape& shape, ProgressDisplay& progress) {
  NowAndThen now_and_then(progress);
  return renderer::garment_mesh(shape, [&](double finished) {
    if (now_and_then()) progress.show(static_cast<int>(100 * finished), 100, "% of the garment is hung");
    return !interrupted();
  });
}

}  // namespace station
