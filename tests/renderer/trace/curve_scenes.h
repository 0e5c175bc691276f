// The two scenes of curves that fixtures/reference/README.md describes, with their cameras.
#pragma once

#include "renderer/picture/camera.h"
#include "renderer/scene/scene.h"

namespace renderer {

struct CurveScene {
  Scene scene;
  Camera camera;
};

CurveScene parallel_threads_scene();  // scene a: 50 touching straight threads
CurveScene plain_weave_scene();       // scene b: 200 x 200 woven yarns
CurveScene plain_weave_cloth();       // scene b as cloth in two scales: 2 x 2 yarns are stored

}  // namespace renderer
