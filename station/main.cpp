// threadstation: reads the command line, runs one command, and turns every failure into one line and an exit status.

#include <csignal>
#include <cstdio>
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
  station::add_demo_command(app);
  station::add_devices_command(app);
  station::add_check_command(app);
  station::add_preview_command(app);
  station::add_camera_process_command(app);
  station::add_simulate_hardware_command(app);
  station::add_calibrate_command(app);
  station::add_capture_command(app);
  station::add_import_command(app);
  station::add_pattern_command(app);
  station::add_plan_command(app);
  station::add_replay_command(app);
  station::add_verify_command(app);
  station::add_develop_command(app);
  station::add_invert_command(app);
  station::add_report_command(app);
  station::add_cloth_command(app);
  station::add_predict_command(app);
  station::add_compare_command(app);
  station::add_library_command(app);
  station::add_export_command(app);
  station::add_serve_command(app);
  station::add_scatter_command(app);
  station::add_target_command(app);
  station::add_recover_command(app);
  station::add_embroider_command(app);
  station::add_validate_command(app);
  station::add_validate_cloth_command(app);
  station::add_weave_command(app);
  station::add_render_command(app);
  try {
    app.parse(argc, argv);
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
