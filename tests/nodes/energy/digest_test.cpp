#include "carve/energy/combine.h"
#include "carve/energy/remap.h"
#include "carve/energy/surface.h"
#include "carve/energy/volume.h"
#include "carve/lattice/lattice.h"
#include "carve/volume/volume.h"
#include "nodes/catalogue.h"
#include "nodes/energy.h"
#include "nodes/lattice.h"
#include "nodes/params/term_ranges.h"
#include "nodes/payload/active_box.h"
#include "tests/support/node_bench.h"

#include <catch2/catch.hpp>

#include <sstream>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// What nodes that gather keep of a frame.

namespace {

const Registry& registry() {
    static const auto out = builtin_registry();
    return out;
}

std::string bytes_of(const Payload& payload) {
    std::ostringstream out;
    registry().payload(payload.type()).write(payload, out);
    return out.str();
}

/// To a file and back.
Payload filed(const Payload& payload) {
    const auto bytes = bytes_of(payload);
    std::istringstream in(bytes);
    const auto& type = registry().payload(payload.type());
    auto out = type.read(in);
    CHECK(in.peek() == std::istringstream::traits_type::eof());
    CHECK((bytes_of(out) == bytes));
    std::istringstream cut(bytes.substr(0, bytes.size() - 1));
    CHECK_THROWS_AS(type.read(cut), Failure);
    return out;
}

FloatGrid::Ptr ramp(float low, float high) {
    const auto out = FloatGrid::create();
    out->setName("density");
    out->tree().setValueOn(Coord(0, 1, 2), low);
    out->tree().setValueOn(Coord(5, 1, 3), high);
    return out;
}

Payload number(const FloatGrid::Ptr& grid) { return Payload(Ref<FloatGrid>(grid)); }
Payload any(const FloatGrid::Ptr& grid) {
    return Payload(std::make_shared<AnyGrid>(AnyGrid{grid}));
}

}  // namespace

TEST_CASE("all that is declared worth keeping can be kept, and what a digest depends on is there") {
    for (const auto& name : registry().node_names()) {
        INFO(name);
        const auto& node = *registry().node(name);
        if (node.kept)
            for (const auto& output : node.outputs) CHECK(registry().payload(output.type).write);
        if (node.digest == typeid(void)) continue;
        CHECK(registry().payload(node.digest).write);
        CHECK_FALSE(node.digest_fields.empty());
        for (const auto& field : node.digest_fields)
            CHECK((node.input(field) || node.param(field)));
    }
}

TEST_CASE("an automatic range needs of a frame its ends, from a file as from the frame") {
    struct Combined {
        std::string range;
        std::size_t finite;
    };
    for (const auto& [range, finite] : {Combined{"auto", 2}, Combined{"[[0, 10], auto]", 1}}) {
        NodeBench fresh(energy_combine(), "{range: " + range + "}", {{"terms", 2}}),
            again(energy_combine(), "{range: " + range + "}", {{"terms", 2}});
        NodeBench::Inputs inputs;
        for (const float low : {0.1f, -3.0f}) {
            inputs = {{"terms", {number(ramp(low, 1.0f / 3)), number(ramp(2 * low, 7))}}};
            const auto digest = fresh.digest(inputs);
            const auto& each = digest.as<FrameRanges>()->each;
            REQUIRE(each.size() == 2);
            CHECK(each[1].low == 2 * low);
            CHECK(each[1].high == 7);
            CHECK(static_cast<std::size_t>(std::isfinite(each[0].low) +
                                           std::isfinite(each[1].low)) == finite);
            fresh.add_digest(digest);
            again.add_digest(filed(digest));
        }
        fresh.finish();
        again.finish();
        const auto want = fresh.run(inputs).at("energy").as<FloatGrid>(),
                   got = again.run(inputs).at("energy").as<FloatGrid>();
        for (const auto& at : {Coord(0, 1, 2), Coord(5, 1, 3), Coord(9)})
            CHECK(got->tree().getValue(at) == want->tree().getValue(at));
    }
    // Nothing active: no range, which is none of finite numbers.
    const auto none =
        filed(NodeBench(energy_remap(), "{}").digest({{"energy", {number(FloatGrid::create())}}}));
    CHECK(none.as<FrameRanges>()->each.at(0).low > none.as<FrameRanges>()->each.at(0).high);
}

TEST_CASE("the range of an energy's terms depends on no weight") {
    const auto surface = ramp(0.5f, 2);
    surface->setGridClass(openvdb::GRID_LEVEL_SET);
    const auto of = [&](const std::string& yaml) {
        return bytes_of(NodeBench(energy_surface(), yaml).digest({{"surface", {number(surface)}}}));
    };
    CHECK((of("{}") == of("{curvature: 3}")));
    const auto volume = [&](const std::string& yaml) {
        return bytes_of(NodeBench(energy_volume(), yaml, {{"fields", 1}})
                            .digest({{"fields", {number(surface)}}}));
    };
    CHECK((volume("{}") == volume("{gradient: 3}")));
    const auto remap = [&](const std::string& yaml) {
        return bytes_of(NodeBench(energy_remap(), yaml).digest({{"energy", {number(surface)}}}));
    };
    CHECK((remap("{}") == remap("{to: [2, 5], invert: true}")));
}

TEST_CASE("a fitted box needs of a frame where its grid is, from a file as from the frame") {
    NodeBench fresh(lattice_box(), "{axes: zxy}", {{"fit", 1}}),
        again(lattice_box(), "{axes: xyz}", {{"fit", 1}}), empty(lattice_box(), "{}", {{"fit", 1}});
    const auto grid = ramp(1, 2);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(1.0 / 3));
    grid->transform().postTranslate(Vec3d(0.1, 0.2, 0.3));
    const auto digest = fresh.digest({{"fit", {any(grid)}}});
    CHECK((bytes_of(again.digest({{"fit", {any(grid)}}})) == bytes_of(digest)));
    const auto back = filed(digest).as<ActiveBox>();
    CHECK(back->name == "density");
    CHECK(back->voxels == CoordBBox(Coord(0, 1, 2), Coord(5, 1, 3)));
    CHECK(*back->transform == grid->transform());
    fresh.add_digest(filed(digest));
    CHECK(fresh.gathered({}).at("lattice").as<Lattice>()->shape == std::array{2, 6, 1});

    empty.add_digest(filed(empty.digest({{"fit", {any(FloatGrid::create())}}})));
    CHECK(failure_of([&] { empty.gathered({}); }) ==
          "the grid to fit has no active voxels in any frame; state 'min', 'max' and 'spacing' "
          "instead");
}

TEST_CASE("a transform of any kind goes to a file and comes back") {
    const auto turned = openvdb::math::Transform::createLinearTransform(0.1);
    turned->preRotate(0.3, openvdb::math::Y_AXIS);
    for (const auto& transform : {turned, openvdb::math::Transform::createFrustumTransform(
                                              openvdb::BBoxd(Vec3d(0), Vec3d(10)), 0.5, 2, 0.25)}) {
        const ActiveBox box{"a", transform, CoordBBox(Coord(-1), Coord(1))};
        CHECK(*filed(Payload(std::make_shared<ActiveBox>(box))).as<ActiveBox>()->transform ==
              *transform);
    }
}
