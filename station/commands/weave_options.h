// What a cloth of a digitized thread is woven by: the options that `cloth` and `look` share.
#pragma once

#include "station/cloth/preview/woven_threads.h"
#include "station/commands/ready_name.h"
#include "station/documents/cloth_fibers.h"

namespace station {

inline void add_weave_options(CLI::App& command, ThreadsToWeave& cloth) {
  or_ready("drafts", command.add_option("--draft", cloth.draft,
                                        "draft (JSON or WIF) or a ready one's name; scaled to the threads"))
      ->required();
  or_ready("threads", command.add_option("--weft", cloth.weft_thread,
                                         "thread or bundle file of the weft, or a ready thread's name; the warp's "
                                         "without it"));
  command.add_flag("--uneven", cloth.uneven,
                   "threads as uneven in shade and thickness as invert measured them; even ones without it");
  command
      .add_option(
          "--fibers", cloth.fibers,
          "what is seen of the fibers close by, for pictures that are looked at (of a bundle only those that stand "
          "out); smooth threads without it")
      ->check(CLI::IsMember(fiber_kinds()));
}

}  // namespace station
