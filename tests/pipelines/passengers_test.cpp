#include "formats/mesh_file/mesh_file.h"
#include "formats/points_file/points_file.h"
#include "formats/vdb/vdb_file.h"
#include "tests/support/program.h"

#include <openvdb/tools/GridTransformer.h>
#include <openvdb/tools/Interpolation.h>

#include <catch2/catch.hpp>

#include <random>

using namespace fluidcarve;
using openvdb::Vec3d;

// One set of seams, found in a proxy of half the resolution, carves all that belongs to a shot.

namespace {

constexpr int first = 51, last = 52, seams = 5;

using Sampler = openvdb::tools::GridSampler<FloatGrid, openvdb::tools::BoxSampler>;

FloatGrid::ConstPtr density_of(const std::string& path) {
    return openvdb::gridConstPtrCast<FloatGrid>(read_vdb(path).find("density"));
}

std::string numbered(const std::string& stem, int frame, const std::string& ending) {
    return stem + ".00" + std::to_string(frame) + ending;
}

}  // namespace

TEST_CASE("seams found in a proxy carve the full grids, particles and meshes of a shot alike") {
    const Scratch scratch;
    std::mt19937 random(1);
    std::string ply, obj;
    std::vector<Vec3d> places;
    const double fine = density_of(TEST_DATA "/plume/plume.0051.vdb")->voxelSize().x(),
                 coarse = 2 * fine;
    for (int frame = first; frame <= last; ++frame) {
        const auto full = density_of(numbered(TEST_DATA "/plume/plume", frame, ".vdb"));
        const auto proxy = FloatGrid::create();
        proxy->setTransform(openvdb::math::Transform::createLinearTransform(coarse));
        proxy->setName("density");
        openvdb::tools::resampleToMatch<openvdb::tools::BoxSampler>(*full, *proxy);
        Volume volume;
        volume.grids.push_back(proxy);
        write_vdb(numbered(scratch / "proxy", frame, ".vdb"), volume);
    }
    std::uniform_real_distribution<double> across(4 * fine, 38 * fine), up(4 * fine, 76 * fine);
    for (int n = 0; n < 3000; ++n) {
        places.emplace_back(across(random), across(random), up(random));
        const auto text = fmt::format("{:.9g} {:.9g} {:.9g}", places.back().x(), places.back().y(),
                                      places.back().z());
        ply += fmt::format("{} {}\n", text, n);
        obj += "v " + text + "\n";
    }
    for (int frame = first; frame <= last; ++frame)
        scratch.write(numbered("dust", frame, ".ply"),
                      "ply\nformat ascii 1.0\nelement vertex 3000\nproperty double x\nproperty "
                      "double y\nproperty double z\nproperty int id\nend_header\n" +
                          ply);
    scratch.write("shell.obj", obj + "f 1 2 3\n");
    const auto pipeline = scratch.write(
        "shot.yaml",
        fmt::format(
            "fluidcarve: 1\nframes: {}-{}\nnodes:\n"
            "  proxy: {{type: vdb.read, path: proxy.####.vdb, grids: {{density: float}}}}\n"
            "  full: {{type: vdb.read, path: \"{}/plume/plume.####.vdb\"}}\n"
            "  dust: {{type: points.read, path: dust.####.ply}}\n  shell: {{type: mesh.read, path: "
            "shell.obj}}\n"
            "  energy: {{type: energy.gradient, field: proxy.density}}\n"
            "  box: {{type: lattice.box, min: [{}, {}, {}], max: [{}, {}, {}], spacing: {}}}\n"
            "  seams: {{type: seam.pyramid, energy: energy, lattice: box, count: -{}, window: [3, "
            "17]}}\n"
            "  small: {{type: remap.grids, source: proxy, lattice: box, seams: seams, soft: 0}}\n"
            "  large: {{type: remap.grids, source: full, lattice: box, seams: seams, soft: 0}}\n"
            "  motes: {{type: remap.points, source: dust, lattice: box, seams: seams, soft: 0}}\n"
            "  hull: {{type: remap.mesh, source: shell, lattice: box, seams: seams, soft: 0}}\n"
            "  a: {{type: vdb.write, source: small, path: \"{}\"}}\n  b: {{type: vdb.write, "
            "source: large, path: \"{}\"}}\n"
            "  c: {{type: points.write, source: motes, path: \"{}\"}}\n  d: {{type: mesh.write, "
            "source: hull, path: \"{}\"}}\n",
            first, last, TEST_DATA, 0, 0, 0, 21 * coarse, 21 * coarse, 40 * coarse, coarse, seams,
            scratch / "small.####.vdb", scratch / "large.####.vdb", scratch / "motes.####.ply",
            scratch / "hull.####.obj"));
    const auto ran = fluidcarve_program("run -q --progress none " + pipeline);
    INFO(ran.err);
    REQUIRE(ran.code == 0);

    for (int frame = first; frame <= last; ++frame) {
        const auto before = density_of(numbered(TEST_DATA "/plume/plume", frame, ".vdb"));
        const auto large = density_of(numbered(scratch / "large", frame, ".vdb")),
                   small = density_of(numbered(scratch / "small", frame, ".vdb"));
        const Sampler was(*before), is(*large), is_small(*small);
        const auto hull = read_mesh(numbered(scratch / "hull", frame, ".obj")).mesh;
        const auto motes =
            read_points(numbered(scratch / "motes", frame, ".ply"), "", PointOffset::none, {});
        const auto positions = motes.positions();
        const auto ids = motes.identities();
        REQUIRE(hull.points.size() == places.size());
        std::size_t together = 0, kept = 0, alike = 0, moved = 0;
        for (std::size_t n = 0; n < positions.size(); ++n) {
            const auto& from = places[ids[n]];
            const auto& vertex = hull.points[ids[n]];
            // A vertex may stand up to a seam's cell off, where space is pressed together and
            // particles are taken.
            CHECK((vertex - positions[n]).length() < 2 * coarse);
            if ((vertex - positions[n]).length() > 1e-5) continue;
            ++together;
            moved += vertex != from;
            kept += std::abs(is.wsSample(vertex) - was.wsSample(from)) < 0.02;
            alike += std::abs(is_small.wsSample(vertex) - is.wsSample(vertex)) < 0.1;
        }
        INFO("frame " << frame << ": of " << places.size() << " particles " << positions.size()
                      << " are left, " << together << " with the mesh, " << moved << " moved, "
                      << kept << " with the smoke, " << alike << " with the proxy");
        CHECK(positions.size() < 0.85 * static_cast<double>(places.size()));
        CHECK(together > 0.6 * static_cast<double>(positions.size()));
        CHECK(moved > 0.3 * static_cast<double>(together));
        CHECK(kept > 0.97 * static_cast<double>(together));
        CHECK(alike > 0.9 * static_cast<double>(together));
    }
}
