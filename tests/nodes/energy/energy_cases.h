#pragma once

#include "carve/energy/combine.h"
#include "carve/energy/gradient.h"
#include "carve/energy/kinetic.h"
#include "carve/energy/remap.h"
#include "carve/energy/volume.h"
#include "carve/energy/vorticity.h"
#include "carve/field/active_range.h"
#include "carve/field/collocate.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/energy.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/sampled.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using openvdb::Vec3s;
using test::failure_of;
using test::NodeBench;
using test::rotation;

inline Payload only(const std::map<std::string, Payload>& outputs) { return outputs.at("energy"); }

/// The values at x = 0 (background), 1 to 4, and in the tile.
inline std::vector<float> values(const FloatGrid& grid) {
    std::vector<float> out;
    for (const int x : {0, 1, 2, 3, 4, 70}) out.push_back(grid.tree().getValue({x, 0, 0}));
    return out;
}
