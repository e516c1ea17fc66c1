#include "nodes/mask/dilate.h"

#include "nodes/field/stencil.h"

#include <openvdb/tools/Morphology.h>
#include <openvdb/tools/Prune.h>

#include <algorithm>
#include <cstdlib>

namespace fluidcarve {
namespace {

/// How far from a tile's faces voxels may change.
int reach(int voxels) { return std::max(std::abs(voxels), 1); }

struct MaskDilate {
    struct Params {
        int voxels = 0;
    };
    struct Ports {
        Ref<MaskGrid> mask, dilated;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        require_stencil_fits(*io.mask, state_bytes, context.memory_budget());
        io.dilated = dilated_mask(*io.mask, params.voxels);
    }
};

}  // namespace

MaskGrid::Ptr dilated_mask(const MaskGrid& mask, int voxels) {
    using namespace openvdb::tools;
    const auto out = mask.deepCopy();
    // OpenVDB would voxelise every tile. Once the borders of tiles are leaves, it can ignore their inside.
    open_tile_borders(out->tree(), reach(voxels));
    if (voxels > 0) dilateActiveValues(out->tree(), voxels, NN_FACE_EDGE_VERTEX, IGNORE_TILES);
    if (voxels < 0) erodeActiveValues(out->tree(), -voxels, NN_FACE_EDGE_VERTEX, IGNORE_TILES);
    prune(out->tree());
    out->setName((voxels < 0 ? "erosion of " : "dilation of ") + mask.getName());
    return out;
}

NodeType mask_dilate() {
    return Declare<MaskDilate>("mask.dilate", "Grows or shrinks a mask: for example a margin around what must be spared.")
        .input("mask", &MaskDilate::Ports::mask, "A mask.")
        .required("voxels", &MaskDilate::Params::voxels, Unit::voxels, between(-256, 256),
                  "Distance along each axis and diagonal. Above 0 the mask grows, below 0 it shrinks.")
        .output("mask", &MaskDilate::Ports::dilated, "The mask, grown or shrunk.")
        .kept()
        .in_place();
}

}  // namespace fluidcarve
