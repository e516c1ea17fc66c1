#include "tests/bench/large/scenes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

using openvdb::Vec3d;

namespace {

/// The river's water alone, as a volume: a hundred million particles would fill the disk. All else
/// is as in river.yaml.
constexpr auto river = R"(fluidcarve: 1
params:
  sim:    {type: path}
  out:    {type: path}
  course: {type: path}
nodes:
  sim:     {type: vdb.read, path: "${sim}", grids: {density: float}}
  edges:   {type: energy.gradient, field: sim.density}
  sharp:   {type: energy.remap, energy: edges, gamma: 2}
  energy:  {type: field.filter, field: sharp, width: 2}
  course:  {type: rig.curve, path: "${course}"}
  rig:     {type: rig.transform, rig: course, extend: 1}
  channel: {type: lattice.build, rig: rig, spacing: 1, extent_u: [-0.5, 1.125], extent_v: [-0.8, 0.8], smooth: directions}
  seams:   {type: seam.pyramid, energy: energy, lattice: channel, count: -13, window: [2, 14], pair_window: [18, 25], spread: 0, rigidity_time: 0.5}
  carved:  {type: remap.grids, source: sim, lattice: channel, seams: seams, soft: 0}
  out:     {type: vdb.write, source: carved, path: "${out}"}
)";

std::string text(const Vec3d& vector) {
    return fmt::format("[{:.9g}, {:.9g}, {:.9g}]", vector.x(), vector.y(), vector.z());
}

/// Copies a curve or a mesh, stretched. @return the copy
std::string stretched(const std::string& path, const Vec3d& by, const std::string& folder) {
    const bool mesh = path.ends_with(".obj");
    std::ifstream in(path);
    if (!in) throw std::runtime_error(fmt::format("{} can't be read", path));
    const auto copy = folder + path.substr(path.rfind('/'));
    std::ofstream out(copy);
    for (std::string line; std::getline(in, line);) {
        auto numbers = line;
        std::ranges::replace(numbers, ',', ' ');
        std::istringstream words(numbers);
        std::string mark;
        if (mesh) words >> mark;
        Vec3d at;
        if ((!mesh || mark == "v") && words >> at.x() >> at.y() >> at.z()) {
            at *= by;
            line = mesh ? fmt::format("v {:.9g} {:.9g} {:.9g}", at.x(), at.y(), at.z())
                        : fmt::format("{:.9g},{:.9g},{:.9g}", at.x(), at.y(), at.z());
        }
        out << line << '\n';
    }
    return copy;
}

}  // namespace

const std::vector<TableScene>& table_scenes() {
    static const std::vector<TableScene> all{
        {"vortex", {"vortex"}, {322, 331, 105}, 84, false, -18, 6, 3.7, 462.6},
        {"river", {"meander", "river"}, {903, 390, 79}, 159, false, -13, 2, 5.2, 509.8},
        {"bonfire", {"bonfire"}, {221, 233, 175}, 120, true, -16, 6, 9.3, 233.1},
        {"torch", {"torch"}, {222, 95, 360}, 72, true, -10, 6, 2.2, 82.9},
        {"trail", {"trail"}, {317, 409, 493}, 72, false, -10, 6, 6.4, 137.6},
        {"plume", {"plume"}, {300, 220, 595}, 216, false, -30, 2, 71.9, 0},
    };
    return all;
}

std::string files_of(const TableScene& scene, const std::string& folder) {
    for (const auto& stem : scene.files)
        for (const auto& entry : std::filesystem::directory_iterator(folder + "/" + scene.name))
            if (entry.path().filename().string().starts_with(stem + "."))
                return fmt::format("{}/{}/{}.####.vdb", folder, scene.name, stem);
    throw std::runtime_error(
        fmt::format("there is no {} in {}/{}", fmt::join(scene.files, " or "), folder, scene.name));
}

std::string arguments_for(const TableScene& scene, const Made& made, const std::string& folder,
                          const std::string& scratch) {
    const auto& by = made.stretch;
    const double narrow = std::min(by.x(), by.y()), wide = std::max(by.x(), by.y());
    std::string out;
    const auto set = [&](const std::string& what, const std::string& value) {
        out += fmt::format(" --set '{}={}'", what, value);
    };
    const auto range = [&](const std::string& what, double low, double high) {
        set(what, fmt::format("[{:.9g}, {:.9g}]", low, high));
    };
    const auto vertices = [&](const std::string& what, double low, double high, double spacing) {
        set(what, fmt::format("[{}, {}]", std::lround(low * spacing / made.voxel),
                              std::lround(high * spacing / made.voxel)));
    };
    const auto voxel = fmt::format("{:.9g}", made.voxel);
    set("seams.count", fmt::format("{}", scene.count));
    if (scene.name == "vortex") {
        out = "pipelines/vortex.yaml" + out;
        set("sim.translate", text(by * Vec3d(-1.9722222, -1.9722222, -0.7222222)));
        range("rig.radius", 1.15 * by.x(), 1.15 * by.y());
        set("ring.spacing", voxel);
        range("ring.extent_u", -0.75 * wide, 0.75 * wide);
    } else if (scene.name == "river") {
        std::ofstream(scratch + "/river.yaml") << river;
        out = scratch + "/river.yaml" + out;
        set("sim.translate", text(by * Vec3d(0.03125, -1.56875, -0.06875)));
        set("course", stretched(SOURCE_ROOT "/tests/data/river/course.csv", by, scratch));
        set("channel.spacing", voxel);
        range("channel.extent_u", -0.5 * by.y(), 1.125 * by.y());
        vertices("seams.window", 2 * by.y(), 14 * by.y(), 0.0625);
        vertices("seams.pair_window", 18 * by.y(), 25 * by.y(), 0.0625);
    } else if (scene.name == "bonfire") {
        out = "pipelines/bonfire.yaml" + out;
        set("sim.translate", text(by * Vec3d(-1.5733333, -1.5733333, 0.0266667)));
        set("pit", stretched(folder + "/bonfire/firepit.obj", by, scratch));
        range("rig.radius", 1.08 * by.x(), 1.08 * by.y());
        set("ring.spacing", voxel);
        range("ring.extent_u", -0.95 * narrow, 1.15 * wide);
        vertices("seams.window", 3, 39 * narrow, 0.0533333);
    } else if (scene.name == "torch") {
        out = "pipelines/torch.yaml" + out;
        set("sim.translate", text(by * Vec3d(-1.1818182, -0.7818182, 0.0181818)));
        set("voxel", voxel);
        set("handle", stretched(folder + "/torch/handle.obj", by, scratch));
        range("waves.extent_u", -0.85 * by.x(), by.x());
        range("waves.extent_v", -1.1 * by.y(), 1.1 * by.y());
    } else if (scene.name == "trail") {
        out = "pipelines/trail.yaml" + out;
        set("place", text(by * Vec3d(-1.2759615, -1.2759615, 0.0240385)));
        set("voxel", voxel);
        set("path", stretched(folder + "/trail/path.csv", by, scratch));
        set("tube.radius",
            fmt::format("{:.9g}", 0.75 * narrow));  // wider, planes would cross in the bends
    } else {
        out = "pipelines/plume_large.yaml" + out;
    }
    return out;
}
