"""Scenes a and b of fixtures/reference/README.md in Cycles on the processor: mean radiance and million samples per second.

Needs Debian 12's `blender` (3.4; apt-get install --no-install-recommends blender), which nothing else here does. Run by:

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

WIDTH, HEIGHT, DISTANCE = 512, 384, 400.0


def parallel_threads():
    """50 touching straight threads along x: points of each, and the frame's width."""
    return [[(x, (i - 24.5) * 0.3, 0.0) for x in (-30.0, 0.0, 30.0)] for i in range(50)], 20.0


def plain_weave():
    """200 x 200 yarns, four segments a crossing; Cycles draws Catmull-Rom splines through the points."""
    yarns, count, segments = [], 200, 4
    for warp in (False, True):
        for i in range(count):
            across = (i - 99.5) * 0.45
            yarn = []
            for k in range(-1, count * segments + 2):
                t = k / segments
                along, z = -45 + 0.45 * t, (-1 if warp else 1) * 0.15 * math.cos(math.pi * (t - 0.5) + math.pi * i)
                yarn.append((across, along, z) if warp else (along, across, z))
            yarns.append(yarn)
    return yarns, 90.0


def add_curves(yarns, material, radius):
    """Hair curves: through a curve object of polylines and geometry nodes, as Blender 3.4 has no other way for scripts."""
    source = bpy.data.curves.new("yarns", "CURVE")
    source.dimensions = "3D"
    for yarn in yarns:
        spline = source.splines.new("POLY")
        spline.points.add(len(yarn) - 1)
        spline.points.foreach_set("co", [number for point in yarn for number in (*point, 1.0)])
    source_object = bpy.data.objects.new("yarns", source)
    bpy.context.collection.objects.link(source_object)
    source_object.hide_render = True

    hair = bpy.data.hair_curves.new("hair")
    hair_object = bpy.data.objects.new("hair", hair)
    bpy.context.collection.objects.link(hair_object)
    hair.materials.append(material)
    nodes = bpy.data.node_groups.new("nodes", "GeometryNodeTree")
    nodes.outputs.new("NodeSocketGeometry", "Geometry")
    info = nodes.nodes.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = source_object
    size = nodes.nodes.new("GeometryNodeSetCurveRadius")
    size.inputs["Radius"].default_value = radius
    paint = nodes.nodes.new("GeometryNodeSetMaterial")
    paint.inputs["Material"].default_value = material
    end = nodes.nodes.new("NodeGroupOutput")
    nodes.links.new(info.outputs["Geometry"], size.inputs["Curve"])
    nodes.links.new(size.outputs["Curve"], paint.inputs["Geometry"])
    nodes.links.new(paint.outputs["Geometry"], end.inputs[0])
    hair_object.modifiers.new("nodes", "NODES").node_group = nodes


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


def build(name, vertices, threads, defaults):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    yarns, frame = parallel_threads() if name == "a" else plain_weave()
    add_curves(yarns, fiber_material(), 0.15)

    light = bpy.data.lights.new("light", "POINT")
    light.shadow_soft_size = 5.0
    light.energy = 10 * DISTANCE**2 * 4 * math.pi  # irradiance 10 at the origin
    light_object = bpy.data.objects.new("light", light)
    light_object.location = (0, DISTANCE * math.sin(math.pi / 6), DISTANCE * math.cos(math.pi / 6))
    bpy.context.collection.objects.link(light_object)

    camera = bpy.data.cameras.new("camera")
    camera.angle_x = 2 * math.atan(frame / 2 / DISTANCE)
    camera.clip_end = 10 * DISTANCE
    camera_object = bpy.data.objects.new("camera", camera)
    camera_object.location = (0, 0, DISTANCE)
    bpy.context.collection.objects.link(camera_object)
    scene.camera = camera_object

    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0, 0, 0)
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", threads
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.hair_type = "STRAND"
    scene.cycles_curves.shape = "THICK"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    for kind in ("max", "diffuse", "glossy", "transmission", "volume"):
        setattr(cycles, kind + "_bounces", vertices - 1)
    if not defaults:
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
        cycles.blur_glossy = 0
        cycles.light_sampling_threshold = 0
    return scene


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
    scene = build(name, vertices, threads, "defaults" in arguments)
    _, setting_up, _ = render(scene, 1)
    mean, seconds, _ = render(scene, spp + 1)
    rate = WIDTH * HEIGHT * spp / (seconds - setting_up) / 1e6
    print("cycles,%s,%d,%.4f,%.4f,%.4f,%.2f s,%.3f million samples/s,noise %.4f" %
          (name, vertices, *mean, seconds - setting_up, rate, noise(scene, spp)))


main()
