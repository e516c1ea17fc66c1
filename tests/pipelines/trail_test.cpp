#include "carve/lattice/build.h"
#include "carve/lattice/mapping.h"
#include "carve/rig/transform.h"
#include "formats/geometry_file/curve_file.h"
#include "formats/vdb/vdb_file.h"
#include "tests/support/program.h"

#include <openvdb/tools/Interpolation.h>
#include <nlohmann/json.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>

using namespace fluidcarve;
using openvdb::Vec3d;

// `pipelines/trail.yaml`, run by the program and measured: does the trail get thinner and thicker
// from all sides, whole to its ends?

namespace {

constexpr double voxel = 0.0480769;
constexpr int frame = 48;
const Vec3d place(-1.2759615, -1.2759615, 0.0240385);

/// As the pipeline builds it.
Lattice tube() {
    Rig rig;
    rig.points = read_curve(TEST_DATA "/trail/path.csv");
    LatticeSpec spec;
    spec.spacing = voxel;
    spec.u = {0, 0.75};
    spec.around = true;
    spec.smooth = Smooth::points;
    spec.max_iterations = 1000;
    return build_lattice(extended(rig, 0.6, 0.6), spec).lattice;
}

FloatGrid::ConstPtr density_of(const std::string& path) {
    const auto grid =
        openvdb::gridPtrCast<FloatGrid>(read_vdb(path).find("density")->deepCopyGrid());
    grid->setTransform(grid->transform().copy());
    grid->transform().postTranslate(place);
    return grid;
}

struct Carved {
    Scratch scratch;
    nlohmann::json report;

    explicit Carved(int count, const std::string& pipeline = "trail") {
        std::string call = "run pipelines/" + pipeline +
                           ".yaml -q --progress none --set sheet.show=maximum --report " +
                           (scratch / "report.json") + " --set count=" + std::to_string(count);
        for (const auto& [param, file] :
             {std::pair("out", "trail.####.vdb"), std::pair("seams", "seams.vdb"),
              std::pair("sheet", "sheet.png")})
            call += std::string(" --set ") + param + "=" + (scratch / file);
        const auto ran = fluidcarve_program(call);
        INFO(ran.err);
        REQUIRE(ran.code == 0);
        CHECK(ran.err.find("rim w") == std::string::npos);
        report = nlohmann::json::parse(Scratch::read(scratch / "report.json"));
        REQUIRE(report["lattices"]["tube"]["folded_cells"] == 0);
    }
    FloatGrid::ConstPtr density() const {
        return density_of(scratch / ("trail.00" + std::to_string(frame) + ".vdb"));
    }
};

/// Sums over the smoke around the rig: `across[n]` is the mean square distance from the rig along
/// the n-th of four directions across it.
struct Spread {
    double mass = 0;
    std::array<double, 4> across{};

    Spread(const FloatGrid& grid, const Lattice& lattice, int first, int last) {
        const auto values = grid.getConstAccessor();
        for (int k = first; k < last; ++k)
            for (int j = 0; j < lattice.shape[1]; ++j)
                for (int i = 1; i < lattice.shape[0] + 4; ++i) {
                    const double sample = openvdb::tools::BoxSampler::sample(
                                     values, grid.worldToIndex(lattice.position(Vec3d(i, j, k)))),
                                 weight = i * sample;
                    mass += weight;
                    for (std::size_t n = 0; n < across.size(); ++n) {
                        const double angle =
                            2 * M_PI * j / lattice.shape[1] -
                            M_PI * static_cast<double>(n) / static_cast<double>(across.size());
                        across[n] += weight * i * i * std::cos(angle) * std::cos(angle);
                    }
                }
        for (auto& square : across) square = std::sqrt(square / mass);
    }
};

}  // namespace

TEST_CASE(
    "the trail gets thinner and thicker in all directions alike, loses nothing on its rig, and "
    "does not tear at its ends",
    "[long]") {
    const auto lattice = tube();
    const Mapping mapping(lattice);
    const int whole = lattice.shape[2], part = whole / 4;
    const auto before = density_of(TEST_DATA "/trail/trail.0048.vdb");
    for (const int count : {-3, 3}) {
        const Carved carved(count);
        REQUIRE(carved.report["lattices"]["tube"]["around"] == true);
        const auto after = carved.density();
        // All of it, and the fresh half near the rocket, where it is thin.
        for (const auto& [first, last] : {std::pair(part, 3 * part), std::pair(0, whole)}) {
            const Spread was(*before, lattice, first, last), is(*after, lattice, first, last);
            std::array<double, 4> factor;
            for (std::size_t n = 0; n < 4; ++n) factor[n] = is.across[n] / was.across[n];
            const auto [least, most] = std::ranges::minmax(factor);
            INFO("count " << count << ", planes " << first << " to " << last << ": factors "
                          << factor[0] << ", " << factor[1] << ", " << factor[2] << ", "
                          << factor[3]);
            if (count < 0) CHECK(most < 0.95);
            else CHECK(least > 1.05);
            CHECK(most / least < 1.1);
        }

        const auto was = before->getConstAccessor(), is = after->getConstAccessor();
        double moved = 0, all = 0;
        for (double w = 0; w < lattice.shape[2] - 1; w += 0.5) {
            const auto at = after->worldToIndex(mapping.position(Vec3d(0, 0, w)));
            all += openvdb::tools::BoxSampler::sample(was, at);
            moved += std::abs(openvdb::tools::BoxSampler::sample(is, at) -
                              openvdb::tools::BoxSampler::sample(was, at));
        }
        // On the rig nothing moves but what half a voxel beside it does.
        CHECK(moved < 0.1 * all);
        if (count > 0) continue;
        // Beyond the lattice the smoke is what it was.
        int outside = 0;
        for (auto value = before->cbeginValueOn(); value; ++value) {
            if (mapping.locate(before->indexToWorld(value.getCoord()))) continue;
            ++outside;
            REQUIRE(is.getValue(value.getCoord()) == *value);
        }
        CHECK(outside > 100);
    }
}

TEST_CASE(
    "a trail that is made longer or shorter runs along its path, as thick as before, and its cloud "
    "on the ground stays bit for bit",
    "[nightly][long]") {
    const auto before = density_of(TEST_DATA "/trail/trail.0048.vdb");
    const auto top = [](const FloatGrid& grid) {
        return grid.indexToWorld(grid.evalActiveVoxelBoundingBox().max()).z();
    };
    Rig rig;
    rig.points = read_curve(TEST_DATA "/trail/path.csv");
    std::vector<Vec3d> way;
    const auto points = extended(rig, 2.5, 2.5).points;
    for (std::size_t n = 0; n + 1 < points.size(); ++n)
        for (int part = 0; part < 50; ++part)
            way.push_back(points[n] + (points[n + 1] - points[n]) * (part / 50.0));
    // Mean distance of the smoke in its upper part from the path, weighed by density.
    const auto thickness = [&](const FloatGrid& grid) {
        double sum = 0, mass = 0;
        for (auto value = grid.cbeginValueOn(); value; ++value) {
            const auto at = grid.indexToWorld(value.getCoord());
            if (at.z() < 3) continue;
            double nearest = 1e9;
            for (const auto& point : way) nearest = std::min(nearest, (point - at).length());
            sum += *value * nearest;
            mass += *value;
        }
        return sum / mass;
    };
    for (const int count : {-40, 54}) {
        const Carved carved(count, "trail_longer");
        const auto after = carved.density();
        INFO("count " << count << ": top " << top(*before) << " -> " << top(*after) << ", distance "
                      << thickness(*before) << " -> " << thickness(*after));
        if (count < 0) CHECK(top(*after) < top(*before) - 0.4);
        else CHECK(top(*after) > top(*before) + 0.8);
        CHECK(thickness(*after) == Approx(thickness(*before)).epsilon(0.25));
        std::size_t there = 0, different = 0;
        for (auto value = before->cbeginValueOn(); value; ++value) {
            if (value.getCoord().z() > 20) continue;
            ++there;
            different += after->tree().getValue(value.getCoord()) != *value;
        }
        CHECK(there > 10000);
        CHECK(different == 0);
    }
}
