#pragma once

#include "tests/support/program.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <string>

// Sequences of VDB files: their paths, puffs of smoke for them, and how far two of them differ.

namespace fluidcarve::test {

/// @param stem  the path up to the frame's number
inline std::string file_at(const std::string& stem, int frame) {
    return fmt::format("{}.{:04}.vdb", stem, frame);
}

/// A puff around a place, voxels: a bell of density, 1 at its height.
inline openvdb::FloatGrid::Ptr puff_around(const openvdb::Vec3d& place) {
    openvdb::initialize();
    const auto out = openvdb::FloatGrid::create();
    out->setName("density");
    const auto low = openvdb::Coord::round(place).offsetBy(-9), high = low.offsetBy(18);
    for (auto at = openvdb::CoordBBox(low, high).begin(); at; ++at)
        if (const auto value = std::exp(-0.5 * ((*at).asVec3d() - place).lengthSqr() / 8);
            value > 1e-3)
            out->tree().setValue(*at, static_cast<float>(value));
    return out;
}

/// The density that a file holds.
inline openvdb::FloatGrid::Ptr density_in(const std::string& path) {
    openvdb::initialize();
    openvdb::io::File file(path);
    file.open(false);
    return openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("density"));
}

/// Summed over the voxels that are active in either grid.
inline double squared_difference(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
    double out = 0;
    for (auto value = a.cbeginValueOn(); value; ++value)
        out += std::pow(*value - b.tree().getValue(value.getCoord()), 2);
    for (auto value = b.cbeginValueOn(); value; ++value)
        if (!a.tree().isValueOn(value.getCoord()))
            out += std::pow(*value - a.tree().getValue(value.getCoord()), 2);
    return out;
}

/// What `diff` says of two files or sequences; empty if they are equal.
inline std::string difference_of(const std::string& a, const std::string& b,
                                 const std::string& arguments = "") {
    const auto ran = fluidcarve_program(fmt::format("diff {} {} {}", a, b, arguments));
    return ran.code == 0 ? "" : ran.out + ran.err;
}

}  // namespace fluidcarve::test
