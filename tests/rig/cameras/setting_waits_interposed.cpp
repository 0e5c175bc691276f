// The time of a camera process in this test program: while a setting has not come about, libgphoto2 looks again every
// 200 ms for more than 3 s. The simulated camera makes a setting when it is told or never, so these waits are passed
// over: nobody sleeps, and the clock that the library reads goes on by as much. Every other wait is a real one.
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>

namespace {

using std::chrono::microseconds;

constexpr microseconds kBetweenLooks{200'000};
std::atomic<microseconds> passed_over{microseconds(0)};

// Since 1970, as this program's libraries see it.
microseconds seen_time() {
  timespec real{};
  clock_gettime(CLOCK_REALTIME, &real);
  return std::chrono::seconds(real.tv_sec) + microseconds(real.tv_nsec / 1000) + passed_over.load();
}

}  // namespace

extern "C" {

int usleep(useconds_t duration_us) {
  if (microseconds(duration_us) == kBetweenLooks) {
    microseconds before = passed_over;
    while (!passed_over.compare_exchange_weak(before, before + kBetweenLooks)) {
    }
    return 0;
  }
  timespec left{.tv_sec = duration_us / 1'000'000, .tv_nsec = 1000L * (duration_us % 1'000'000)};
  const int failed = clock_nanosleep(CLOCK_MONOTONIC, 0, &left, nullptr);
  errno = failed;
  return failed == 0 ? 0 : -1;
}

time_t time(time_t* also) noexcept {
  const time_t now_s = std::chrono::duration_cast<std::chrono::seconds>(seen_time()).count();
  if (also != nullptr) *also = now_s;
  return now_s;
}

int gettimeofday(timeval* now, void*) noexcept {
  const microseconds seen = seen_time();
  now->tv_sec = seen.count() / 1'000'000;
  now->tv_usec = seen.count() % 1'000'000;
  return 0;
}

}  // extern "C"
