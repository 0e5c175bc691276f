// threadstation: reads the command line, runs one command, and turns every failure into one line and an exit status.

#include <csignal>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>

#include "station/cloth/render/ranks.h"
#include "station/commands/commands.h"
#include "station/commands/guide.h"
#include "station/commands/nearest_word.h"
#include "station/commands/plain_help.h"
#include "station/documents/disk/stored_file.h"
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
  // A reader that went away and a file that may not grow are errors of the write, not deaths.
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  CLI::App app{"Digitizes spools of thread and predicts the cloth they will make."};
  app.name("threadstation");
  app.set_version_flag("--version", station::software_version());
  app.require_subcommand(1);
  app.formatter(std::make_shared<station::PlainHelp>());
  using namespace station;
  // In the order in which --help lists them (guide.cpp).
  for (const auto add : {add_demo_command,      add_devices_command,        add_rig_command,
                         add_target_command,    add_check_command,          add_home_command,
                         add_preview_command,   add_turntable_command,      add_simulate_hardware_command,
                         add_calibrate_command, add_serve_command,          add_plan_command,
                         add_capture_command,   add_import_command,         add_replay_command,
                         add_verify_command,    add_develop_command,        add_invert_command,
                         add_report_command,    add_library_command,        add_weave_command,
                         add_cloth_command,     add_look_command,           add_render_command,
                         add_pattern_command,   add_embroider_command,      add_predict_command,
                         add_compare_command,   add_export_command,         add_scatter_command,
                         add_validate_command,  add_validate_cloth_command, add_recover_command,
                         add_reproduce_command, add_batch_command,          add_completion_command,
                         add_upgrade_command,   add_camera_process_command})
    add(app);
  add_guide(app);
  try {
    app.parse(argc, argv);
    require_declared_turning(app);
    std::cout.flush();
    if (!std::cout) return fail("cannot write to standard output; is the disk full?");
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    const std::optional<std::string> unknown = unknown_word(app, {argv + 1, argv + argc});
    fail(unknown ? *unknown : std::string(error.what()) + "; see --help");
    return 2;
  } catch (const station::EndsWithOthers&) {
    return 1;
  } catch (const std::bad_alloc&) {
    return fail("out of memory; use smaller pictures or fewer samples");
  } catch (const std::exception& error) {
    return fail(problem_line(error));
  }
}
