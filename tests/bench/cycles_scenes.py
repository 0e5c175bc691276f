"""Scenes a and b of fixtures/reference/README.md for Cycles on the processor, with any material; for scripts that Blender runs."""

import math

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


def empty_scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy.context.scene


def build(scene, name, material, vertices, threads, defaults=False):
    """Fills an empty scene; `vertices` scattering vertices are allowed. `defaults` leaves on what changes the picture."""
    yarns, frame = parallel_threads() if name == "a" else plain_weave()
    add_curves(yarns, material, 0.15)

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
