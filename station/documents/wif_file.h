// A reader of drafts in the weavers' own format, WIF (Weaving Information File 1.1, Nielsen et al. 1997): threading,
// tie-up and treadling or lift plan, colours, spacing and thickness.
//
// The structure is the drawdown, reduced to its shortest repeat; so is each order of colours. A colour of the palette
// is a thread: threads are numbered in the order in which their colours first appear, warp first. [WARP] and [WEFT]
// must give Threads, Units, Spacing and Thickness. Sections and keys that do not describe the cloth (notes, private
// sections) are passed over, as the format demands.
//
// Errors: std::runtime_error, one line: the file, the section and key, what was found and what to do. A file that is
// cut short lacks sections that its [CONTENTS] promise, threads that [WARP] and [WEFT] count, or the end of its last
// line.
#pragma once

#include <filesystem>
#include <string>

#include "renderer/weave/draft.h"

namespace station {

renderer::Draft parse_wif(const std::string& text, const std::string& source);
renderer::Draft read_wif(const std::filesystem::path& file);

}  // namespace station
