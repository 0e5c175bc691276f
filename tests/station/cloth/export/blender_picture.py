"""A picture of scene a or b of fixtures/reference/README.md in Cycles, in the material of an exported thread. Run by:

  blender --background --factory-startup --python-exit-code 1 --python tests/station/cloth/export/blender_picture.py -- \
    MATERIAL.py a|b SPP OUT.exr
"""

import importlib.util
import os
import sys

import bpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "bench"))
from cycles_scenes import build, empty_scene  # noqa: E402

VERTICES = 65


def loaded(path):
    spec = importlib.util.spec_from_file_location("thread_material", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def main():
    path, name, spp, out = sys.argv[sys.argv.index("--") + 1:]
    scene = empty_scene()
    exported = loaded(path)
    build(scene, name, exported.thread_material(), VERTICES, os.cpu_count())
    exported.use_round_curves(scene)
    scene.cycles.samples = int(spp)
    scene.render.filepath = out
    bpy.ops.render.render(write_still=True)


main()
