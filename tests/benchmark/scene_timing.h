// What the measurements of plans of scenes share.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <darboux/scene.h>

namespace darboux::bench {

// The medians of several things done in turns: seconds of the calling thread, which other programs do not add
// to.
std::vector<double> medians(int rounds, const std::vector<std::function<void()>>& things);

// What evaluates a plan and throws the numbers away.
void evaluate(const Scene& scene, const ScenePlan& plan);

// Spheres, tori, cylinders and cones, 2 to 200 radii from the eye.
Scene scattered(std::size_t count);

}  // namespace darboux::bench
