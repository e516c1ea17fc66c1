#include "nodes/payload/picked_grid.h"
#include "carve/grid/named_grids.h"
#include "carve/volume/volume.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/payload/add_payloads.h"
#include "nodes/remap.h"
#include "nodes/vdb.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using test::failure_of;
using test::NodeBench;

namespace {

openvdb::GridBase::ConstPtr numbers(const std::string& name, float value) {
    const auto out = FloatGrid::create();
    out->setName(name);
    out->tree().setValue({1, 2, 3}, value);
    return out;
}

/// `density`, a `velocity` of vectors, and a `vel` in three parts.
Volume volume() {
    const auto velocity = VectorGrid::create();
    velocity->setName("velocity");
    velocity->tree().setValue({1, 2, 3}, {4, 5, 6});
    return {{numbers("density", 7), velocity, numbers("vel.x", 1), numbers("vel.y", 2),
             numbers("vel.z", 3)},
            {},
            {}};
}

/// What an input of a type gets of `carved.NAME`.
template <class T>
Ref<T> pick(const std::string& name) {
    Registry registry;
    add_grid_payloads(registry);
    return registry.selection(typeid(Volume), typeid(T))
        ->pick(Payload(std::make_shared<Volume>(volume())), name)
        .template as<T>();
}

}  // namespace

TEST_CASE("an input takes one grid of a volume by its name, as it wants it") {
    CHECK(pick<FloatGrid>("density")->tree().getValue({1, 2, 3}) == 7);
    CHECK(pick<FloatGrid>("vel.y")->tree().getValue({1, 2, 3}) == 2);
    CHECK(pick<VectorGrid>("velocity")->tree().getValue({1, 2, 3}) == openvdb::Vec3s(4, 5, 6));
    CHECK(pick<VectorGrid>("vel")->tree().getValue({1, 2, 3}) == openvdb::Vec3s(1, 2, 3));
    CHECK(pick<AnyGrid>("density")->grid->isType<FloatGrid>());
    CHECK(pick<AnyGrid>("vel")->grid->isType<VectorGrid>());
    CHECK(pick<Volume>("density")->names() == "density");
    CHECK(pick<Volume>("vel")->names() == "vel.x, vel.y, vel.z");
}

TEST_CASE("a grid that is not there, or of another type, is told with those that are") {
    CHECK(failure_of([] { pick<FloatGrid>("densty"); }) ==
          "has no grid 'densty'; it has density, velocity, vel.x, vel.y, vel.z; did you mean "
          "'density'?");
    CHECK(failure_of([] { pick<Volume>("heat"); }) ==
          "has no grid 'heat'; it has density, velocity, vel.x, vel.y, vel.z");
    CHECK(failure_of([] { pick<FloatGrid>("velocity"); }) ==
          "has the grid 'velocity' as vec3s, not as float");
    CHECK(failure_of([] { pick<VectorGrid>("density"); }) ==
          "has the grid 'density' as float, not as vec3s");
    CHECK(lacks_grid("a", {}) == "has no grid 'a'; it has none");
}

TEST_CASE("a reader finds in its headers what other nodes take of its volume") {
    const Scratch scratch;
    write_vdb(scratch / "a.1.vdb", volume());
    const auto path = scratch / "a.1.vdb";
    const NodeBench reader(vdb_read(), "{path: " + path + "}");
    const auto told = [&](const std::string& name, std::type_index type) {
        const auto absent =
            reader.survey({1}, {}, {{name, type, "'slope' takes carved." + name}}).absent;
        return absent.empty() ? std::string() : absent.at(1);
    };
    for (const auto* const name : {"density", "vel.x"}) CHECK(told(name, typeid(FloatGrid)) == "");
    for (const auto* const name : {"velocity", "vel"}) CHECK(told(name, typeid(VectorGrid)) == "");
    for (const auto* const name : {"density", "velocity", "vel"})
        CHECK(told(name, typeid(AnyGrid)) == "");
    CHECK(told("densty", typeid(FloatGrid)) ==
          path +
              " has no grid 'densty', but 'slope' takes carved.densty; it has density, velocity, "
              "vel.x, vel.y, vel.z; did you mean 'density'?");
    CHECK(told("velocity", typeid(FloatGrid)) ==
          path + " has the grid 'velocity' as vec3s, but 'slope' takes carved.velocity as float");
    CHECK(told("vel", typeid(FloatGrid)) ==
          path + " has the grid 'vel' as vec3s, but 'slope' takes carved.vel as float");
    CHECK(told("density", typeid(VectorGrid)) ==
          path + " has the grid 'density' as float, but 'slope' takes carved.density as vec3s");
    CHECK(remap_grids().names_from == "source");
}
