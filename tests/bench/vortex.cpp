#include "tests/bench/vortex.h"

#include "carve/lattice/build.h"
#include "carve/lattice/mapping.h"
#include "carve/rig/circle.h"
#include "carve/seam/carve_map.h"
#include "carve/solver/costs/sample.h"
#include "formats/seam_file/seam_file.h"
#include "formats/vdb/vdb_file.h"
#include "tests/bench/measure.h"
#include "tests/support/program.h"
#include "tests/support/vdb_grid.h"

#include <fmt/ranges.h>

#include <openvdb/tools/Dense.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <stdexcept>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

// As pipelines/vortex.yaml has it, but for more room: twenty seams must fit, and something must be
// left to move.
constexpr int seam_count = 20;
constexpr double spacing = 0.0555556, radius = 1.15;
constexpr std::array extent_u{-1.05, 0.85}, extent_v{-0.7, 0.7};
const Vec3d corner(-1.9722222, -1.9722222, -0.7222222);

Lattice ring(double step) {
    LatticeSpec spec;
    spec.spacing = step;
    spec.u = extent_u;
    spec.v = extent_v;
    return build_lattice(circle_rig(Vec3d(0), Vec3d(0, 0, 1), {radius, radius}, 0), spec).lattice;
}

/// vortex.yaml without its picture, on a sequence. @return the report
nlohmann::json carve(const Scratch& scratch, const std::string& in, const std::string& name,
                     int count, int last) {
    const auto shipped = Scratch::read(SOURCE_ROOT "/pipelines/vortex.yaml");
    const auto file = scratch.write(
        "vortex.yaml", shipped.substr(0, shipped.find("  sheet: {type: preview.sheet")));
    const auto ran = fluidcarve_program(
        fmt::format("run -q {} --threads 2 --set sim={}.####.vdb --set out={}.####.vdb --set "
                    "seams={}.vdb --set count={} --set 'ring.extent_u=[{}]' "
                    "--set 'seams.window=[0, {}]' --report {}",
                    file, in, scratch / name, scratch / name, count, fmt::join(extent_u, ", "),
                    last, scratch / "report.json"));
    if (ran.code != 0) throw std::runtime_error(ran.err);
    return nlohmann::json::parse(Scratch::read(scratch / "report.json"));
}

using Dense = openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ>;

/// The density of a file, and 0 around it.
Dense density(const std::string& path) {
    const auto grid = openvdb::gridConstPtrCast<FloatGrid>(read_vdb_grid(path, "density"));
    Dense out(CoordBBox(Coord(-4), Coord(80, 80, 36)));
    openvdb::tools::copyToDense(*grid, out);
    return out;
}

Vec3d gradient(const Dense& field, const Coord& at) {
    const auto along = [&](int x, int y, int z) {
        return 0.5 *
               (field.getValue(at.offsetBy(x, y, z)) - field.getValue(at.offsetBy(-x, -y, -z)));
    };
    return {along(1, 0, 0), along(0, 1, 0), along(0, 0, 1)};
}

/// Where the voxels of a carved frame come from, if all of their cell moved alike.
class Moved {
public:
    Moved(const Lattice& lattice, const Seams& seams, std::size_t t)
        : mapping_(lattice), step_(seams, t, seams.seams.size()) {}

    Vec3d world(const Vec3d& at) const { return spacing * at + corner; }

    /// Vertices, 0 if they do not agree.
    int displacement(const Coord& at) const {
        const auto place = mapping_.locate(world(at.asVec3d()));
        if (!place) return 0;
        const auto cell = Coord::floor(*place);
        int out = 0;
        for (int n = 0; n < 8; ++n) {
            const auto vertex = cell.offsetBy(n & 1, n >> 1 & 1, n >> 2);
            if (vertex.x() >= step_.after() || vertex.y() >= step_.columns().laterals) return 0;
            const int found = step_.displacement(vertex.x(), vertex.y(),
                                                 step_.columns().turned_slice(vertex.z()));
            if (n > 0 && found != out) return 0;
            out = found;
        }
        return out / 2;
    }

    Vec3d source(const Vec3d& at, int displacement) const {
        const auto place = *mapping_.locate(world(at));
        return at +
               (mapping_.position(place + Vec3d(displacement, 0, 0)) - mapping_.position(place)) /
                   spacing;
    }

private:
    Mapping mapping_;
    CarveStep step_;
};

struct SlopeSquares {
    double before = 0, after = 0;
    double loss() const { return 1 - after / before; }
};

/// Of the voxels that only moved: the squares of the slopes along u that they have, and that the
/// input has where they come from, the mean of its voxels there. Along u, a move changes no slope;
/// across, a ring that is tightened is squeezed.
void add_frame(const Moved& moved, const Dense& before, const Dense& after, SlopeSquares& sum) {
    const auto square = [](double x) { return x * x; };
    auto box = after.bbox();
    box.expand(-2);
    for (auto at = box.begin(); at; ++at) {
        const int d = moved.displacement(*at);
        if (d == 0) continue;
        bool alone = false;
        for (const auto& next : {Coord(1, 0, 0), Coord(0, 1, 0), Coord(0, 0, 1)})
            alone =
                alone || moved.displacement(*at + next) != d || moved.displacement(*at - next) != d;
        if (alone) continue;
        const auto from = moved.source((*at).asVec3d(), d);
        const auto u = (from - (*at).asVec3d()).unit();
        sum.after += square(u.dot(gradient(after, *at)));
        const auto low = Coord::floor(from);
        for (int n = 0; n < 8; ++n) {
            const auto voxel = low.offsetBy(n & 1, n >> 1 & 1, n >> 2);
            const auto off = from - voxel.asVec3d();
            const double weight =
                (1 - std::abs(off.x())) * (1 - std::abs(off.y())) * (1 - std::abs(off.z()));
            sum.before += weight * square(u.dot(gradient(before, voxel)));
        }
    }
}

double loss_of(const Lattice& lattice, const Seams& seams, const PathPattern& in,
               const PathPattern& out) {
    SlopeSquares sum;
    for (std::size_t t = 0; t < seams.frames.size(); ++t)
        add_frame(Moved(lattice, seams, t), density(in.at(seams.frames[t])),
                  density(out.at(seams.frames[t])), sum);
    return sum.loss();
}

/// Carves seams from a sequence at once, without solving them again.
void carve_again(const Scratch& scratch, const std::string& in, const Seams& seams,
                 const std::string& name, const std::string& interpolation) {
    write_seams(scratch / "again.vdb", seams);
    const auto file = scratch.write(
        "again.yaml", fmt::format(R"(fluidcarve: 1
frames: 41-46
nodes:
  sim:    {{type: vdb.read, path: "{}.####.vdb", translate: [{}, {}, {}]}}
  rig:    {{type: rig.circle, center: [0, 0, 0], normal: [0, 0, 1], radius: {}}}
  ring:   {{type: lattice.build, rig: rig, spacing: {}, extent_u: [{}], extent_v: [{}]}}
  seams:  {{type: seams.read, path: "{}"}}
  carved: {{type: remap.grids, source: sim, lattice: ring, seams: seams, interpolation: {}}}
  out:    {{type: vdb.write, source: carved, path: "{}.####.vdb"}}
)",
                                  in, corner.x(), corner.y(), corner.z(), radius, spacing,
                                  fmt::join(extent_u, ", "), fmt::join(extent_v, ", "),
                                  scratch / "again.vdb", interpolation, scratch / name));
    const auto ran = fluidcarve_program("run -q " + file);
    if (ran.code != 0) throw std::runtime_error(ran.err);
}

/// The paper's loop: solve one seam, remap, and all again from what came out. Next to it the same
/// number at once, and for what is lost the very same seams.
void bench_loop(const std::string& in) {
    const Scratch scratch;
    const auto lattice = ring(spacing);
    const int last = lattice.shape[0] - 1;
    const double at_once = carve(scratch, in, "once", -seam_count, last)["wall_s"];
    double one_by_one = 0;
    std::string from = in;
    Seams seams;
    for (int n = 0; n < seam_count; ++n) {
        const auto name = fmt::format("loop{}", n);
        // What the seams before left empty is no place for one.
        one_by_one += carve(scratch, from, name, -1, last - n)["wall_s"].get<double>();
        from = scratch / name;
        auto found = read_seams(from + ".vdb");
        if (n == 0) seams = std::move(found);
        else seams.seams.push_back(std::move(found.seams.at(0)));
    }
    line(fmt::format("vortex, {} seams: seconds of the paper's loop / of one carve", seam_count),
         one_by_one / at_once, fmt::format("{:.2f} s, {:.2f} s", one_by_one, at_once));

    const PathPattern input(in + ".####.vdb");
    const auto loss = [&](const std::string& name) {
        return loss_of(lattice, seams, input, PathPattern(name + ".####.vdb"));
    };
    for (const auto* const interpolation : {"linear", "cubic"})
        carve_again(scratch, in, seams, interpolation, interpolation);
    const double by_loop = loss(from), linear = loss(scratch / "linear"),
                 cubic = loss(scratch / "cubic");
    line("vortex: slopes lost where voxels only moved: loop / one carve", by_loop / linear,
         fmt::format("{:.1f} %, {:.1f} %; cubic {:.1f} %", 100 * by_loop, 100 * linear,
                     100 * cubic));
}

void bench_share(const std::string& in) {
    const Scratch scratch;
    double work = 0, lattice = 0;
    const auto report = carve(scratch, in, "out", -6, ring(spacing).shape[0] - 1);
    for (const auto& [name, node] : report["nodes"].items()) {
        work += node["wall_s"].get<double>();
        if (name == "rig" || name == "ring") lattice += node["wall_s"].get<double>();
    }
    line("vortex: work of a run / of building its lattice", work / lattice,
         fmt::format("{:.2f} % of it", 100 * lattice / work));
}

void bench_sampling(const std::string& in, int frame) {
    const auto file = PathPattern(in + ".####.vdb").at(frame);
    const auto field = openvdb::gridPtrCast<FloatGrid>(read_vdb_grid(file, "density"));
    field->transform().postTranslate(corner);
    const auto lattice = ring(spacing / 3);
    std::vector<std::uint16_t> codes(static_cast<std::size_t>(lattice.shape[0]) *
                                     static_cast<std::size_t>(lattice.shape[1]) *
                                     static_cast<std::size_t>(lattice.shape[2]));
    scaling(fmt::format("ring of {}: energy sampled", fmt::join(lattice.shape, " x ")),
            [&] { return seconds(9, [&] { sample_energy(*field, lattice, Axis::u, codes); }); });
}

}  // namespace

void bench_vortex(const std::string& folder) {
    const auto in = folder + "/vortex";
    bench_loop(in);
    bench_share(in);
    bench_sampling(in, 41);
}
