#include "carve/lattice/lattice.h"
#include "carve/mesh/mesh.h"
#include "carve/points/points.h"
#include "carve/rig/rig.h"
#include "carve/volume/volume.h"
#include "graph/types/plugin.h"
#include "nodes/solving/seam_node.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

// Where a size here changes, plugins that were built before read something else than the program
// wrote: raise payload_abi with it.
TEST_CASE("payload types are laid out as the number that plugins are checked against says") {
    CHECK(payload_abi == 13);
    CHECK(sizeof(Volume) == 112);
    CHECK(sizeof(VolumeGrid) == 32);
    CHECK(sizeof(AnyGrid) == 16);
    CHECK(sizeof(Lattice) == 120);
    CHECK(sizeof(Rig) == 144);
    CHECK(sizeof(Points) == 176);
    CHECK(sizeof(Mesh) == 112);
    CHECK(sizeof(Seams) == 336);
    CHECK(sizeof(Seams::Seam) == 56);
    CHECK(sizeof(SeamNode::Params) == 176);
    CHECK(sizeof(SeamNode) == 784);
}
