#include "carve/mask/dilate.h"

#include "carve/field/stencil.h"

#include <openvdb/tools/Morphology.h>
#include <openvdb/tools/Prune.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace fluidcarve {

namespace {

/// How far from a tile's faces voxels may change.
int reach(int voxels) { return std::max(std::abs(voxels), 1); }

}  // namespace

MaskGrid::Ptr dilated_mask(const MaskGrid& mask, int voxels) {
    using namespace openvdb::tools;
    const auto out = mask.deepCopy();
    // OpenVDB would voxelise every tile. Once the borders of tiles are leaves, it can ignore their
    // inside.
    open_tile_borders(out->tree(), reach(voxels));
    if (voxels > 0) dilateActiveValues(out->tree(), voxels, NN_FACE_EDGE_VERTEX, IGNORE_TILES);
    if (voxels < 0) erodeActiveValues(out->tree(), -voxels, NN_FACE_EDGE_VERTEX, IGNORE_TILES);
    prune(out->tree());
    out->setName((voxels < 0 ? "erosion of " : "dilation of ") + mask.getName());
    return out;
}

}  // namespace fluidcarve
