#define OMPI_SKIP_MPICXX 1  // the functions of C alone
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

#include "station/cloth/render/ranks.h"
#include "station/cloth/render/started_ranks.h"
#include "station/documents/disk/sha256.h"
#include "station/output/interrupt.h"

namespace station {
namespace {

using renderer::Film;
using renderer::PassEnd;
using renderer::TileRecord;

constexpr auto kBetweenTests = std::chrono::milliseconds(2), kBetweenQuestions = std::chrono::milliseconds(50),
               kBetweenTold = std::chrono::milliseconds(500);
using Clock = std::chrono::steady_clock;

// Waits for a request without keeping a core busy. False when go_on said no; the request is then still under way.
bool waited(MPI_Request& request, const std::function<bool()>& go_on) {
  Clock::time_point asked = Clock::now();
  for (int done = 0;;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done) return true;
    std::this_thread::sleep_for(kBetweenTests);
    if (Clock::now() - asked < kBetweenQuestions) continue;
    asked = Clock::now();
    if (!go_on()) return false;
  }
}

void wait_unless_interrupted(MPI_Request& request) {
  if (!waited(request, [] { return !interrupted(); })) throw EndsWithOthers();
}

std::vector<TileRecord> records_of(const Film& film, const std::vector<int>& tiles) {
  std::vector<TileRecord> records;
  records.reserve(tiles.size());
  for (const int tile : tiles) records.push_back(renderer::record_of(film, tile));
  return records;
}

}  // namespace

struct RenderRanks::Others {
  // What is told of progress, and that one stops while another waits for a pass to end, is not mistaken for the rest.
  MPI_Comm all = MPI_COMM_NULL, progress = MPI_COMM_NULL, stopping = MPI_COMM_NULL;
  MPI_Datatype record = MPI_DATATYPE_NULL;
  int on_this_computer = 1;
  int uncaught = 0;  // when it began

  // Of the end of a pass that is waited for.
  enum class Stage { drawing, gathering, goals } stage = Stage::drawing;
  MPI_Request request = MPI_REQUEST_NULL;
  std::vector<TileRecord> sent, received;
  std::vector<int> counts, places;
  std::vector<int> goals;  // and whether there is a next pass

  std::vector<double> finished;  // of each rank, at the first
  double told = 0;
  MPI_Request telling = MPI_REQUEST_NULL;
  Clock::time_point told_at{};
  std::uint64_t tellings = 0;  // sent or, at the first, received

  void receive_progress() {
    for (int there = 1; there;) {
      MPI_Status status;
      MPI_Iprobe(MPI_ANY_SOURCE, 0, progress, &there, &status);
      if (there) receive_one(status.MPI_SOURCE);
    }
  }
  void receive_one(int from) {
    MPI_Status status;
    double value = 0;
    MPI_Recv(&value, 1, MPI_DOUBLE, from, 0, progress, &status);
    finished.at(static_cast<std::size_t>(status.MPI_SOURCE)) = value;
    ++tellings;
  }
  void begin_pass_end(const Film& film, const renderer::TileShare& share);
  void take_tiles(Film& film, const renderer::TileShare& share, int most_samples, double noise);
};

void RenderRanks::Others::begin_pass_end(const Film& film, const renderer::TileShare& share) {
  const int tiles = film.goals.cols;
  sent = records_of(film, renderer::tiles_in(share, tiles));
  counts.clear(), places.clear();
  for (int rank = 0, place = 0; share.number == 0 && rank < share.of; place += counts.back(), ++rank) {
    counts.push_back(static_cast<int>(renderer::tiles_in({rank, share.of}, tiles).size()));
    places.push_back(place);
  }
  received.resize(share.number == 0 ? static_cast<std::size_t>(tiles) : 0);
  MPI_Igatherv(sent.data(), static_cast<int>(sent.size()), record, received.data(), counts.data(), places.data(),
               record, 0, all, &request);
  stage = Stage::gathering;
}

void RenderRanks::Others::take_tiles(Film& film, const renderer::TileShare& share, int most_samples, double noise) {
  for (const TileRecord& one : received) renderer::put(one, film);
  goals.assign(static_cast<std::size_t>(film.goals.cols) + 1, 0);
  if (share.number == 0) {
    goals.back() = renderer::raise_goals(film, most_samples, noise);
    std::copy(film.goals.begin(), film.goals.end(), goals.begin());
  }
  MPI_Ibcast(goals.data(), static_cast<int>(goals.size()), MPI_INT, 0, all, &request);
  stage = Stage::goals;
}

RenderRanks::RenderRanks() = default;

RenderRanks RenderRanks::started() {
  return started_with_others() ? RenderRanks(std::make_unique<Others>()) : RenderRanks();
}

RenderRanks::RenderRanks(std::unique_ptr<Others> others) : others_(std::move(others)) {
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &share_.number);
  MPI_Comm_size(MPI_COMM_WORLD, &share_.of);
  if (share_.of == 1) {
    MPI_Finalize();
    throw std::runtime_error(
        "several processes were started that do not find each other; start them by the mpirun of the MPI that this "
        "threadstation was built with, or by srun --mpi=pmix");
  }
  others_->uncaught = std::uncaught_exceptions();
  MPI_Comm_dup(MPI_COMM_WORLD, &others_->all);
  MPI_Comm_dup(MPI_COMM_WORLD, &others_->progress);
  MPI_Comm_dup(MPI_COMM_WORLD, &others_->stopping);
  MPI_Type_contiguous(sizeof(TileRecord), MPI_BYTE, &others_->record);
  MPI_Type_commit(&others_->record);
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  MPI_Comm_size(here, &others_->on_this_computer);
  MPI_Comm_free(&here);
  others_->finished.resize(static_cast<std::size_t>(share_.of));
}

RenderRanks::~RenderRanks() {
  if (!others_) return;
  if (std::uncaught_exceptions() > others_->uncaught) {
    std::atexit([] {
      int rank = 0;
      MPI_Comm_rank(MPI_COMM_WORLD, &rank);
      if (rank > 0) std::this_thread::sleep_for(std::chrono::seconds(1));  // the first is the one that says why
      MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
    });
    static_cast<void>(others_.release());  // the others may be reading what a request under way sends
    return;
  }
  MPI_Type_free(&others_->record);
  MPI_Comm_free(&others_->stopping);
  MPI_Comm_free(&others_->progress);
  MPI_Comm_free(&others_->all);
  MPI_Finalize();
}

int RenderRanks::threads(int asked) const {
  if (asked > 0 || alone()) return asked;
  const auto mine = static_cast<int>(std::thread::hardware_concurrency()),  // what this process is bound to
      all = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
  return mine < all ? mine : std::max(1, all / others_->on_this_computer);
}

bool RenderRanks::of_first(bool said) {
  if (alone()) return said;
  int value = said;
  MPI_Ibcast(&value, 1, MPI_INT, 0, others_->all, &others_->request);
  wait_unless_interrupted(others_->request);
  return value != 0;
}

void RenderRanks::of_first(Film& film) {
  if (alone()) return;
  std::vector<int> tiles(static_cast<std::size_t>(film.goals.cols));
  std::iota(tiles.begin(), tiles.end(), 0);
  std::vector<TileRecord> records = records_of(film, tiles);
  MPI_Ibcast(records.data(), film.goals.cols, others_->record, 0, others_->all, &others_->request);
  wait_unless_interrupted(others_->request);
  for (const TileRecord& record : records) renderer::put(record, film);
}

void RenderRanks::must_agree(const std::string& text, const std::string& what) {
  if (alone()) return;
  constexpr int kHash = 64, kName = 64;  // characters
  std::array<char, kHash + kName> mine{};
  const std::string hash = sha256_hex(text);
  std::copy(hash.begin(), hash.end(), mine.begin());
  gethostname(mine.data() + kHash, kName - 1);
  std::vector<char> all(mine.size() * static_cast<std::size_t>(share_.of));
  MPI_Iallgather(mine.data(), kHash + kName, MPI_CHAR, all.data(), kHash + kName, MPI_CHAR, others_->all,
                 &others_->request);
  wait_unless_interrupted(others_->request);
  for (int rank = 1; rank < share_.of; ++rank) {
    const char* other = all.data() + mine.size() * static_cast<std::size_t>(rank);
    if (std::equal(other, other + kHash, all.data())) continue;
    if (!first()) throw EndsWithOthers();
    throw std::runtime_error("process " + std::to_string(rank) + " on " + (other + kHash) + " has another " + what +
                             " than process 0 on " + (all.data() + kHash) +
                             "; give all computers the same threadstation, libraries and files");
  }
}

PassEnd RenderRanks::end_pass(Film& film, int most_samples, double noise, const std::function<bool()>& go_on) {
  if (alone()) return renderer::raise_goals(film, most_samples, noise) ? PassEnd::next : PassEnd::finished;
  Others& others = *others_;
  if (others.stage == Others::Stage::drawing) others.begin_pass_end(film, share_);
  if (!waited(others.request, go_on)) return PassEnd::stopped;
  if (others.stage == Others::Stage::gathering) others.take_tiles(film, share_, most_samples, noise);
  if (!waited(others.request, go_on)) return PassEnd::stopped;
  others.stage = Others::Stage::drawing;
  std::copy_n(others.goals.begin(), film.goals.cols, film.goals.begin());
  return others.goals.back() != 0 ? PassEnd::next : PassEnd::finished;
}

double RenderRanks::tell(double finished) {
  if (alone()) return finished;
  Others& others = *others_;
  if (first()) {
    others.receive_progress();
    others.finished[0] = finished;
    return std::accumulate(others.finished.begin(), others.finished.end(), 0.0) / share_.of;
  }
  int sent = 1;
  MPI_Test(&others.telling, &sent, MPI_STATUS_IGNORE);
  if (!sent || Clock::now() - others.told_at < kBetweenTold) return finished;
  others.told = finished, others.told_at = Clock::now();
  ++others.tellings;
  MPI_Isend(&others.told, 1, MPI_DOUBLE, 0, 0, others.progress, &others.telling);
  return finished;
}

void RenderRanks::wait_for_parts() {
  if (alone()) return;
  constexpr auto kMost = std::chrono::seconds(10);  // others may have died
  const Clock::time_point begin = Clock::now();
  MPI_Request barrier = MPI_REQUEST_NULL;
  MPI_Ibarrier(others_->stopping, &barrier);
  waited(barrier, [&] { return Clock::now() - begin < kMost; });
}

renderer::RenderStatistics RenderRanks::sum_of(const renderer::RenderStatistics& mine) {
  if (alone()) return mine;
  Others& others = *others_;
  std::array<std::uint64_t, 3> counted{mine.samples, mine.rays, first() ? 0 : others.tellings}, sums{};
  MPI_Ireduce(counted.data(), sums.data(), static_cast<int>(sums.size()), MPI_UINT64_T, MPI_SUM, 0, others.all,
              &others.request);
  wait_unless_interrupted(others.request);
  if (!first()) MPI_Wait(&others.telling, MPI_STATUS_IGNORE);
  while (first() && others.tellings < sums[2]) others.receive_one(MPI_ANY_SOURCE);
  others.tellings = 0;
  std::fill(others.finished.begin(), others.finished.end(), 0.0);
  return {.samples = sums[0], .rays = sums[1]};
}

}  // namespace station
