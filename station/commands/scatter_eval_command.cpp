#include <iostream>

#include "station/commands/commands.h"
#include "station/thread/scatter/queries.h"

namespace station {

void add_scatter_eval_command(CLI::App& scatter) {
  auto queries = std::make_shared<ScatteringQueries>();
  CLI::App* command = scatter.add_subcommand("eval", "values of a scattering model at listed directions");
  command->add_option("--model", queries->model, "what scatters")
      ->required()
      ->check(CLI::IsMember({"fiber", "thread", "yarn"}));
  command->add_option("--parameters", queries->parameters,
                      "fiber, thread or yarn file; a fiber's may be left out when the table has all its columns");
  command->add_option("--in", queries->in, "table of directions (CSV)")->required();
  command->add_option("--out", queries->out, "table of values to write (CSV)")->required();
  command->callback(
      [queries] { std::cout << evaluate_queries(*queries) << " values: " << queries->out.string() << "\n"; });
}

}  // namespace station
