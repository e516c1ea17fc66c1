#include "formats/usd/fields.h"

#include "carve/volume/triplet.h"
#include "tests/support/failure_of.h"

#include <fmt/format.h>
#include <openvdb/points/PointDataGrid.h>

#include <catch2/catch.hpp>

using namespace fluidcarve;
using openvdb::Vec3d;

namespace {

template <class Grid>
typename Grid::Ptr named(const std::string& name,
                         openvdb::GridClass grid_class = openvdb::GRID_UNKNOWN) {
    const auto out = Grid::create();
    out->setName(name);
    out->setGridClass(grid_class);
    return out;
}

/// "name[index] type class role", a line each.
std::string text_of(const UsdFields& fields) {
    std::string out;
    for (const auto& [name, index, type, grid_class, role] : fields.fields)
        out += fmt::format("{}[{}] {} {} {}\n", name, index, type, grid_class, role);
    return out;
}

}  // namespace

TEST_CASE("grids become fields by their names, types, classes and roles") {
    const auto half = named<openvdb::FloatGrid>("density", openvdb::GRID_FOG_VOLUME);
    half->setSaveFloatAsHalf(true);
    const auto half_vectors = named<openvdb::Vec3SGrid>("velocity", openvdb::GRID_STAGGERED);
    half_vectors->setSaveFloatAsHalf(true);
    half_vectors->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
    const auto normals = named<openvdb::Vec3DGrid>("n");
    normals->setVectorType(openvdb::VEC_COVARIANT);
    const auto whole = named<openvdb::Int32Grid>("id");
    whole->setSaveFloatAsHalf(true);
    Volume volume;
    volume.grids = {half,
                    half_vectors,
                    normals,
                    named<openvdb::FloatGrid>("surface", openvdb::GRID_LEVEL_SET),
                    named<openvdb::DoubleGrid>("density"),
                    named<openvdb::MaskGrid>("inside"),
                    named<openvdb::BoolGrid>("on"),
                    whole,
                    named<openvdb::Int64Grid>("long"),
                    named<openvdb::points::PointDataGrid>("particles"),
                    named<openvdb::Vec3IGrid>("cells")};
    const auto fields = usd_fields(volume, nullptr);
    CHECK(text_of(fields) ==
          "density[0] half fogVolume \n"
          "velocity[0] half3 staggered Vector\n"
          "n[0] double3 unknown Normal\n"
          "surface[0] float levelSet \n"
          "density[1] double unknown \n"
          "inside[0] mask unknown \n"
          "on[0] bool unknown \n"
          "id[0] int unknown \n"
          "long[0] int64 unknown \n"
          "cells[0] int3 unknown None\n");
    CHECK(fields.left_out == std::vector<std::string>{"particles"});
    CHECK(fields.placement == Placement{});
}

TEST_CASE("a velocity that was merged from three grids is three fields, as in its file") {
    std::array<FloatGrid::ConstPtr, 3> components;
    for (std::size_t c = 0; c < 3; ++c) components[c] = named<FloatGrid>(triplet_names("vel")[c]);
    Volume volume;
    volume.grids = {merged(make_triplet("vel", components))};
    CHECK(text_of(usd_fields(volume, nullptr)) ==
          "vel.x[0] float unknown \nvel.y[0] float unknown \nvel.z[0] float unknown \n");
}

TEST_CASE("fields stand where their reader placed them, or where the writer is told") {
    const Placement moved{Vec3d(1, 2, 3), 2}, other{Vec3d(4, 5, 6), 1};
    Volume volume;
    volume.grids = {placed(named<FloatGrid>("density"), moved),
                    placed(named<VectorGrid>("velocity"), moved)};
    CHECK(usd_fields(volume, nullptr).placement == moved);
    CHECK(usd_fields(volume, &other).placement == other);

    // What is left out has no say.
    const Placement half_off{Vec3d(1, 2, 3), 1, Vec3d(-0.5)};
    volume.grids.push_back(placed(named<openvdb::points::PointDataGrid>("particles"), half_off));
    CHECK(usd_fields(volume, nullptr).placement == moved);

    volume.grids.push_back(named<FloatGrid>("made"));
    CHECK(test::failure_of([&] { usd_fields(volume, nullptr); }) ==
          "grids 'density' and 'made' have different placements, and a USD volume has one: write "
          "them to two files by two vdb.write");
    CHECK(usd_fields(volume, &other).placement == other);
}
