#include "carve/points/point_vectors.h"
#include "tests/nodes/remap/remap_points_cases.h"
#include "tests/support/warped.h"

namespace {

struct Told : Context::Host {
    std::vector<std::string> warnings;
    void warn(const std::string& message) override { warnings.push_back(message); }
};

/// Points with velocities, in a VDB grid or a PLY file.
Points flowing(const std::vector<Vec3d>& positions, const std::vector<Vec3d>& velocities,
               bool vdb) {
    auto table = ply_at(positions);
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float> values;
        for (const auto& velocity : velocities)
            values.push_back(static_cast<float>(velocity[axis]));
        table.columns.push_back(
            column(std::string("velocity_") + "xyz"[axis], "float", NumberType::float32, values));
    }
    Points out;
    out.ply = std::make_shared<PointTable>(std::move(table));
    return vdb ? in_vdb(out) : out;
}

/// Carves points by remap.points, or those of a volume by remap.grids.
Points carved_by(const Points& points, const Lattice& lattice, const Seams& seams,
                 const std::string& yaml, bool in_volume, Context::Host& told) {
    NodeBench::Inputs inputs{{"lattice", {Payload(std::make_shared<Lattice>(lattice))}},
                             {"seams", {Payload(std::make_shared<Seams>(seams))}}};
    const std::vector<int> frames{1};
    if (!in_volume) {
        inputs["source"] = {Payload(std::make_shared<Points>(points))};
        return *NodeBench(remap_points(), yaml)
                    .run(inputs, Context(told, frames))
                    .at("points")
                    .as<Points>();
    }
    Volume volume;
    volume.grids = {points.grid};
    inputs["source"] = {Payload(std::make_shared<Volume>(volume))};
    Points out;
    out.grid = NodeBench(remap_grids(), yaml)
                   .run(inputs, Context(told, frames))
                   .at("volume")
                   .as<Volume>()
                   ->grids[0]
                   .grid();
    return out;
}

}  // namespace

TEST_CASE("velocities of points stretch as a warp stretches space, if asked to") {
    const auto positions = scattered(BBoxd(Vec3d(2, 2, 2), Vec3d(27, 10, 11)), 400, 3);
    const std::vector<Vec3d> velocities(positions.size(), Vec3d(1, 2, 3));
    // Each vertex moves by a quarter of its distance from the first one: 1.25 times as long.
    const auto warp = warped(points_box, evenly(points_box, 0.25 * (points_box.shape[0] - 1)));
    Told told;
    for (const auto& [vdb, in_volume] :
         {std::pair(false, false), std::pair(true, false), std::pair(true, true)}) {
        const auto source = flowing(positions, velocities, vdb);
        const auto kept = carved_by(source, points_box, warp, "{}", in_volume, told);
        for (const auto& velocity : vectors_of(kept, "velocity"))
            REQUIRE(velocity == Vec3d(1, 2, 3));
        const auto turned =
            carved_by(source, points_box, warp, "{transform_vectors: true}", in_volume, told);
        CHECK(turned.positions() == kept.positions());
        for (const auto& velocity : vectors_of(turned, "velocity"))
            REQUIRE((velocity - Vec3d(1.25, 2, 3)).length() < 1e-5);
    }
    CHECK(told.warnings.empty());
}

TEST_CASE("points that no seam reaches keep their velocity, and points without one are told") {
    const std::vector<Vec3d> positions{{5, 5, 5}, {25, 5, 5}, {40, 5, 5}};
    const std::vector<Vec3d> velocities{{1, 2, 3}, {-1, 0, 1}, {0.1, 0.2, 0.3}};
    auto seams = straight_seams(points_box, Axis::u, Kind::remove, {15});
    Told told;
    const auto turned = carved_by(flowing(positions, velocities, false), points_box, seams,
                                  "{transform_vectors: true}", false, told);
    CHECK(vectors_of(turned, "velocity") ==
          vectors_of(flowing(positions, velocities, false), "velocity"));
    CHECK(told.warnings.empty());
    carved_by(points_at(positions), points_box, seams, "{transform_vectors: true}", false, told);
    CHECK(told.warnings == std::vector<std::string>{
                               "'transform_vectors' finds no velocity to turn: points have none "
                               "named v, vel or velocity"});
}
