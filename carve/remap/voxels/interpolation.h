#pragma once

namespace fluidcarve {

/// How a grid is read between its voxels: from 2^3, 3^3 or 4^3 of them (cubic is Catmull-Rom).
enum class Interpolation { linear, quadratic, cubic };

}  // namespace fluidcarve
