#pragma once

#include "carve/lattice/alignment.h"
#include "carve/lattice/lattice.h"
#include "carve/remap/grid.h"
#include "carve/stream/raw_grid.h"
#include "nodes/remap.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"
#include "tests/support/warped.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

inline CarveMap map_of_count(const Lattice& lattice, const Seams& seams,
                             std::optional<std::size_t> count = {}) {
    return {lattice, {std::make_shared<Seams>(seams)}, seams.frames.front(), count};
}
