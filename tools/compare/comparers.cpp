#include "tools/compare/comparers.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "formats/file/module.h"
#include "formats/geometry_file/curve_file.h"
#include "formats/image/image_volume.h"
#include "formats/mesh_file/mesh_file.h"
#include "formats/points_file/ply.h"
#include "formats/points_file/points_file.h"
#include "formats/vdb/vdb_file.h"
#include "tools/compare/grids.h"
#include "tools/compare/picture.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

namespace fluidcarve {
namespace {

/// A file of grids, which are read when they are needed.
struct GridFile {
    std::vector<std::string> names;
    std::function<openvdb::GridBase::ConstPtr(std::size_t place)> grid;

    std::optional<std::size_t> find(const std::string& name) const {
        const auto found = std::ranges::find(names, name);
        return found == names.end()
                   ? std::nullopt
                   : std::optional(static_cast<std::size_t>(found - names.begin()));
    }
};

PartDifference only_in(const char* file, const std::string& name) {
    PartDifference out;
    out.name = name;
    out.faults.push_back(fmt::format("only in {}", file));
    return out;
}

std::vector<PartDifference> compare_all(const GridFile& a, const GridFile& b, const FilePair& paths,
                                        const Tolerance& tolerance) {
    std::vector<PartDifference> out;
    for (std::size_t n = 0; n < a.names.size(); ++n) {
        const auto& name = a.names[n];
        if (const auto other = b.find(name))
            out.push_back(compare_grids(name, *a.grid(n), *b.grid(*other), paths, tolerance));
        else out.push_back(only_in("A", name));
    }
    for (const auto& name : b.names)
        if (!a.find(name)) out.push_back(only_in("B", name));
    return out;
}

GridFile volume_file(const std::string& path, std::uint64_t memory) {
    const auto file = std::make_shared<VdbFile>(path, memory);
    return {file->header().names(), [file](std::size_t place) { return file->read(place); }};
}

std::vector<PartDifference> compare_volumes(const FilePair& files, const Tolerance& tolerance,
                                            std::uint64_t memory) {
    return compare_all(volume_file(files.a, memory), volume_file(files.b, memory), files,
                       tolerance);
}

openvdb::GridBase::ConstPtr named_grid(const GridFile& file, const std::string& name) {
    const auto place = file.find(name);
    return place ? file.grid(*place) : nullptr;
}

void draw_volumes(const FilePair& files, const PartDifference& part, const std::string& title,
                  const std::string& png) {
    constexpr auto no_limit = ~std::uint64_t{0};
    const auto a = named_grid(volume_file(files.a, no_limit), part.name),
               b = named_grid(volume_file(files.b, no_limit), part.name);
    draw_difference({a, b, files, *part.worst, title}).write_png(png);
}

Volume volume_of_image(const std::string& path, std::uint64_t memory) {
    const auto& images = load_module<ImageModule>("images");
    const auto& format = format_of_file(path);
    if (const auto bytes = bytes_as_volume(images.header(path, format.name)); bytes > memory)
        throw Failure(fmt::format("{} takes {} of memory; --memory allows {}", path,
                                  size_text(bytes), size_text(memory)),
                      Failure::Kind::input);
    return volume_of(images.read(path, format.name));
}

GridFile image_file(const Volume& volume) {
    GridFile out;
    out.names = volume.given_names();
    out.grid = [grids = volume.grids](std::size_t place) { return grids[place].grid(); };
    return out;
}

std::string size_of_picture(const Volume& volume) {
    const auto size =
        volume.grids.empty() ? openvdb::Coord() : volume.grids.front().active_box().dim();
    return fmt::format("{} x {}", size.x(), size.y());
}

std::vector<PartDifference> compare_images(const FilePair& files, const Tolerance& tolerance,
                                           std::uint64_t memory) {
    const auto a = volume_of_image(files.a, memory), b = volume_of_image(files.b, memory);
    auto out = compare_all(image_file(a), image_file(b), files, tolerance);
    const auto in_a = size_of_picture(a), in_b = size_of_picture(b);
    for (auto& part : out) {
        part.values = "pixels";
        if (in_a != in_b) part.faults.push_back(fmt::format("size: {} in A, {} in B", in_a, in_b));
        if (!part.worst) continue;
        part.worst->index.resize(2);
        part.worst->world.reset();
    }
    return out;
}

void draw_images(const FilePair& files, const PartDifference& part, const std::string& title,
                 const std::string& png) {
    constexpr auto no_limit = ~std::uint64_t{0};
    const auto a = image_file(volume_of_image(files.a, no_limit)),
               b = image_file(volume_of_image(files.b, no_limit));
    draw_difference({named_grid(a, part.name), named_grid(b, part.name), files, *part.worst, title})
        .write_png(png);
}

std::string attributes_of(const Mesh& mesh) {
    std::vector<std::string> names;
    for (const auto& attribute : mesh.attributes) names.push_back(attribute.name);
    return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

std::vector<PartDifference> compare_meshes(const FilePair& files, const Tolerance& tolerance) {
    const auto a = read_mesh(files.a).mesh, b = read_mesh(files.b).mesh;
    auto out = compare_positions("mesh", "vertices", a.points, b.points, tolerance);
    if (a.faces() != b.faces())
        out.faults.push_back(fmt::format("faces: {} in A, {} in B", a.faces(), b.faces()));
    else if (a.corners != b.corners || a.ends != b.ends)
        out.faults.emplace_back("faces: of other vertices");
    if (const auto in_a = attributes_of(a), in_b = attributes_of(b); in_a != in_b)
        out.faults.push_back(fmt::format("attributes: {} in A, {} in B", in_a, in_b));
    return {out};
}

std::vector<PartDifference> compare_geometry(const FilePair& files, const Tolerance& tolerance,
                                             std::uint64_t) {
    if (ending_of(files.a) == ".csv")
        return {compare_positions("curve", "points", read_curve(files.a), read_curve(files.b),
                                  tolerance)};
    const auto points = [](const std::string& path) {
        return ending_of(path) == ".ply" && holds_points(path);
    };
    if (!points(files.a) || !points(files.b)) return compare_meshes(files, tolerance);
    const auto positions = [](const std::string& path) {
        return read_points(path, {}, PointOffset::none, {}).positions();
    };
    return {
        compare_positions("points", "points", positions(files.a), positions(files.b), tolerance)};
}

/// Of files of meshes, points and curves.
std::vector<std::string> geometry_endings() {
    auto out = all_mesh_endings();
    out.emplace_back(".csv");
    return out;
}

}  // namespace

const std::vector<FileComparer>& comparers() {
    static const std::vector<FileComparer> all{{{".vdb"}, &compare_volumes, &draw_volumes},
                                               {all_image_endings(), &compare_images, &draw_images},
                                               {geometry_endings(), &compare_geometry, nullptr}};
    return all;
}

}  // namespace fluidcarve
