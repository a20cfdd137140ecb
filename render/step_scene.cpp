#include "render/step_scene.hpp"
