#include "station/session/import_file.h"

#include <algorithm>

#include "station/documents/degree.h"
#include "station/documents/plan_file.h"
#include "station/documents/reader.h"

namespace station {
namespace {

ImportedPicture read_picture(ObjectReader& reader, const std::filesystem::path& folder) {
  ImportedPicture picture;
  picture.file = folder / reader.text("file");
  const std::string kind = reader.choice("kind", {"view", "pose", "dark"});
  picture.kind = kind == "view" ? StepKind::view : kind == "pose" ? StepKind::pose : StepKind::dark;
  if (picture.kind != StepKind::dark) {
    picture.mounting = mounting_from_name(reader.choice("mounting", {"horizontal", "vertical"}));
    picture.platform_angle_rad = reader.number("platform_angle_deg", -360, 360) * kDegree;
  }
  picture.lamp =
      picture.kind == StepKind::view ? lamp_from_name(reader.choice("lamp", {"front", "back"})) : rig::Lamp::off;
  if (!std::filesystem::is_regular_file(picture.file))
    reader.refuse("file", "there is no file \"" + picture.file.string() + "\"; correct the path");
  reader.finish();
  return picture;
}

}  // namespace

ImportFile read_import_file(const std::filesystem::path& file) {
  const nlohmann::json document = read_json_file(file);
  ObjectReader reader(document, file.string(), "import");
  const std::filesystem::path folder = file.parent_path();
  ImportFile import;
  import.rig = folder / reader.text("rig");
  import.spool = folder / reader.text("spool");
  if (reader.has("calibration")) import.calibration = folder / reader.text("calibration");
  if (reader.has("lens")) import.lens = folder / reader.text("lens");
  if (reader.has("lamp_intensity_mm2")) import.lamp_intensity_mm2 = reader.vector3("lamp_intensity_mm2");
  if (reader.has("operator")) import.person = reader.text("operator");
  for (ObjectReader& picture : reader.objects("pictures")) import.pictures.push_back(read_picture(picture, folder));
  if (import.calibration.empty() && !import.lamp_intensity_mm2)
    reader.refuse(
        "lamp_intensity_mm2",
        "without a calibration the lamp's intensity is needed (radiance unit x mm^2 for R, G, B); give it, or "
        "name a calibration");
  if (!import.calibration.empty() && (!import.lens.empty() || import.lamp_intensity_mm2))
    reader.refuse("calibration", "a calibration has lens and lamp already; leave lens and lamp_intensity_mm2 out");
  if (std::ranges::count(import.pictures, StepKind::view, &ImportedPicture::kind) == 0)
    reader.refuse("pictures", "there is no view among them; list at least one");
  reader.finish();
  return import;
}

}  // namespace station
