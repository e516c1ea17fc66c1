#pragma once

#include "carve/points/points.h"
#include "formats/file/provenance.h"
#include "formats/points_file/point_losses.h"

#include <optional>
#include <string>

namespace fluidcarve {

/// How points go to a .usda file.
struct UsdPointsRequest {
    const Placement* placement = nullptr;  ///< the placement to undo in positions; null: none
    std::optional<double> width;  ///< width of every point, world units; nothing: twice the
                                  ///< attribute `radius` or `pscale`, else half a voxel
    std::optional<int> frame;  ///< the time of the points; nothing: they are the same at all times
    Provenance provenance;
};

/// Writes points as a .usda file with one UsdGeomPoints. Positions are those of the shot's world.
/// Normals, colours, an `id` and a `velocity` (`v`) become USD's own attributes, other attributes
/// primvars. The file appears whole or not at all.
/// @throws Failure if the file can't be written
PointLosses write_points_usda(const std::string& path, const Points& points,
                              const UsdPointsRequest& request);

}  // namespace fluidcarve
