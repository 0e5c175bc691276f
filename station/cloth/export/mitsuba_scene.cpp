#include "station/cloth/export/mitsuba_scene.h"

#include <pugixml.hpp>
#include <sstream>

#include "station/documents/number_text.h"

namespace station {
namespace {

std::string number(double value) {
  return formatted("%.9g", value);
}

void add(pugi::xml_node& parent, const char* type, const char* name, const std::string& value) {
  pugi::xml_node node = parent.append_child(type);
  node.append_attribute("name") = name;
  node.append_attribute("value") = value.c_str();
}

std::string comment(const FiberExport& fiber) {
  std::string text;
  for (const std::string& line : approximation(fiber)) text += "\n    " + line;
  return text +
         "\n    Use: <include filename=\"thread.xml\"/>, then <ref id=\"thread\"/> in shapes of type bsplinecurve "
         "whose\n"
         "    radius is half the thread's diameter; absorption is per radius, so that other sizes keep their "
         "colour.\n  ";
}

}  // namespace

std::string mitsuba_scene(const FiberExport& fiber) {
  const renderer::FiberParameters& p = fiber.nearest.fiber;
  const double most = p.sigma_a.maxCoeff(), scale = most > 0 ? most : 1;
  pugi::xml_document document;
  pugi::xml_node scene = document.append_child("scene");
  scene.append_attribute("version") = "3.0.0";
  scene.append_child(pugi::node_comment).set_value(comment(fiber).c_str());
  pugi::xml_node bsdf = scene.append_child("bsdf");
  bsdf.append_attribute("type") = "hair";
  bsdf.append_attribute("id") = "thread";
  add(bsdf, "float", "longitudinal_roughness", number(p.beta_m));
  add(bsdf, "float", "azimuthal_roughness", number(p.beta_n));
  add(bsdf, "float", "int_ior", number(p.eta));
  add(bsdf, "float", "ext_ior", "1");
  add(bsdf, "float", "scale_tilt", "0");
  const Eigen::Vector3d share = (p.sigma_a / scale).cwiseMin(1.0);
  add(bsdf, "rgb", "sigma_a", number(share[0]) + ", " + number(share[1]) + ", " + number(share[2]));
  add(bsdf, "float", "scale", number(scale));
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

}  // namespace station
