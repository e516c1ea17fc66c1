#include "carve/time/between.h"

#include "carve/time/frame_list.h"
#include "carve/time/motion.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/scratch.h"

#include <openvdb/tools/LevelSetSphere.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::Vec3d;
using openvdb::Vec3s;

namespace {

constexpr double spacing = 0.1;  ///< of voxels, world units

/// A Gaussian around a place, voxels.
FloatGrid::Ptr puff(const Vec3d& around, float height = 1) {
    const auto out = FloatGrid::create();
    out->setName("density");
    out->setTransform(openvdb::math::Transform::createLinearTransform(spacing));
    for (const auto& at : openvdb::CoordBBox(Coord(-15), Coord(25)))
        if (const auto value = height * std::exp(-0.5 * (at.asVec3d() - around).lengthSqr() / 9);
            value > 1e-4)
            out->tree().setValue(at, static_cast<float>(value));
    return out;
}

Vec3d centre(const FloatGrid& grid) {
    Vec3d sum(0);
    double all = 0;
    for (auto value = grid.cbeginValueOn(); value; ++value) {
        sum += *value * value.getCoord().asVec3d();
        all += *value;
    }
    return sum / all;
}

double sum_of_values(const FloatGrid& grid) {
    double out = 0;
    for (auto value = grid.cbeginValueOn(); value; ++value) out += *value;
    return out;
}

Volume volume_with(const std::vector<openvdb::GridBase::ConstPtr>& grids) {
    Volume out;
    out.grids.assign(grids.begin(), grids.end());
    return out;
}

FloatGrid::ConstPtr density_of(const Volume& volume) {
    return openvdb::gridConstPtrCast<FloatGrid>(volume.find("density"));
}

}  // namespace

TEST_CASE(
    "a puff that moves is where it should be between its frames, with its height and width, seen "
    "or told by a velocity") {
    const Vec3d by(4, -2.5, 1);
    const auto a = puff(Vec3d(0)), b = puff(by);
    const auto velocity = VectorGrid::create(Vec3s(by));
    velocity->setTransform(a->transformPtr());
    for (const auto& told : {VectorGrid::ConstPtr(), VectorGrid::ConstPtr(velocity)}) {
        const auto motion = motion_between({a, told}, {b, told}, spacing, ~std::uint64_t{0});
        for (const double share : {0.25, 0.5, 0.75})
            for (const auto transport : {Transport::semi_lagrangian, Transport::mac_cormack}) {
                const auto out = density_of(volume_between(volume_with({a}), volume_with({b}),
                                                           share, motion.get(), transport));
                CHECK((centre(*out) - share * by).length() < 0.05);
                CHECK(sum_of_values(*out) == Approx(sum_of_values(*a)).epsilon(0.01));
                float highest = 0;
                for (auto value = out->cbeginValueOn(); value; ++value)
                    highest = std::max(highest, *value);
                CHECK(highest == Approx(1).margin(0.08));
            }
    }
}

TEST_CASE("the right scale of a velocity makes the least mismatch") {
    const auto a = puff(Vec3d(0)), b = puff(Vec3d(3, 0, 0));
    const auto velocity = VectorGrid::create(Vec3s(7, 0, 0));
    velocity->setTransform(a->transformPtr());
    const auto error = [&](double voxels) {
        return mismatch({a, velocity}, {b, velocity}, voxels * spacing / 7, ~std::uint64_t{0});
    };
    for (const double wrong : {0.0, 1.5, 2.5, 3.5, 5.0}) CHECK(error(wrong) > 2 * error(3));
    CHECK(typical_speed({a, velocity}) == Approx(7));
}

TEST_CASE("mass between frames lies between theirs, and a grid that only one frame has fades") {
    const auto small = puff(Vec3d(0)), large = puff(Vec3d(2, 0, 0), 2);
    const auto motion = motion_between({small, nullptr}, {large, nullptr}, 0, ~std::uint64_t{0});
    const auto out = volume_between(volume_with({small}), volume_with({large}), 0.5, motion.get(),
                                    Transport::semi_lagrangian);
    CHECK(sum_of_values(*density_of(out)) == Approx(1.5 * sum_of_values(*small)).epsilon(1e-3));
    const auto fading = volume_between(volume_with({small}), volume_with({}), 0.25, nullptr,
                                       Transport::semi_lagrangian);
    CHECK(sum_of_values(*density_of(fading)) == Approx(0.75 * sum_of_values(*small)).epsilon(1e-4));
    CHECK(volume_between(volume_with({small}), volume_with({}), 0.75, nullptr,
                         Transport::semi_lagrangian)
              .grids.empty());
}

TEST_CASE("frames with voxels of other sizes have their mass between them, too") {
    const auto fine = puff(Vec3d(0));
    const auto coarse = FloatGrid::create();
    coarse->setName("density");
    coarse->setTransform(openvdb::math::Transform::createLinearTransform(1.25 * spacing));
    for (const auto& at : openvdb::CoordBBox(Coord(-12), Coord(12)))
        if (const auto value = std::exp(-0.5 * (1.25 * at.asVec3d()).lengthSqr() / 9); value > 1e-4)
            coarse->tree().setValue(at, static_cast<float>(value));
    const auto out = volume_between(volume_with({fine}), volume_with({coarse}), 0.5, nullptr,
                                    Transport::semi_lagrangian);
    CHECK(sum_of_values(*density_of(out)) == Approx(sum_of_values(*fine)).epsilon(0.01));
}

TEST_CASE("a level set that only one frame has is there in its half of the way, and whole") {
    const auto ball = openvdb::tools::createLevelSetSphere<FloatGrid>(1.0f, openvdb::Vec3f(0),
                                                                      static_cast<float>(spacing));
    const auto at = [&](double share, bool first) {
        const auto some = volume_with({ball}), none = volume_with({});
        const ShareAt everywhere = [=](const Vec3d&) { return share; };
        const auto out = volume_between(first ? some : none, first ? none : some, everywhere, some,
                                        nullptr, Transport::semi_lagrangian);
        return openvdb::gridConstPtrCast<FloatGrid>(out.grids.front().grid())
            ->tree()
            .getValue(Coord(0));
    };
    for (const double share : {0.0, 0.4}) {
        CHECK(at(share, true) == -ball->background());
        CHECK(at(share, false) == ball->background());
    }
    for (const double share : {0.6, 1.0}) {
        CHECK(at(share, true) == ball->background());
        CHECK(at(share, false) == -ball->background());
    }
}

TEST_CASE("a huge value spoils no motion") {
    const auto from = puff(Vec3d(0)), to = puff(Vec3d(2, 0, 0));
    const auto broken = from->deepCopy();
    broken->tree().setValue(Coord(8, 8, 8), 1e30f);
    const auto motion = motion_between({broken, nullptr}, {to, nullptr}, 0, ~std::uint64_t{0});
    for (auto value = motion->cbeginValueOn(); value; ++value)
        CHECK(openvdb::math::isFinite(*value));
}

TEST_CASE(
    "a level set between two frames is a distance, and whole numbers are those of the nearer "
    "frame") {
    const auto sphere = [](float x) {
        auto out = openvdb::tools::createLevelSetSphere<FloatGrid>(1.0f, openvdb::Vec3f(x, 0, 0),
                                                                   static_cast<float>(spacing));
        out->setName("surface");
        return out;
    };
    const auto a = sphere(0), b = sphere(0.3f);
    const auto motion = motion_between({a, nullptr}, {b, nullptr}, 0, ~std::uint64_t{0});
    auto ids = openvdb::Int32Grid::create(), later = openvdb::Int32Grid::create();
    ids->setName("id");
    later->setName("id");
    later->tree().setValue(Coord(0), 7);
    const auto out = volume_between(volume_with({a, ids}), volume_with({b, later}), 0.5,
                                    motion.get(), Transport::semi_lagrangian);
    const auto surface = openvdb::gridConstPtrCast<FloatGrid>(out.find("surface"));
    CHECK(surface->getGridClass() == openvdb::GRID_LEVEL_SET);
    double worst = 0;
    for (auto value = surface->cbeginValueOn(); value; ++value) {
        const double distance =
            (surface->indexToWorld(value.getCoord()) - Vec3d(0.15, 0, 0)).length() - 1;
        if (std::abs(distance) < 2 * spacing) worst = std::max(worst, std::abs(*value - distance));
    }
    CHECK(worst < 0.25 * spacing);
    CHECK(
        openvdb::gridConstPtrCast<openvdb::Int32Grid>(out.find("id"))->tree().getValue(Coord(0)) ==
        7);
}

TEST_CASE("values that are not finite show no motion, and the others move as without them") {
    const auto from = puff(Vec3d(0)), to = puff(Vec3d(2, 0, 0));
    const auto broken = from->deepCopy();
    broken->tree().setValue(Coord(8, 8, 8), std::numeric_limits<float>::quiet_NaN());
    broken->tree().setValue(Coord(-8, 8, 8), std::numeric_limits<float>::infinity());
    const auto motion = motion_between({broken, nullptr}, {to, nullptr}, 0, ~std::uint64_t{0});
    const auto half = density_of(volume_between(volume_with({from}), volume_with({to}), 0.5,
                                                motion.get(), Transport::semi_lagrangian));
    CHECK((centre(*half) - Vec3d(1, 0, 0)).length() < 0.1);
}

TEST_CASE("velocities are scaled by their name") {
    const auto fast = VectorGrid::create(Vec3s(0, 0, 1));
    fast->setName("vel");
    fast->tree().setValue(Coord(1), Vec3s(2, 4, -6));
    const auto out = velocities_scaled(volume_with({puff(Vec3d(0)), fast}), "vel", -0.5);
    const auto slow = openvdb::gridConstPtrCast<VectorGrid>(out.find("vel"));
    CHECK(slow->tree().getValue(Coord(1)) == Vec3s(-1, -2, 3));
    CHECK(slow->background() == Vec3s(0, 0, -0.5f));
    CHECK(fast->tree().getValue(Coord(1)) == Vec3s(2, 4, -6));
}

TEST_CASE("volumes beyond the memory come back from a file bit for bit") {
    const Scratch scratch;
    FrameList<Volume> held({}), filed({0, scratch / "work"});
    for (int n = 0; n < 5; ++n) {
        auto volume = std::make_shared<Volume>(
            volume_with({puff(Vec3d(n, 0, 0)), openvdb::Int32Grid::create(n)}));
        volume->metadata.insertMeta("take", openvdb::Int32Metadata(n));
        held.add(volume);
        filed.add(volume);
    }
    CHECK(std::filesystem::is_empty(scratch / "work"));
    for (const std::size_t n : {4U, 0U, 2U}) {
        const auto a = held.at(n), b = filed.at(n);
        REQUIRE(a->grids.size() == b->grids.size());
        for (std::size_t g = 0; g < a->grids.size(); ++g)
            CHECK(test::difference(*a->grids[g].grid(), *b->grids[g].grid()) == "");
        CHECK(b->metadata.metaValue<std::int32_t>("take") == static_cast<int>(n));
    }
}

namespace {

/// A picture of 40 x 30 pixels with one bright spot on grey.
VolumeGrid picture_of(double x, double y) {
    const auto header = FloatGrid::create(0);
    header->setName("R");
    const openvdb::CoordBBox box(openvdb::Coord(0), openvdb::Coord(39, 29, 0));
    const auto values = std::make_shared<std::vector<float>>();
    for (int row = 0; row < 30; ++row)
        for (int column = 0; column < 40; ++column)
            values->push_back(static_cast<float>(
                0.3 + std::exp(-(std::pow(column - x, 2) + std::pow(row - y, 2)) / 8)));
    return {header,
            ChannelPixels{box, box, std::shared_ptr<const float>(values, values->data()), 1, 40}};
}

}  // namespace

TEST_CASE("what a picture shows moves in its plane, and nothing comes in from beyond its rim") {
    Volume from, to;
    from.grids.push_back(picture_of(14, 12));
    to.grids.push_back(picture_of(18, 15));
    const auto shown = [](const Volume& volume) {
        return openvdb::gridConstPtrCast<FloatGrid>(volume.grids[0].grid());
    };
    const auto motion =
        motion_between({shown(from), nullptr}, {shown(to), nullptr}, 0, ~std::uint64_t{0});
    for (const double share : {0.25, 0.5}) {
        const auto between =
            volume_between(from, to, share, motion.get(), Transport::semi_lagrangian);
        REQUIRE(between.grids[0].pixels());
        const auto there = picture_of(14 + 4 * share, 12 + 3 * share);
        double worst = 0;
        for (int y = 0; y < 30; ++y)
            for (int x = 0; x < 40; ++x)
                worst = std::max(worst, std::abs(double(between.grids[0].pixels()->at(x, y)) -
                                                 there.pixels()->at(x, y)));
        CHECK(worst < 0.06);
    }
}

TEST_CASE("a picture of two is of each where it alone shows, bit for bit") {
    Volume a, b;
    a.grids.push_back(picture_of(14, 12));
    b.grids.push_back(picture_of(18, 15));
    const auto mixed = volume_mixed(
        a, b, [](const Vec3d& at) { return at.x() < 10   ? 0.0
                                           : at.x() > 20 ? 1.0
                                                         : 0.5; }, a);
    const auto* const plane = mixed.grids[0].pixels();
    REQUIRE(plane);
    CHECK(plane->at(3, 12) == a.grids[0].pixels()->at(3, 12));
    CHECK(plane->at(21, 15) == b.grids[0].pixels()->at(21, 15));
    CHECK(plane->at(15, 13) ==
          Approx(0.5 * (a.grids[0].pixels()->at(15, 13) + b.grids[0].pixels()->at(15, 13))));
}

TEST_CASE(
    "of two level sets each place has the side that it shows, beyond their narrow bands, too") {
    const auto ball = [](double x) {
        const auto out = openvdb::tools::createLevelSetSphere<FloatGrid>(8, Vec3d(x, 0, 0), 1, 3);
        out->setName("surface");
        return volume_with({out});
    };
    const auto a = ball(-12), b = ball(12);
    const auto value = [](const Volume& volume, int x) {
        return openvdb::gridConstPtrCast<FloatGrid>(volume.find("surface"))
            ->tree()
            .getValue(Coord(x, 0, 0));
    };
    const auto both = volume_mixed(
        a, b, [](const Vec3d& at) { return at.x() < 0 ? 0.0 : 1.0; }, a);
    const auto none = volume_mixed(
        a, b, [](const Vec3d& at) { return at.x() < 0 ? 1.0 : 0.0; }, a);
    for (const int x : {-12, 12}) {
        CHECK(value(both, x) == -3);
        CHECK(value(none, x) == 3);
    }
    for (const int x : {-4, 4, -20, 20}) CHECK(value(both, x) == Approx(0).margin(1e-5));
    CHECK(value(both, 0) == 3);
}

TEST_CASE("a level set that is no distance does not move when it is blended with itself") {
    const auto ball = openvdb::tools::createLevelSetSphere<FloatGrid>(4, Vec3d(0), 0.5);
    for (auto value = ball->beginValueOn(); value; ++value) value.setValue(0.7f * *value);
    ball->setName("surface");
    const auto volume = volume_with({ball});
    const auto out = volume_between(volume, volume, 0.4, nullptr, Transport::semi_lagrangian);
    const auto same = openvdb::gridConstPtrCast<FloatGrid>(out.find("surface"));
    for (auto value = ball->cbeginValueOn(); value; ++value)
        REQUIRE(same->tree().getValue(value.getCoord()) == Approx(*value).margin(1e-5));
}
