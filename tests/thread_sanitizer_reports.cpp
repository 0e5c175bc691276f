// What the thread sanitizer is not to report: Debian's libgdal takes two of its own mutexes in either order while it
// registers its formats, which OpenCV makes it do, in one thread, when the first JPEG is written.
extern "C" const char* __tsan_default_suppressions() {
  return "deadlock:libgdal.so\n";
}
