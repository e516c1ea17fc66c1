#include "carve/lattice/build.h"
#include "carve/lattice/content_reach.h"
#include "carve/lattice/rig_extent.h"
#include "carve/remap/geometry/points.h"
#include "carve/rig/transform.h"
#include "carve/sdf/from_mesh.h"
#include "carve/sdf/from_points.h"
#include "carve/seam/carve_map.h"
#include "formats/geometry_file/curve_file.h"
#include "formats/mesh_file/mesh_file.h"
#include "formats/points_file/points_file.h"
#include "formats/seam_file/seam_file.h"
#include "formats/vdb/vdb_file.h"
#include "tests/support/program.h"

#include <openvdb/tools/Interpolation.h>
#include <nlohmann/json.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace fluidcarve;
using openvdb::Vec3d;

// `pipelines/river.yaml`, run by the program and measured: does the river change its width, and its
// banks with it?

namespace {

constexpr double voxel = 0.0625;
constexpr std::array frames{37, 38, 39};
const Placement in_shot{Vec3d(0.03125, -1.56875, -0.06875), 1, Vec3d(0)};
const Splat splat{1.4, 1, 3};

using Sampler = openvdb::tools::GridSampler<FloatGrid, openvdb::tools::BoxSampler>;

std::string numbered(const std::string& folder, const std::string& name, int frame,
                     const std::string& ending) {
    return folder + "/" + name + ".00" + std::to_string(frame) + ending;
}

Points points_of(const std::string& path) {
    return read_points(path, "", PointOffset::detect, in_shot);
}

FloatGrid::Ptr ground_of(const Mesh& bank, const openvdb::math::Transform& transform) {
    return mesh_distance(bank, transform, 3, std::nullopt);
}

/// The river, made so many voxels wider.
struct Carved {
    Scratch scratch;
    nlohmann::json report;
    Lattice lattice;
    int begin = 0;  ///< the plane at which the course begins
    Mesh bank = read_mesh(TEST_DATA "/river/riverbank.obj").mesh;

    explicit Carved(int count) {
        std::string call = "run pipelines/river.yaml -q --progress none --report " +
                           (scratch / "report.json") + " --set count=" + std::to_string(count);
        for (const auto& [param, file] :
             {std::pair("out", "drops.####.vdb"), std::pair("skin", "skin.####.vdb"),
              std::pair("shore", "bank.####.obj"), std::pair("seams", "seams.vdb"),
              std::pair("sheet", "sheet.png")})
            call += std::string(" --set ") + param + "=" + (scratch / file);
        const auto ran = fluidcarve_program(call);
        INFO(ran.err);
        REQUIRE(ran.code == 0);
        report = nlohmann::json::parse(Scratch::read(scratch / "report.json"));
        REQUIRE(report["lattices"]["channel"]["folded_cells"] == 0);
        build_channel();
        REQUIRE(report["lattices"]["channel"]["shape"] == lattice.shape);
    }

    /// As the pipeline builds it.
    void build_channel() {
        Rig rig;
        rig.points = read_curve(TEST_DATA "/river/course.csv");
        rig = smoothed(rig, 10);
        ContentReach water;
        for (const int frame : frames) {
            const auto reach = content_reach(*skin_before(frame), rig);
            REQUIRE(reach);
            water.u += reach->u / frames.size();
            water.v += reach->v / frames.size();
            water.before = std::max(water.before, reach->before);
            water.after = std::max(water.after, reach->after);
        }
        LatticeSpec spec;
        spec.spacing = voxel;
        spec.u = RigExtent{-153, 153, true}.of(water.u);
        spec.v = RigExtent{-330, 220, true}.of(water.v);
        spec.smooth = Smooth::directions;
        spec.max_iterations = 1000;
        REQUIRE(water.before > 0);
        const double aside = spec.u[1], before = water.before + aside;
        lattice = build_lattice(extended(rig, before, water.after + aside), spec).lattice;
        begin = static_cast<int>(std::lround(before / voxel));
    }

    Points drops_before(int frame) const {
        return points_of(numbered(TEST_DATA "/river", "meander", frame, ".vdb"));
    }
    Points drops(int frame) const {
        return points_of(numbered(scratch / "", "drops", frame, ".vdb"));
    }
    FloatGrid::ConstPtr skin(int frame) const {
        return openvdb::gridConstPtrCast<FloatGrid>(
            read_vdb(numbered(scratch / "", "skin", frame, ".vdb")).find("surface"));
    }
    /// The water's surface as it was.
    FloatGrid::ConstPtr skin_before(int frame) const {
        return sdf_of_points(drops_before(frame), skin(frame)->transform(), splat);
    }
    /// Which particle came from which.
    std::vector<PointImage> images(int frame, const Points& before) const {
        const CarveMap map(lattice, {std::make_shared<Seams>(read_seams(scratch / "seams.vdb"))},
                           frame, std::nullopt);
        return carve_points(before.positions(), before.identities(), lattice, map, 0).images;
    }
    Mesh bank_of(int frame) const {
        return read_mesh(numbered(scratch / "", "bank", frame, ".obj")).mesh;
    }
};

/// The water across the channel, and the ground on either side, in vertices along u.
struct Station {
    double left, right, ground_left, ground_right;
    double width() const { return right - left; }
};

/// At the height where the water is widest, or at a given one.
Station station(const Lattice& lattice, const FloatGrid& water, const FloatGrid& ground, int k,
                std::optional<double>& height) {
    const Sampler wet(water), solid(ground);
    const auto at = [&](double u, double v) { return lattice.position(Vec3d(u, v, k)); };
    constexpr double step = 0.05, middle = 24.0;
    const auto across = [&](double v) {
        const auto reach = [&](double direction) {
            double u = middle;
            while (std::abs(u - middle) < 24 && wet.wsSample(at(u, v)) < 0) u += direction * step;
            return u;
        };
        const auto ground_from = [&](double from, double direction) {
            double u = from - 2 * direction;
            while (std::abs(u - from) < 12 && solid.wsSample(at(u, v)) > 0) u += direction * step;
            return u;
        };
        const double left = reach(-1), right = reach(1);
        return Station{left, right, ground_from(left, -1), ground_from(right, 1)};
    };
    if (!height) {
        double widest = 0;
        for (double v = 12.4; v < 22.4; v += 0.25)
            if (const auto width = across(v).width(); width > widest) {
                widest = width;
                height = v - 0.5;
            }
    }
    REQUIRE(height);
    return across(*height);
}

/// The water is as many voxels wider as there are seams, and the bank stays at its edge.
void check_stations(const Carved& carved, double change) {
    for (const int frame : {frames.front(), frames.back()}) {
        const auto after = carved.skin(frame);
        const auto before = carved.skin_before(frame);
        const auto bank_before = ground_of(carved.bank, after->transform()),
                   bank_after = ground_of(carved.bank_of(frame), after->transform());
        // Ten, from where the river has settled to where its banks end.
        for (int n = 0; n < 10; ++n) {
            const int k = carved.begin + 14 + 9 * n;
            std::optional<double> height;
            const auto was = station(carved.lattice, *before, *bank_before, k, height),
                       is = station(carved.lattice, *after, *bank_after, k, height);
            INFO("frame " << frame << ", plane " << k << ", height " << *height << ": water "
                          << was.left << " to " << was.right << " became " << is.left << " to "
                          << is.right << ", ground " << was.ground_left << ", " << was.ground_right
                          << " became " << is.ground_left << ", " << is.ground_right);
            CHECK(was.width() > 8);
            CHECK(std::abs(is.width() - was.width() - change) < 1);
            // The bank follows the water's edge.
            CHECK(std::abs((is.ground_right - is.right) - (was.ground_right - was.right)) < 1);
            CHECK(std::abs((is.ground_left - is.left) - (was.ground_left - was.left)) < 1);
        }
    }
}

/// As many more particles as there is more room.
void check_density(const Carved& carved) {
    for (const int frame : {frames.front(), frames.back()}) {
        const auto before = carved.drops_before(frame), after = carved.drops(frame);
        const auto& counted = carved.report["points"]["moved"][std::to_string(frame)];
        CHECK(counted["points"] == before.size());
        CHECK(after.size() == before.size() - counted["deleted"].get<std::size_t>() +
                                  counted["copied"].get<std::size_t>());
        // As many more as the water has more room, within its surface, which stands off the
        // outermost particles.
        const auto room = [](const FloatGrid& surface) {
            double out = 0;
            for (auto at = surface.cbeginValueOn(); at; ++at)
                out += static_cast<double>(*at) < -(splat.radius - 0.5) * voxel;
            return out;
        };
        const auto skin = carved.skin(frame);
        const FloatGrid::ConstPtr was = carved.skin_before(frame),
                                  is = sdf_of_points(after, skin->transform(), splat);
        const double roomier = room(*is) / room(*was),
                     more = static_cast<double>(after.size()) / static_cast<double>(before.size());
        INFO("frame " << frame << ": " << before.size() << " became " << after.size() << ", "
                      << more << " times as many in " << roomier << " times the room");
        CHECK(more == Approx(roomier).epsilon(0.1));
    }
}

/// No particle comes to lie in the bank that was outside it.
void check_kept_out(const Carved& carved) {
    for (const int frame : {frames.front(), frames.back()}) {
        const auto before = carved.drops_before(frame);
        const auto positions = before.positions();
        const auto images = carved.images(frame, before);
        const auto after = carved.drops(frame).positions();
        REQUIRE(images.size() == after.size());
        const auto transform = carved.skin(frame)->transformPtr();
        const auto ground_before = ground_of(carved.bank, *transform),
                   ground_after = ground_of(carved.bank_of(frame), *transform);
        const Sampler was(*ground_before), is(*ground_after);
        std::size_t entered = 0;
        double deepest = 0;
        for (std::size_t n = 0; n < after.size(); ++n) {
            const double distance = was.wsSample(positions[images[n].source]),
                         now = is.wsSample(after[n]);
            if (distance <= 0 || now >= 0) continue;
            ++entered;
            deepest = std::max(deepest, -now / voxel);
        }
        INFO("frame " << frame << ": " << entered << " of " << after.size() << ", the deepest "
                      << deepest << " voxels");
        CHECK(entered == 0);
    }
}

/// The bank keeps its faces and its texture, and stands still.
void check_bank(const Carved& carved) {
    std::vector<Mesh> banks;
    for (const int frame : frames) {
        banks.push_back(carved.bank_of(frame));
        const auto& bank = banks.back();
        CHECK(bank.corners == carved.bank.corners);
        CHECK(bank.ends == carved.bank.ends);
        REQUIRE(bank.find("uv"));
        CHECK(bank.find("uv")->values == carved.bank.find("uv")->values);
        CHECK(bank.find("uv")->at == carved.bank.find("uv")->at);
    }
    double fastest = 0, jerk = 0;
    for (std::size_t n = 0; n < carved.bank.points.size(); ++n) {
        const auto first = banks[1].points[n] - banks[0].points[n],
                   second = banks[2].points[n] - banks[1].points[n];
        fastest = std::max({fastest, first.length() / voxel, second.length() / voxel});
        jerk = std::max(jerk, (second - first).length() / voxel);
    }
    INFO("fastest vertex " << fastest << " voxels per frame, largest change of speed " << jerk);
    CHECK(fastest == 0);
    CHECK(jerk == 0);
}

/// No face of the bank turns over, none becomes a sliver. The smallest angle was 31 degrees.
void check_faces(const Carved& carved) {
    const auto bank = carved.bank_of(frames.front());
    std::size_t first = 0, turned = 0, shortened = 0;
    double sharpest = 0;  ///< cosine of the smallest angle
    for (const auto end : bank.ends) {
        const auto count = static_cast<std::size_t>(end) - first;
        const auto point = [&](const Mesh& mesh, std::size_t n) {
            return mesh.points[static_cast<std::size_t>(mesh.corners[first + n % count])];
        };
        const auto normal = [&](const Mesh& mesh) {
            Vec3d out(0);
            for (std::size_t n = 1; n + 1 < count; ++n)
                out += (point(mesh, n) - point(mesh, 0)).cross(point(mesh, n + 1) - point(mesh, 0));
            return out;
        };
        const auto edge = [&](const Mesh& mesh, std::size_t n) {
            return (point(mesh, n + 1) - point(mesh, n)).length();
        };
        turned += normal(bank).dot(normal(carved.bank)) <= 0;
        for (std::size_t n = 0; n < count; ++n) {
            shortened += edge(bank, n) < 0.4 * edge(carved.bank, n);
            const auto out = point(bank, n) - point(bank, n + 1),
                       on = point(bank, n + 2) - point(bank, n + 1);
            // The bottom is one face, with vertices in a row.
            if (count == 4) sharpest = std::max(sharpest, out.dot(on) / out.length() / on.length());
        }
        first = static_cast<std::size_t>(end);
    }
    CHECK(turned == 0);
    CHECK(shortened == 0);
    CHECK(std::acos(sharpest) * 180 / M_PI > 25);
}

}  // namespace

TEST_CASE("a river that is made wider: its bank, its particles and its texture come along",
          "[nightly]") {
    const Carved carved(6);
    check_stations(carved, 6);
    check_density(carved);
    check_kept_out(carved);
    check_bank(carved);
    check_faces(carved);
}

TEST_CASE("a river that is made narrower: its bank, its particles and its texture come along",
          "[long]") {
    const Carved carved(-6);
    check_stations(carved, -6);
    check_density(carved);
    check_kept_out(carved);
    check_bank(carved);
    check_faces(carved);
}
