// The lamp's output in the pictures of the Spectralon panel, told by the tags on the table: nothing moves there, so
// between pictures under one place of the lamp their brightness changes as the lamp does.
//
// The panel faces the lamp and turns its back to the table behind the platform, so its light does not reach them; its
// shadow and the panel itself do, and such tags are left out.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "calibration/develop.h"
#include "calibration/still_tags.h"

namespace station {

// Mean radiance (sum of the colours) within each tag, by id; tags that are saturated or leave the picture are left out.
std::map<int, double> tag_radiances(const calibration::Developed& picture, const calibration::StillTags& tags);

// One entry per picture, all under the same place of the lamp: output over the typical one. Nothing where no tag lies in
// the open.
std::vector<std::optional<double>> lamp_outputs(const std::vector<std::map<int, double>>& pictures);

}  // namespace station
