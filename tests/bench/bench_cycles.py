"""Scenes a and b of fixtures/reference/README.md in Cycles on the processor: mean radiance and million samples per second.

Run by:

  blender --background --factory-startup --python tests/bench/bench_cycles.py -- SCENE VERTICES SPP [THREADS] [defaults]

SCENE is a or b, VERTICES the scattering vertices allowed. `defaults` leaves Blender's clamping and glossy filter on, which
change the picture. Prints one line: scene, vertices, mean R G B, seconds of rendering without the building of the scene
(a second picture with one sample per pixel is subtracted), million samples per second, relative error of a pixel of SPP
samples (root mean square over the picture's mean, from two more pictures).
"""

import math
import os
import sys
import tempfile
import time

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from cycles_scenes import HEIGHT, WIDTH, build, empty_scene  # noqa: E402


def fiber_material():
    material = bpy.data.materials.new("fiber")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    fiber = tree.nodes.new("ShaderNodeBsdfHairPrincipled")
    fiber.parametrization = "ABSORPTION"
    for name, value in {"Absorption Coefficient": (0.1, 0.3, 0.8), "Roughness": 0.3, "Radial Roughness": 0.3,
                        "Coat": 0.0, "IOR": 1.55, "Offset": 0.0, "Random Roughness": 0.0}.items():
        fiber.inputs[name].default_value = value
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(fiber.outputs[0], output.inputs["Surface"])
    return material


def render(scene, spp):
    scene.cycles.samples = spp
    file = os.path.join(tempfile.mkdtemp(), "picture.exr")
    scene.render.filepath = file
    start = time.time()
    bpy.ops.render.render(write_still=True)
    seconds = time.time() - start
    image = bpy.data.images.load(file)
    image.colorspace_settings.name = "Linear"
    pixels = image.pixels[:]
    os.remove(file)
    channels = [pixels[channel::4] for channel in range(3)]
    return [sum(channel) / (WIDTH * HEIGHT) for channel in channels], seconds, channels


def noise(scene, spp):
    pictures = []
    for seed in (1, 2):
        scene.cycles.seed = seed
        pictures.append(render(scene, spp))
    squares = sum((x - y) ** 2 for a, b in zip(pictures[0][2], pictures[1][2]) for x, y in zip(a, b))
    mean = (sum(pictures[0][0]) + sum(pictures[1][0])) / 6
    return math.sqrt(squares / (2 * 3 * WIDTH * HEIGHT)) / mean


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    if len(arguments) < 3 or arguments[0] not in ("a", "b"):
        sys.exit("usage: blender --background --factory-startup --python tests/bench/bench_cycles.py -- "
                 "a|b VERTICES SPP [THREADS] [defaults]")
    name, vertices, spp = arguments[0], int(arguments[1]), int(arguments[2])
    threads = int(arguments[3]) if len(arguments) > 3 else os.cpu_count()
    scene = empty_scene()
    build(scene, name, fiber_material(), vertices, threads, "defaults" in arguments)
    _, setting_up, _ = render(scene, 1)
    mean, seconds, _ = render(scene, spp + 1)
    rate = WIDTH * HEIGHT * spp / (seconds - setting_up) / 1e6
    print("cycles,%s,%d,%.4f,%.4f,%.4f,%.2f s,%.3f million samples/s,noise %.4f" %
          (name, vertices, *mean, seconds - setting_up, rate, noise(scene, spp)))


main()
