#include "carve/time/time_map.h"

#include "tests/support/bent_lattices.h"
#include "tests/support/node_bench.h"
#include "tests/support/seams_through.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

constexpr int frame_count = 7;
const CoordBBox cells(Coord(0), Coord(2, 3, 1));

Lattice voxels() { return make_box(openvdb::Vec3d(0), {3, 4, 2}, 1.0, {0, 1, 2}); }

std::vector<int> frame_numbers() {
    std::vector<int> out;
    for (int t = 0; t < frame_count; ++t) out.push_back(11 + t);
    return out;
}

float value_at(int t, const Coord& at) {
    return static_cast<float>(1 + 100 * t + 10 * at.x() + 3 * at.y() + at.z());
}

/// Frames in which each value tells its frame and its place.
void tell_frames(Sequence& out, const CoordBBox& box = cells) {
    for (int t = 0; t < frame_count; ++t) {
        const auto grid = FloatGrid::create();
        grid->setName("density");
        for (auto at = box.begin(); at; ++at) grid->tree().setValueOn(*at, value_at(t, *at));
        Volume volume;
        volume.grids.emplace_back(grid);
        out.add(volume, nullptr, frame_numbers()[static_cast<std::size_t>(t)], {});
    }
}

float value(const Volume& volume, const Coord& at) {
    return openvdb::gridConstPtrCast<FloatGrid>(volume.grids.front().grid())->tree().getValue(at);
}

Volume frame_of(const TimeMap& map, const Sequence& source, int n) {
    const Motions motions(source, 0, ~std::uint64_t{0});
    return map.frame(frame_source(source, motions), n);
}

Seams empty_set(Seams::Kind kind) { return no_seams(voxels(), Axis::t, kind, frame_numbers()); }

/// Any seams: entries that no neighbours share.
Seams random_set(std::mt19937& random, Seams out, int count) {
    std::vector<std::vector<std::uint16_t>> entries(static_cast<std::size_t>(count),
                                                    std::vector<std::uint16_t>(out.columns()));
    for (std::size_t c = 0; c < out.columns(); ++c) {
        std::vector<int> all;
        for (int t = 0; t < frame_count; ++t) all.push_back(t);
        std::ranges::shuffle(all, random);
        for (std::size_t n = 0; n < entries.size(); ++n) {
            // A removal counts what those before it leave.
            int entry = all[n];
            if (out.kind == Seams::Kind::remove)
                for (std::size_t m = 0; m < n; ++m)
                    if (all[m] < all[n]) --entry;
            entries[n][c] = static_cast<std::uint16_t>(entry);
        }
    }
    for (auto& each : entries) out.seams.push_back({std::move(each), 0.0});
    return out;
}

/// The frames of the source that a vertex shows, one after the other.
std::vector<int> shown_at(const Seams& set, const Coord& at) {
    std::vector<int> out;
    for (int t = 0; t < frame_count; ++t) out.push_back(t);
    const auto column =
        static_cast<std::size_t>(at.y() + set.shape[1] * (at.z() + set.shape[2] * at.x()));
    for (const auto& seam : set.seams) {
        const auto entry = seam.at[column];
        if (set.kind == Seams::Kind::remove) out.erase(out.begin() + entry);
        else out.insert(std::ranges::find(out, int{entry}) + 1, entry);
    }
    return out;
}

}  // namespace

TEST_CASE("a straight seam takes a frame out, or shows it twice, bit for bit") {
    Sequence source;
    tell_frames(source);
    for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert}) {
        auto set = empty_set(kind);
        set.seams.push_back(straight_seam(set, 3));
        const TimeMap map(set, voxels(), 1, TimeJoin{});
        CHECK(map.frames() == frame_count + growth(kind, 1));
        for (int n = 0; n < map.frames(); ++n) {
            const int wanted = kind == Seams::Kind::remove ? n + (n >= 3) : n - (n > 3);
            // The very same grid.
            CHECK(frame_of(map, source, n).grids.front().grid() ==
                  source.at(static_cast<std::size_t>(wanted)).volume.grids.front().grid());
        }
    }
}

TEST_CASE("without a fade each vertex shows the frames that its own entries leave") {
    std::mt19937 random(5);
    Sequence source;
    tell_frames(source);
    for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert}) {
        const auto set = random_set(random, empty_set(kind), 3);
        const TimeMap map(set, voxels(), 3, TimeJoin{});
        for (int n = 0; n < map.frames(); ++n) {
            const auto frame = frame_of(map, source, n);
            for (auto at = cells.begin(); at; ++at) {
                const int wanted = shown_at(set, *at).at(static_cast<std::size_t>(n));
                CHECK(value(frame, *at) == value_at(wanted, *at));
            }
        }
    }
}

TEST_CASE("in a closed lattice along a path each vertex shows its own frames, too") {
    std::mt19937 random(6);
    const auto lattice = ring(openvdb::Vec3d(0), {3, 4, 9}, 2, {-2, -3});
    const auto space = openvdb::math::Transform::createLinearTransform(0.1);
    const CoordBBox vertices(Coord(0), Coord(2, 3, 8));
    const auto voxel_at = [&](const Coord& vertex) {
        return Coord::round(space->worldToIndex(lattice.position(vertex.asVec3d())));
    };
    Sequence source;
    for (int t = 0; t < frame_count; ++t) {
        const auto grid = FloatGrid::create();
        grid->setName("density");
        grid->setTransform(space);
        for (auto at = vertices.begin(); at; ++at)
            grid->tree().setValue(voxel_at(*at), value_at(t, *at));
        Volume volume;
        volume.grids.emplace_back(grid);
        source.add(volume, nullptr, frame_numbers()[static_cast<std::size_t>(t)], {});
    }
    const auto set =
        random_set(random, no_seams(lattice, Axis::t, Seams::Kind::remove, frame_numbers()), 3);
    const TimeMap map(set, lattice, 3, TimeJoin{});
    for (int n = 0; n < map.frames(); ++n) {
        const auto frame = frame_of(map, source, n);
        // Voxels of vertices at the rim may lie outside.
        for (auto at = CoordBBox(Coord(1, 1, 0), Coord(1, 2, 8)).begin(); at; ++at)
            CHECK(value(frame, voxel_at(*at)) ==
                  value_at(shown_at(set, *at).at(static_cast<std::size_t>(n)), *at));
    }
}

TEST_CASE("a fade goes over in a few frames, and all others keep their bits") {
    Sequence source;
    tell_frames(source);
    auto set = empty_set(Seams::Kind::remove);
    set.seams.push_back(straight_seam(set, 3));
    const TimeMap map(set, voxels(), 1, {2, false});
    const Coord at(1, 2, 1);
    // Shares of the frame behind: a quarter before the seam, three quarters behind it.
    const auto share = [&](int n) {
        return (value(frame_of(map, source, n), at) - value_at(n, at)) / 100;
    };
    CHECK(share(1) == 0);
    CHECK(share(2) == Approx(0.25));
    CHECK(share(3) == Approx(0.75));
    CHECK(share(4) == 1);
}

TEST_CASE("what moves goes over by the moments between, and keeps its height") {
    Sequence source;
    const auto box = make_box(openvdb::Vec3d(-6), {7, 4, 4}, 4.0, {0, 1, 2});
    auto set = no_seams(box, Axis::t, Seams::Kind::remove, frame_numbers());
    set.seams.push_back(straight_seam(set, 3));
    constexpr double speed = 2;  // voxels per frame
    for (const int frame : frame_numbers()) {
        const auto grid = FloatGrid::create();
        grid->setName("density");
        const openvdb::Vec3d middle(speed * (frame - frame_numbers().front()), 0, 0);
        for (auto at = CoordBBox(Coord(-6), Coord(18, 6, 6)).begin(); at; ++at)
            grid->tree().setValueOn(
                *at,
                static_cast<float>(std::exp(-0.5 * ((*at).asVec3d() - middle).lengthSqr() / 4)));
        Volume volume;
        volume.grids.emplace_back(grid);
        source.add(volume, nullptr, frame, {});
    }
    const TimeMap map(set, box, 1, {2, true});
    for (const auto& [n, moment] : {std::pair(1, 1.0), {2, 2.25}, {3, 3.75}, {4, 5.0}}) {
        const auto frame =
            openvdb::gridConstPtrCast<FloatGrid>(frame_of(map, source, n).grids.front().grid());
        double sum = 0, along = 0;
        float highest = 0;
        for (auto each = frame->cbeginValueOn(); each; ++each) {
            sum += double(*each);
            along += double(*each) * each.getCoord().x();
            highest = std::max(highest, *each);
        }
        CHECK(along / sum == Approx(speed * moment).margin(0.1));
        // Where two frames are blended, it is 0.91 at most.
        CHECK(highest > 0.94f);
    }
}

TEST_CASE("places that show frames of other moments each keep their bits") {
    Sequence source;
    tell_frames(source);
    auto set = empty_set(Seams::Kind::remove);
    std::vector<std::uint16_t> entries(set.columns(), 1);
    for (std::size_t c = 0; c < entries.size(); ++c)
        if (c % 4 > 1) entries[c] = 5;
    set.seams.push_back({std::move(entries), 0.0});
    const TimeMap map(set, voxels(), 1, {2, true});
    const auto frame = frame_of(map, source, 2);
    for (auto at = cells.begin(); at; ++at)
        CHECK(value(frame, *at) == value_at((*at).y() > 1 ? 2 : 3, *at));
}

TEST_CASE("a fade leaves the first and the last frame as they are") {
    Sequence source;
    tell_frames(source);
    for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert})
        for (const bool moved : {false, true}) {
            auto set = empty_set(kind);
            set.seams.push_back(straight_seam(set, 2));
            const TimeMap map(set, voxels(), 1, {40, moved});
            const auto first = frame_of(map, source, 0),
                       last = frame_of(map, source, map.frames() - 1);
            for (auto at = cells.begin(); at; ++at) {
                CHECK(value(first, *at) == value_at(0, *at));
                CHECK(value(last, *at) == value_at(frame_count - 1, *at));
            }
        }
}

TEST_CASE("seams of frames in pairs keep the length") {
    auto set = empty_set(Seams::Kind::remove);
    set.window = Window{0, 2};
    set.pair_window = Window{4, 6};
    set.seams.push_back(straight_seam(set, 1));
    set.pairs.push_back(straight_seam(set, 5));
    Sequence source;
    tell_frames(source);
    const TimeMap map(set, voxels(), 1, TimeJoin{});
    REQUIRE(map.frames() == frame_count);
    const std::vector<int> wanted{0, 2, 3, 4, 5, 5, 6};
    for (int n = 0; n < frame_count; ++n)
        CHECK(value(frame_of(map, source, n), Coord(0)) ==
              value_at(wanted[static_cast<std::size_t>(n)], Coord(0)));
}

TEST_CASE("what lies beyond a box goes over with its nearest vertex") {
    std::mt19937 random(5);
    const CoordBBox wide(Coord(-2, -2, -2), Coord(5, 5, 3));
    Sequence source;
    tell_frames(source, wide);
    const auto set = random_set(random, empty_set(Seams::Kind::remove), 2);
    const TimeMap map(set, voxels(), 2, TimeJoin{});
    const auto frame = frame_of(map, source, 2);
    for (auto at = wide.begin(); at; ++at) {
        auto nearest = *at;
        for (int d = 0; d < 3; ++d)
            nearest[d] = std::clamp(nearest[d], cells.min()[d], cells.max()[d]);
        CHECK(value(frame, *at) == value_at(shown_at(set, nearest).at(2), *at));
    }
}

TEST_CASE("seams of frames want their own lattice, and no others serve as such") {
    auto set = empty_set(Seams::Kind::remove);
    set.seams.push_back(straight_seam(set, 3));
    const auto other = make_box(openvdb::Vec3d(1), {3, 4, 2}, 1.0, {0, 1, 2});
    CHECK_THAT(failure_of([&] { TimeMap(set, other, 1, TimeJoin{}); }),
               Catch::Contains("the seams were found in another lattice"));
    CHECK_THAT(failure_of([&] { TimeMap(set, voxels(), 2, TimeJoin{}); }),
               Catch::Contains("count asks for 2 seams, but the seam set holds 1"));
    for (const auto wrong : {&Seams::closed, &Seams::around}) {
        auto closed = set;
        closed.*wrong = true;
        CHECK_THAT(failure_of([&] { TimeMap(closed, voxels(), 1, TimeJoin{}); }),
                   Catch::Contains("the seams were found in another lattice"));
    }
    auto larger = set;
    larger.shape = {3, 4, 3};
    CHECK_THAT(failure_of([&] { TimeMap(larger, voxels(), 1, TimeJoin{}); }),
               Catch::Contains("the seams were found in another lattice"));
    set = no_seams(voxels());
    CHECK_THAT(failure_of([&] { TimeMap(set, voxels(), 0, TimeJoin{}); }),
               Catch::Contains("they were found along u"));
}

TEST_CASE("time goes faster where a frame leaves, slower where one comes in, else as before") {
    const openvdb::Vec3d at(1, 2, 1);
    for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert}) {
        auto set = empty_set(kind);
        set.seams.push_back(straight_seam(set, 3));
        const TimeMap map(set, voxels(), 1, {2, true});
        double sum = 0;
        for (int n = 1; n + 1 < map.frames(); ++n) {
            const double rate = map.rate(n)(at);
            CHECK(rate == Approx(map.rate(n)(openvdb::Vec3d(-5))));
            sum += 2 * rate;
            CHECK((kind == Seams::Kind::remove ? rate >= 1 : rate <= 1));
        }
        // From the first two frames of the source to the last two.
        CHECK(sum == Approx(2 * frame_count - 4));
        CHECK(map.rate(0)(at) == 1);
        for (const auto& join : {TimeJoin{}, TimeJoin{2, false}, TimeJoin{1, true}})
            CHECK(!TimeMap(set, voxels(), 1, join).rate(3));
    }
    CHECK(TimeMap(empty_set(Seams::Kind::remove), voxels(), 0, {2, true}).rate(2)(at) == 1);
}
