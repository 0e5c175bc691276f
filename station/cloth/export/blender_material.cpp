#include "station/cloth/export/blender_material.h"

#include <cstdio>

namespace station {
namespace {

constexpr const char* kScript = R"(
import bpy


def thread_material(name=THREAD):
    """A new material with the fiber's parameters; absorption is per radius, so that curves may have any."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    fiber = tree.nodes.new("ShaderNodeBsdfHairPrincipled")
    if hasattr(fiber, "model"):  # Blender 4 has two
        fiber.model = "CHIANG"
    fiber.parametrization = "ABSORPTION"
    for socket, value in PARAMETERS.items():
        fiber.inputs[socket].default_value = value
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(fiber.outputs[0], output.inputs["Surface"])
    return material


def use_round_curves(scene):
    """Curves as the scattering model needs them, and paths that nothing cuts short."""
    scene.render.engine = "CYCLES"
    scene.render.hair_type = "STRAND"
    scene.cycles_curves.shape = "THICK"
    scene.cycles.blur_glossy = 0
    scene.cycles.sample_clamp_direct = 0
    scene.cycles.sample_clamp_indirect = 0
    for kind in ("max", "diffuse", "glossy", "transmission"):
        setattr(scene.cycles, kind + "_bounces", 64)


if __name__ == "__main__":
    thread_material()
    use_round_curves(bpy.context.scene)
)";

}  // namespace

std::string blender_material(const FiberExport& fiber) {
  const renderer::FiberParameters& p = fiber.nearest.fiber;
  std::string text;
  for (const std::string& line : approximation(fiber)) text += "# " + line + "\n";
  text +=
      "#\n# Run in Blender (Scripting, or blender scene.blend --python thread_material.py), then give the material "
      "to hair\n"
      "# curves whose radius is half the thread's diameter.\n\n";
  char parameters[512];
  std::snprintf(parameters, sizeof parameters,
                "PARAMETERS = {\n"
                "    \"Absorption Coefficient\": (%.9g, %.9g, %.9g),\n"
                "    \"Roughness\": %.9g,\n"
                "    \"Radial Roughness\": %.9g,\n"
                "    \"IOR\": %.9g,\n"
                "    \"Coat\": 0.0,\n"
                "    \"Offset\": 0.0,\n"
                "    \"Random Roughness\": 0.0,\n"
                "}\n",
                p.sigma_a[0], p.sigma_a[1], p.sigma_a[2], p.beta_m, p.beta_n, p.eta);
  return text + "THREAD = " + nlohmann::json(fiber.thread).dump() +
         "\nDIAMETER_MM = " + nlohmann::json(fiber.diameter_mm).dump() + "\n" + parameters + kScript;
}

}  // namespace station
