#include "tests/fuzz/sources.h"

#include "tests/fuzz/call.h"
#include "tests/fuzz/pipelines.h"
#include "tests/support/scratch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace fuzz {
namespace {

/// Writes volumes in all codecs, seams, images and meshes: of smoke in a box of 16 x 11 x 11
/// voxels.
constexpr auto maker = R"(fluidcarve: 1
nodes:
  in: {{type: vdb.read, path: "{0}/vdb/gaffer_arnold_sphere.vdb", grids: {{density: float}}}}
  space: {{type: mask.box, like: in.density, min: [0, 2, 0], max: [3, 4, 2]}}
  smoke: {{type: field.ax, inputs: {{m: space}}, code: "vec3d p = getvoxelpws(); @out = @m * 1.5 + sin(3.0 * p.x) * cos(2.0 * p.y + p.z);"}}
  slope: {{type: field.gradient, field: smoke}}
  plane: {{type: mask.box, like: in.density, min: [0, 2, 0], max: [3, 4, 0]}}
  shade: {{type: field.ax, inputs: {{m: plane}}, code: "vec3d p = getvoxelpws(); @out = @m * 0.5 + 0.5 * sin(3.0 * p.x) * cos(2.0 * p.y);"}}
  surface: {{type: sdf.to_mesh, surface: in.density, isovalue: 0.5, adaptivity: 0.5}}
  points: {{type: points.read, path: points.ply}}
  few: {{type: points.read, path: few.ply}}
  energy: {{type: energy.gradient, field: smoke}}
  box: {{type: lattice.box, fit: smoke}}
  seams: {{type: seam.greedy, energy: energy, lattice: box, count: -2}}
  one: {{type: seam.greedy, energy: energy, lattice: box, count: -1}}
  pairs: {{type: seam.greedy, energy: energy, lattice: box, count: 1, window: [0, 6], pair_window: [8, 15]}}
  blosc: {{type: vdb.write, source: smoke, path: blosc.vdb}}
  zip: {{type: vdb.write, source: smoke, path: zip.vdb, compression: zip}}
  none: {{type: vdb.write, source: smoke, path: none.vdb, compression: none}}
  vectors: {{type: vdb.write, source: slope, path: vectors.vdb}}
  mask: {{type: vdb.write, source: space, path: mask.vdb}}
  one_file: {{type: seams.write, seams: one, path: one.vdb}}
  seams_file: {{type: seams.write, seams: seams, path: seams.vdb}}
  pairs_file: {{type: seams.write, seams: pairs, path: pairs.vdb}}
  particles: {{type: points.write, source: points, path: particles.vdb}}
  three: {{type: points.write, source: few, path: three.vdb}}
  binary: {{type: points.write, source: points, path: binary.ply, encoding: little_endian}}
  png: {{type: image.write, source: shade, path: i.png}}
  exr: {{type: image.write, source: shade, path: i.exr}}
  jpg: {{type: image.write, source: shade, path: i.jpg}}
  tif: {{type: image.write, source: shade, path: i.tif}}
  obj: {{type: mesh.write, source: surface, path: m.obj}}
  ply: {{type: mesh.write, source: surface, path: m.ply}}
  off: {{type: mesh.write, source: surface, path: m.off}}
  stl: {{type: mesh.write, source: surface, path: m.stl}}
)";

std::string ply(const std::string& more_properties, const std::string& more_values) {
    constexpr int count = 24;
    auto out = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty "
        "float z\n{}end_header\n",
        count, more_properties);
    for (int n = 0; n < count; ++n)
        out +=
            fmt::format("{:.3f} {:.3f} {:.3f}{}\n", 0.03 * n + 0.1, 0.3 + 0.2 * std::sin(0.4 * n),
                        0.3 + 0.2 * std::cos(0.4 * n), more_values);
    return out;
}

/// A curve in each format.
std::vector<Source> curves() {
    std::string csv = "x,y,z\n", obj, line = "l";
    for (int n = 0; n < 12; ++n) {
        const auto x = 0.3 * n, y = 0.5 * std::sin(0.4 * n);
        csv += fmt::format("{:.3f},{:.3f},0\n", x, y);
        obj += fmt::format("v {:.3f} {:.3f} 0\n", x, y);
        line += fmt::format(" {}", n + 1);
    }
    return {{".csv", csv, curve_pipeline(".csv")},
            {".obj", obj + line + "\n", curve_pipeline(".obj")},
            {".ply", ply("", ""), curve_pipeline(".ply")}};
}

/// A triangle and a quadrangle with all that the format has. OBJ and PLY as others write them.
std::vector<Source> written_meshes() {
    return {{".obj",
             "mtllib a.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 1 "
             "1\nvn 0 0 1\ng top\nusemtl red\nf 1/1/1 2/2/1 3/3/1 "
             "4/1/1\nf -1//1 -2//1 -3//1\n"},
            {".ply",
             "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty "
             "float y\nproperty float z\nproperty uchar red\n"
             "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1\n1 0 0 "
             "2\n1 1 0 3\n0 1 0 4\n3 0 1 2\n4 0 1 2 3\n"},
            {".off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n"},
            {".stl",
             "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 "
             "0\nendloop\nendfacet\nendsolid a\n"}};
}

}  // namespace

Sources make_sources(const std::string& program, const std::string& folder) {
    namespace fs = std::filesystem;
    const auto write = [&](const std::string& name, const std::string& text) {
        std::ofstream(folder + "/" + name, std::ios::binary) << text;
    };
    const auto points = ply("property int id\nproperty float age\n", " 7 0.5");
    write("points.ply", points);
    write("few.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
          "float z\nproperty int id\nend_header\n1 2 3 1\n1 2 3 2\n1 2 3 "
          "3\n");
    write("p.yaml", fmt::format(maker, TEST_DATA));
    if (const auto made = call({program, "run", "--quiet", "p.yaml"}, folder, 10 * patience);
        made.code != 0)
        throw std::runtime_error(made.hung ? "making the sources takes too long"
                                           : "the sources can't be made: " + made.errors);

    const auto made = [&](const std::string& name) { return Scratch::read(folder + "/" + name); };
    const auto data = [&](const std::string& name) { return Scratch::read(TEST_DATA "/" + name); };
    const auto vdb = [](const std::string& bytes, const std::string& pipeline) {
        return Source{".vdb", bytes, pipeline, vdb_places(bytes)};
    };
    Sources out;
    for (const auto* codec : {"blosc", "zip", "none"})
        out.volumes.push_back(
            vdb(made(codec + std::string(".vdb")), volume_pipeline("out", "float")));
    out.volumes.push_back(vdb(made("vectors.vdb"), volume_pipeline("gradient of out", "vector")));
    out.volumes.push_back(vdb(made("mask.vdb"), copy_pipeline()));
    out.volumes.push_back(
        vdb(data("vdb/gaffer_arnold_sphere.vdb"), volume_pipeline("density", "float")));
    out.volumes.push_back(vdb(data("vdb/oiio_sphereCd.vdb"), volume_pipeline("Cd", "vector")));
    out.volumes.push_back(
        vdb(data("river/river_half.0012.vdb"), volume_pipeline("velocity", "vector")));
    for (const auto& bytes : {made("three.vdb"), made("particles.vdb"),
                              data("vdb/cortex_points.vdb"), data("river/river_half.0012.vdb")})
        out.points.push_back(vdb(bytes, points_pipeline(TEST_DATA, ".vdb")));
    for (const auto& bytes : {points, made("binary.ply")})
        out.points.push_back({".ply", bytes, points_pipeline(TEST_DATA, ".ply")});
    for (const auto* name : {"one.vdb", "seams.vdb", "pairs.vdb"})
        out.seams.push_back(vdb(made(name), seams_pipeline(folder + "/blosc.vdb", "out")));
    for (const std::string ending : {".png", ".exr", ".jpg", ".tif"})
        out.images.push_back({ending, made("i" + ending), image_pipeline(ending, ending)});
    out.meshes = written_meshes();
    for (const std::string ending : {".obj", ".ply", ".off", ".stl"})
        out.meshes.push_back({ending, made("m" + ending)});
    out.curves = curves();
    std::vector<std::string> shipped;
    for (const auto& entry : fs::directory_iterator(SOURCE_ROOT "/pipelines"))
        if (entry.path().extension() == ".yaml") shipped.push_back(Scratch::read(entry.path()));
    std::ranges::sort(shipped);
    for (const auto& each : shipped) out.pipelines.push_back({".yaml", each});
    return out;
}

}  // namespace fuzz
