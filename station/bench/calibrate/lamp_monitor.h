// The lamp's output in the pictures of the Spectralon panel, read from the tags on the table. Nothing moves there, so
// between pictures under one place of the lamp the tags' brightness changes as the lamp does.
//
// The panel faces the lamp and turns its back to the table behind the platform, so its light does not reach them; its
// shadow and the panel itself do, and such tags are left out.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "calibration/develop/develop.h"
#include "calibration/geometry/still_tags.h"

namespace station {

// The mean radiance (sum of the colours) within each tag, by the tag's id; tags that are saturated or leave the picture
// are left out.
std::map<int, double> tag_radiances(const calibration::Developed& picture, const calibration::StillTags& tags);

// The lamp's output in each picture over the typical one; nothing where no tag lies in the open. The lamp stands at the
// same place in all pictures.
std::vector<std::optional<double>> lamp_outputs(const std::vector<std::map<int, double>>& pictures);

}  // namespace station
