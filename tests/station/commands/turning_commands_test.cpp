// A command that turns the platform must be listed among those that do, so that --help names it and a test stops it.
#include <gtest/gtest.h>

#include <stdexcept>

#include "station/bench/rig_devices.h"
#include "station/commands/commands.h"
#include "tests/places.h"

TEST(TurningCommands, OneThatIsNotListedFailsWhenItHasOpenedATurntable) {
  const auto checked = [](const char* command) {
    CLI::App app;
    app.add_subcommand("quiet", "");
    station::turns_platform(app.add_subcommand("loud", ""));
    app.parse(command);
    station::require_declared_turning(app);
  };
  EXPECT_NO_THROW(checked("quiet"));
  station::open_turntable(station::read_rig(std::string(DATA_DIR) + "/rigs/simulated_wire_grbl.json"), nullptr);
  EXPECT_THROW(checked("quiet"), std::logic_error);
  EXPECT_NO_THROW(checked("loud"));
}
