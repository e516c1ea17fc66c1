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

inline FloatGrid::Ptr dense_grid(const CoordBBox& box,
                                 const openvdb::math::Transform::Ptr& transform,
                                 const std::function<float(const Coord&)>& value) {
    const auto out = FloatGrid::create();
    out->setTransform(transform);
    auto values = out->getAccessor();
    for (auto at = box.begin(); at; ++at) values.setValueOn(*at, value(*at));
    return out;
}
