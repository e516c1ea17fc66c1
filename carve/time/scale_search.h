#pragma once

#include <functional>

namespace fluidcarve {

/// The number, in voxels or spacings of points, at which an error is least: first among numbers
/// from 0.05 to 8 in steps of a factor of 1.5, then by golden section.
/// @param error  at a number; called from this thread
/// @return 0 if no number is better than 0
double least_error_at(const std::function<double(double)>& error);

}  // namespace fluidcarve
