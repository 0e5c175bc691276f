// The commands of the public interface, one function each: it adds the sub-command with its options, whose callback
// reads arguments, calls one function and prints. Errors are thrown and printed by main.
#pragma once

#include <CLI/CLI.hpp>

namespace station {

void add_batch_command(CLI::App& app);
void add_calibrate_command(CLI::App& app);
void add_camera_process_command(CLI::App& app);
void add_capture_command(CLI::App& app);
void add_check_command(CLI::App& app);
void add_cloth_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_completion_command(CLI::App& app);
void add_demo_command(CLI::App& app);
void add_develop_command(CLI::App& app);
void add_devices_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_library_command(CLI::App& app);
void add_look_command(CLI::App& app);
void add_pattern_command(CLI::App& app);
void add_plan_command(CLI::App& app);
void add_predict_command(CLI::App& app);
void add_preview_command(CLI::App& app);
void add_render_command(CLI::App& app);
void add_home_command(CLI::App& app);
void add_import_command(CLI::App& app);
void add_invert_command(CLI::App& app);
void add_replay_command(CLI::App& app);
void add_report_command(CLI::App& app);
void add_reproduce_command(CLI::App& app);
void add_rig_command(CLI::App& app);
void add_serve_command(CLI::App& app);
void add_scatter_command(CLI::App& app);
void add_simulate_hardware_command(CLI::App& app);
void add_target_command(CLI::App& app);
void add_turntable_command(CLI::App& app);
void add_recover_command(CLI::App& app);
void add_embroider_command(CLI::App& app);
void add_validate_cloth_command(CLI::App& app);
void add_validate_command(CLI::App& app);
void add_upgrade_command(CLI::App& app);
void add_verify_command(CLI::App& app);
void add_weave_command(CLI::App& app);

// Marks a command that opens a rig's turntable: --help says so of it, and a test stops each of them.
CLI::App* turns_platform(CLI::App* command);

// Throws std::logic_error after a command that opened a real turntable and is not marked.
void require_declared_turning(const CLI::App& app);

// The sub-commands of `threadstation scatter` and of `threadstation export`.
void add_scatter_eval_command(CLI::App& scatter);
void add_scatter_fit_command(CLI::App& scatter);
void add_scatter_plot_command(CLI::App& scatter);
void add_scatter_prior_command(CLI::App& scatter);
void add_scatter_exits_command(CLI::App& scatter);
void add_scatter_simulate_command(CLI::App& scatter);
void add_export_thread_command(CLI::App& exports);
void add_export_cloth_command(CLI::App& exports);

}  // namespace station
