#pragma once

#include "carve/remap/geometry/points.h"
#include "carve/remap/grid.h"
#include "formats/points_file/points_file.h"
#include "nodes/remap.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/point_lists.h"
#include "tests/support/reference_carve.h"
#include "tests/support/wavy_seams.h"

#include <tbb/task_arena.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::BBoxd;
using openvdb::Vec2d;
using openvdb::Vec3d;
using Kind = Seams::Kind;

inline CarvedPoints carve(const std::vector<Vec3d>& positions, const Lattice& lattice,
                          const CarveMap& map, double jitter = 0) {
    return carve_points(positions, points_at(positions).identities(), lattice, map, jitter);
}

inline const Lattice points_box = make_box(Vec3d(0), {30, 12, 14}, 1.0, {0, 1, 2});
