// threadstation: reads the command line, runs one command, and turns every failure into one line and an exit status.

#include <csignal>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>

#include "station/commands/commands.h"
#include "station/documents/session_file.h"

namespace {

int fail(const std::string& message) {
  std::string line = message;
  for (char& c : line)
    if (c == '\n' || c == '\r') c = ' ';
  std::cerr << "threadstation: " << line << "\n";
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a reader that went away is an error of the write, not a death
  CLI::App app{"Digitizes spools of thread and predicts the cloth they will make."};
  app.name("threadstation");
  app.set_version_flag("--version", station::software_version());
  app.require_subcommand(1);
  using namespace station;
  for (const auto add : {add_demo_command,      add_devices_command,        add_check_command,
                         add_preview_command,   add_camera_process_command, add_simulate_hardware_command,
                         add_turntable_command, add_home_command,           add_calibrate_command,
                         add_capture_command,   add_import_command,         add_pattern_command,
                         add_plan_command,      add_replay_command,         add_verify_command,
                         add_develop_command,   add_invert_command,         add_report_command,
                         add_cloth_command,     add_predict_command,        add_compare_command,
                         add_library_command,   add_export_command,         add_serve_command,
                         add_scatter_command,   add_target_command,         add_recover_command,
                         add_embroider_command, add_validate_command,       add_validate_cloth_command,
                         add_weave_command,     add_render_command})
    add(app);
  try {
    app.parse(argc, argv);
    require_declared_turning(app);
    std::cout.flush();
    if (!std::cout) return fail("cannot write to standard output; is the disk full?");
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    fail(std::string(error.what()) + "; see --help");
    return 2;
  } catch (const std::bad_alloc&) {
    return fail("out of memory; use smaller pictures or fewer samples");
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}
