#include "tests/faults/jobs.h"

#include <filesystem>
#include <fstream>

namespace faults {
namespace {

namespace fs = std::filesystem;

constexpr auto carve = R"(fluidcarve: 1
params:
  count: {type: count, default: -2}
frames: 1-2
nodes:
  sim: {type: vdb.read, path: in.####.vdb, grids: {density: float}}
  energy: {type: energy.gradient, field: sim.density}
  box: {type: lattice.box, fit: sim.density}
  seams: {type: seam.pyramid, energy: energy, field: sim.density, lattice: box, axis: u, count: "${count}"}
  carved: {type: remap.grids, source: sim, lattice: box, seams: seams}
  out: {type: vdb.write, source: carved, path: out/o.####.vdb}
)";

constexpr auto seams = R"(  kept: {type: seams.write, seams: seams, path: out/seams.vdb}
)";

constexpr auto again = R"(fluidcarve: 1
frames: 1-2
nodes:
  sim: {type: vdb.read, path: in.####.vdb, grids: {density: float}}
  box: {type: lattice.box, fit: sim.density}
  seams: {type: seams.read, path: out/seams.vdb}
  carved: {type: remap.grids, source: sim, lattice: box, seams: seams}
  out: {type: vdb.write, source: carved, path: out/o.####.vdb}
  wires: {type: lattice.write, lattice: box, path: out/box.obj}
)";

constexpr auto pictures =
    R"(  sheet: {type: preview.sheet, before: sim, after: carved, seams: seams, lattice: box, energy: energy, grid: density, path: out/sheet.png}
)";

constexpr auto image = R"(fluidcarve: 1
nodes:
  picture: {type: image.read, path: in.png}
  png: {type: image.write, source: picture, path: out/o.png}
  exr: {type: image.write, source: picture, path: out/o.exr}
  tif: {type: image.write, source: picture, path: out/o.tif}
  jpg: {type: image.write, source: picture, path: out/o.jpg}
)";

constexpr auto meshes = R"(fluidcarve: 1
nodes:
  mesh: {type: mesh.read, path: in.obj}
  ply: {type: mesh.write, source: mesh, path: out/o.ply}
  obj: {type: mesh.write, source: mesh, path: out/o.obj}
  sdf: {type: sdf.from_mesh, mesh: mesh, voxel_size: 0.3}
  vdb: {type: vdb.write, source: sdf, path: out/o.vdb}
)";

constexpr auto tetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// Sixteen grey pixels, as PNG.
constexpr unsigned char pixels[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
    0x52, 0x00, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x04, 0x08, 0x00, 0x00, 0x00, 0x00, 0x8c,
    0x9a, 0xc1, 0xa2, 0x00, 0x00, 0x00, 0x1c, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x60,
    0x10, 0x50, 0x30, 0x60, 0xd0, 0xb0, 0xf0, 0x88, 0x60, 0x08, 0x48, 0x28, 0x68, 0x60, 0xa8,
    0xe8, 0x98, 0xb1, 0x02, 0x00, 0x23, 0xb4, 0x05, 0x41, 0x4b, 0xf8, 0x36, 0xc0, 0x00, 0x00,
    0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

void put(const fs::path& path, const std::string& text) {
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
}

}  // namespace

const std::vector<Job>& jobs() {
    const std::string run = "{} run --threads 1 --in-flight 1 --progress none ";
    static const std::vector<Job> all{
        {"carve", {}, run + "carve.yaml --no-cache --sync"},
        {"solve", {}, run + "carve.yaml --to seams --sync", run + "carve.yaml --only carved"},
        {"part", {}, run + "carve.yaml --to seams.energy", run + "carve.yaml --only seams"},
        {"seams file", {run + "seams.yaml --no-cache -q"}, run + "again.yaml --no-cache"},
        {"work folder", {run + "carve.yaml -q"}, run + "carve.yaml --set count=-3"},
        {"kept", {run + "carve.yaml -q", "rm out/o.0001.vdb"}, run + "carve.yaml"},
        {"picture", {}, run + "pictures.yaml --no-cache"},
        {"page", {run + "carve.yaml -q"}, "{} view carve.yaml --threads 1 -o out/page.html"},
        {"report",
         {},
         run + "carve.yaml --no-cache --report out/r.json --html out/r.html --profile out/p.json "
               "--manifest out/m"},
        {"image", {}, run + "image.yaml --no-cache"},
        {"mesh", {}, run + "mesh.yaml --no-cache"},
        {"farm", {}, "{} farm local carve.yaml --chunk 2 -j 1 --threads 1"},
        {"status", {run + "carve.yaml -q"}, "{} status --json"},
        {"clean", {run + "carve.yaml -q"}, "{} clean"},
    };
    return all;
}

void furnish(const std::string& folder) {
    const fs::path to = folder;
    for (const std::string frame : {"1", "2"})
        fs::copy_file(TEST_DATA "/vdb/gaffer_arnold_sphere.vdb", to / ("in.000" + frame + ".vdb"));
    put(to / "in.obj", tetrahedron);
    put(to / "in.png", std::string(reinterpret_cast<const char*>(pixels), sizeof pixels));
    put(to / "carve.yaml", carve);
    put(to / "seams.yaml", std::string(carve) + seams);
    put(to / "pictures.yaml", std::string(carve) + pictures);
    put(to / "again.yaml", again);
    put(to / "image.yaml", image);
    put(to / "mesh.yaml", meshes);
    put(to / "out/of_others.vdb", "of others");
    put(to / "out/m.lockx", "of others");
    for (const std::string part : {"cache/", "cache/00/", "runs/", "history/", "jobs/other/"})
        put(to / "work" / part / "of_others.json", "[\"of others\"]");
    // Without the mark the work folder would be a stranger's.
    put(to / "work/CACHEDIR.TAG",
        "Signature: 8a477f597d28d172789f06886806bc55\n# A work folder of fluidcarve: results that "
        "it can compute again.\n");
}

const std::vector<std::string>& foreign_files() {
    static const std::vector<std::string> all{"in.0001.vdb",
                                              "in.0002.vdb",
                                              "in.obj",
                                              "in.png",
                                              "carve.yaml",
                                              "out/of_others.vdb",
                                              "out/m.lockx",
                                              "work/cache/of_others.json",
                                              "work/cache/00/of_others.json",
                                              "work/runs/of_others.json",
                                              "work/history/of_others.json",
                                              "work/jobs/other/of_others.json"};
    return all;
}

}  // namespace faults
