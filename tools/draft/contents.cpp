#include "tools/draft/contents.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/grid/named_grids.h"
#include "formats/image/image.h"
#include "nodes/payload/picked_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

namespace fluidcarve {
namespace {

using Facts = nlohmann::ordered_json;

/// Voxels along the longest edge of a mesh, when it becomes a volume.
constexpr double voxels_of_mesh = 96;

/// The part of a list, such as a grid, of a name; null: none.
const Facts* part_of(const Facts& list, const std::string& name) {
    for (const auto& part : list)
        if (part.at("name") == name) return &part;
    return nullptr;
}

openvdb::BBoxd box_of(const Facts& box) {
    const auto corner = [&](std::size_t n) {
        return openvdb::Vec3d(box[n][0].get<double>(), box[n][1].get<double>(),
                              box[n][2].get<double>());
    };
    return {corner(0), corner(1)};
}

/// The grids of a sequence of VDB files.
class Grids {
public:
    explicit Grids(const std::vector<Facts>& files) : files_(files) {
        for (const auto& grid : files.front().at("grids")) {
            const auto name = grid.at("name").get<std::string>();
            const auto lacking = std::ranges::find_if(files, [&](const Facts& file) {
                return part_of(file.at("grids"), name) == nullptr;
            });
            if (lacking == files.end()) shared_.push_back(&grid);
            else lacked_.emplace_back(&grid, &*lacking);
        }
    }

    /// Why no grid suits: a frame lacks one that the first file has. Empty: none does.
    std::string lack() const {
        if (lacked_.empty()) return {};
        const auto of_content = std::ranges::find_if(
            lacked_, [](const auto& each) { return each.first->at("active_voxels") != 0; });
        const auto& [grid, file] = of_content == lacked_.end() ? lacked_.front() : *of_content;
        std::vector<std::string> known;
        for (const auto& each : file->at("grids")) known.push_back(each.at("name"));
        return fmt::format("{} {}", file->at("file").get<std::string>(),
                           lacks_grid(grid->at("name"), known,
                                      fmt::format(", which {} has",
                                                  files_.front().at("file").get<std::string>())));
    }
    /// Whether a frame lacks a grid of a name that tells what it is.
    bool lacks(std::string_view word) const {
        return std::ranges::any_of(lacked_, [&](const std::pair<const Facts*, const Facts*>& each) {
            return in_small_letters(each.first->at("name").get<std::string>()) == word;
        });
    }

    /// Names of a type that every file has, content or not.
    std::vector<std::string> all(std::string_view type) const {
        std::vector<std::string> out;
        for (const auto* grid : shared_)
            if (grid->at("type") == type) out.push_back(grid->at("name"));
        return out;
    }

    /// Names of those with content.
    std::vector<std::string> filled(std::string_view type) const {
        auto out = all(type);
        std::erase_if(out, [&](const std::string& name) { return !has_content(name); });
        return out;
    }

    const Facts& facts(const std::string& name) const {
        return *part_of(files_.front().at("grids"), name);
    }
    bool is_level_set(const std::string& name) const {
        return facts(name).at("class") == "level set";
    }
    bool lie_alike(const std::string& a, const std::string& b) const {
        return facts(a).at("transform") == facts(b).at("transform");
    }
    double voxel(const std::string& name) const {
        return facts(name).at("transform").at("voxel_size")[0].get<double>();
    }

    openvdb::BBoxd box(const std::string& name) const {
        openvdb::BBoxd out;
        for (const auto& each : boxes(name)) out.expand(each);
        return out;
    }

    double highest(const std::string& name) const {
        double out = 0;
        for (const auto& file : files_)
            if (const auto* const grid = part_of(file.at("grids"), name);
                grid && grid->contains("range"))
                for (const auto& end : grid->at("range"))
                    if (end.is_number()) out = std::max(out, std::abs(end.get<double>()));
        return out;
    }
    /// The box in each file that has content.
    std::vector<openvdb::BBoxd> boxes(const std::string& name) const {
        std::vector<openvdb::BBoxd> out;
        for (const auto& file : files_)
            if (const auto* const grid = part_of(file.at("grids"), name);
                grid && grid->contains("world_box"))
                out.push_back(box_of(grid->at("world_box")));
        return out;
    }
    /// The other grids of the name and type of one.
    std::vector<std::string> same(const std::string& name) const {
        const auto end = name.rfind('[');
        if (end == std::string::npos || !name.ends_with(']')) return {};
        auto out = filled(facts(name).at("type").get<std::string>());
        std::erase_if(out, [&](const std::string& each) {
            return each == name || !each.starts_with(name.substr(0, end + 1));
        });
        return out;
    }

private:
    /// Whether any of the files has active voxels in it, and not all of one value.
    bool has_content(const std::string& name) const {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        bool any = false;
        for (const auto& file : files_) {
            const auto& grid = *part_of(file.at("grids"), name);
            any = any || grid.at("active_voxels") != 0;
            if (!grid.contains("range")) continue;
            low = std::min(low, grid.at("range")[0].get<double>());
            high = std::max(high, grid.at("range")[1].get<double>());
        }
        return any && (low != high || low > 0);
    }

    const std::vector<Facts>& files_;
    std::vector<const Facts*> shared_;  ///< those that every file has
    /// The others of the first file, each with a file that lacks it.
    std::vector<std::pair<const Facts*, const Facts*>> lacked_;
};

using Words = std::span<const std::string_view>;

/// The first of the names that is one of the words, in the order of the words; else the first that
/// begins with one; else empty.
std::string named(const std::vector<std::string>& names, Words words) {
    for (const bool whole : {true, false})
        for (const auto word : words)
            for (const auto& name : names)
                if (whole ? in_small_letters(name) == word
                          : in_small_letters(name).starts_with(word))
                    return name;
    return {};
}

constexpr std::array<std::string_view, 3> flames{"flame", "fire", "burn"};
constexpr std::array<std::string_view, 8> smokes{"density", "smoke", "soot", "dust",
                                                 "cloud",   "steam", "fog",  "mist"};
constexpr std::array<std::string_view, 4> surfaces{"surface", "phi", "sdf", "liquid"};
constexpr std::array<std::string_view, 4> velocities{"velocity", "vel", "voxel_velocity", "v"};

/// The names of point grids.
std::vector<std::string> point_grids(const Facts& file) {
    std::vector<std::string> out;
    for (const auto& grid : file.at("grids"))
        if (grid.contains("points")) out.push_back(grid.at("name"));
    return out;
}

/// Velocities that lie on the voxels of a grid; empty: none.
std::string velocity_beside(const Grids& grids, const std::string& name) {
    const auto out = named(grids.filled("vec3s"), velocities);
    return out.empty() || !grids.lie_alike(out, name) ? std::string() : out;
}

/// Which end of the content stays in place when an axis is carved: the one that stands still over
/// the frames while the other moves, where the source is. Upwards, if neither tells, the lower one,
/// on which things stand; else the middle.
/// @param boxes  of frames in the order of time
/// @param up     0, 1, 2: x, y, z
std::array<std::string, 3> sources_of(const std::vector<openvdb::BBoxd>& boxes, double voxel,
                                      int up) {
    std::array<std::string, 3> out;
    for (int axis = 0; axis < 3; ++axis) {
        const auto stands = [&](const auto& end_of) {
            const auto [low, high] = std::ranges::minmax(boxes, {}, end_of);
            return end_of(high) - end_of(low) < 1.5 * voxel;
        };
        const bool low =
            boxes.empty() || stands([axis](const openvdb::BBoxd& box) { return box.min()[axis]; });
        const bool high =
            boxes.empty() || stands([axis](const openvdb::BBoxd& box) { return box.max()[axis]; });
        out[static_cast<std::size_t>(axis)] = low == high ? (low && axis == up ? "low" : "middle")
                                              : low       ? "low"
                                                          : "high";
    }
    return out;
}

/// What to say of files in which nothing can be carved.
std::string nothing_to_carve(const Grids& grids, const Facts& first) {
    const auto lack = grids.lack();
    return lack.empty() ? fmt::format(
                              "{} holds nothing that can be carved: no particles, and no "
                              "grid of floats or vectors with different values",
                              first.at("file").get<std::string>())
                        : lack;
}

/// Sets what the files hold, and the grid that shows it best.
void choose_main(const Grids& grids, const Facts& first, Contents& out) {
    using Matter = Contents::Matter;
    auto fogs = grids.filled("float"), level_sets = fogs;
    std::erase_if(fogs, [&](const std::string& name) { return grids.is_level_set(name); });
    std::erase_if(level_sets, [&](const std::string& name) { return !grids.is_level_set(name); });
    const auto vectors = grids.filled("vec3s"), points = point_grids(first);
    out.flame = named(fogs, flames);
    out.main = named(fogs, smokes);
    if (out.main.empty() &&
        std::ranges::any_of(smokes, [&](std::string_view word) { return grids.lacks(word); }))
        throw Failure(grids.lack(), Failure::Kind::input);
    if (!out.flame.empty()) {
        out.matter = Matter::fire;
        if (out.main.empty() || !grids.lie_alike(out.main, out.flame)) out.main = out.flame;
    } else if (!out.main.empty()) {
        out.matter = Matter::smoke;
    } else if (!points.empty()) {
        out.matter = Matter::particles;
        out.main = points.front();
        out.alone = grids.all("float").empty() && grids.all("vec3s").empty();
        const auto& attributes = grids.facts(out.main).at("points").at("attributes");
        out.identified =
            attributes.contains("id") && attributes.at("id").get<std::string>().starts_with("int");
    } else if (!level_sets.empty()) {
        out.matter = Matter::level_set;
        out.main = named(level_sets, surfaces);
        if (out.main.empty()) out.main = level_sets.front();
    } else if (!fogs.empty() || !vectors.empty()) {
        out.vectors = fogs.empty();
        out.main = out.vectors ? vectors.front() : fogs.front();
    } else {
        throw Failure(nothing_to_carve(grids, first), Failure::Kind::input);
    }
}

Contents contents_of_volumes(const std::vector<Facts>& files) {
    const Grids grids(files);
    Contents out;
    out.in_volume = true;
    out.floats = grids.all("float");
    if (const auto& profile = files.front().at("profile"); profile.is_string())
        out.profile = profile;
    choose_main(grids, files.front(), out);
    out.voxel = grids.voxel(out.main);
    out.box = grids.box(out.main);
    if (!out.vectors) out.highest = grids.highest(out.main);
    if (!out.vectors) out.velocity = velocity_beside(grids, out.main);
    if (out.matter != Contents::Matter::particles) out.same = grids.same(out.main);
    out.y_up = out.profile == "houdini" || out.profile == "embergen";
    out.source = sources_of(grids.boxes(out.main), out.voxel, out.y_up ? 1 : 2);
    return out;
}

Contents contents_of_images(const std::vector<Facts>& files) {
    Contents out;
    out.matter = Contents::Matter::image;
    out.y_up = true;
    for (const auto& channel : files.front().at("channels"))
        out.floats.push_back(channel.at("name"));
    if (out.floats.empty())
        throw Failure(
            fmt::format("{} has no channels", files.front().at("file").get<std::string>()),
            Failure::Kind::input);
    const auto colours = colours_of(out.floats);
    const auto green = std::ranges::find(out.floats, "G");
    out.main = !colours.empty()            ? colours[1]
               : green == out.floats.end() ? out.floats.front()
                                           : *green;
    return out;
}

Contents contents_of_geometry(const std::vector<Facts>& files) {
    const auto& first = files.front();
    const bool mesh = first.at("kind") == "mesh";
    const auto& counted = mesh ? first.at("faces") : first.at("points");
    if (counted == 0 || !first.contains("world_box"))
        throw Failure(fmt::format("{} has no {}", first.at("file").get<std::string>(),
                                  mesh ? "faces" : "points"),
                      Failure::Kind::input);
    Contents out;
    out.matter = mesh ? Contents::Matter::mesh : Contents::Matter::particles;
    out.alone = true;
    std::vector<openvdb::BBoxd> boxes;
    for (const auto& file : files)
        if (file.contains("world_box"))
            out.box.expand(boxes.emplace_back(box_of(file.at("world_box"))));
    const auto size = out.box.extents();
    const auto longest = std::max({size.x(), size.y(), size.z()});
    // In liquids, particles are about half a voxel apart.
    const auto apart =
        std::cbrt(std::max(size.x(), longest / 100) * std::max(size.y(), longest / 100) *
                  std::max(size.z(), longest / 100) / counted.get<double>());
    out.voxel = mesh ? longest / voxels_of_mesh : std::max(2 * apart, longest / 500);
    if (!mesh) out.identified = part_of(first.at("attributes"), "id") != nullptr;
    out.source = sources_of(boxes, out.voxel, 2);
    return out;
}

}  // namespace

Contents contents_of(const std::vector<Facts>& facts) {
    const auto kind = facts.front().at("kind").get<std::string>();
    if (kind == "volume") return contents_of_volumes(facts);
    if (kind == "image") return contents_of_images(facts);
    if (kind == "mesh" || kind == "points") return contents_of_geometry(facts);
    throw Failure(
        fmt::format("{} is a {}, which holds nothing to carve; rig.curve reads it as a rig",
                    facts.front().at("file").get<std::string>(), kind),
        Failure::Kind::input);
}

}  // namespace fluidcarve
