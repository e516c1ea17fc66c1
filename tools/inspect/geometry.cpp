#include "tools/inspect/geometry.h"

#include "carve/base/failure.h"
#include "carve/base/one_line.h"
#include "carve/base/words.h"
#include "formats/geometry_file/curve_file.h"
#include "formats/geometry_file/ply.h"
#include "formats/mesh_file/mesh_file.h"
#include "formats/points_file/ply.h"
#include "formats/points_file/points_file.h"
#include "tools/inspect/facts.h"

#include <fmt/format.h>

#include <filesystem>
#include <span>
#include <utility>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

/// The facts that all kinds have. @param positions  in the file's units
Json geometry_json(const std::string& path, const char* kind,
                   std::span<const openvdb::Vec3d> positions) {
    Json out{{"file", path}, {"kind", kind}, {"bytes", std::filesystem::file_size(path)}};
    if (!positions.empty()) out["world_box"] = box_around(positions);
    out["attributes"] = Json::array();
    out["oddities"] = Json::array();
    return out;
}

Json mesh_json(const std::string& path, const MeshFile& file) {
    constexpr std::array on{"vertices", "faces", "corners"};
    auto out = geometry_json(path, "mesh", file.mesh.points);
    out["vertices"] = file.mesh.points.size();
    out["faces"] = file.mesh.faces();
    for (const auto& each : file.mesh.attributes)
        out["attributes"].push_back(
            {{"name", one_line(each.name)},
             {"type", fmt::format("{} x {}", each.parts.size(), name_of(each.type))},
             {"on", on.at(static_cast<std::size_t>(each.on))}});
    for (const auto& loss : file.losses) out["oddities"].push_back(one_line(loss));
    if (file.mesh.faces() == 0) out["oddities"].push_back("it has no faces");
    return out;
}

Json points_json(const std::string& path) {
    const auto points = read_points(path, {}, PointOffset::none, {});
    auto out = geometry_json(path, "points", points.positions());
    out["points"] = points.size();
    for (const auto& column : points.ply->columns)
        if (column.name != "x" && column.name != "y" && column.name != "z")
            out["attributes"].push_back(
                {{"name", one_line(column.name)}, {"type", name_of(column.type)}});
    if (points.size() == 0) out["oddities"].push_back("no points");
    return out;
}

Json curve_json(const std::string& path) {
    const auto points = read_curve(path);
    auto out = geometry_json(path, "curve", points);
    double length = 0;
    for (std::size_t n = 1; n < points.size(); ++n) length += (points[n] - points[n - 1]).length();
    out["points"] = points.size();
    out["length"] = length;
    out["closed"] = points.size() > 2 && points.front() == points.back();
    return out;
}

Json look_at_geometry(const std::string& path) {
    if (ending_of(path) == ".csv") return curve_json(path);
    if (ending_of(path) == ".ply" && holds_points(path)) return points_json(path);
    const auto file = read_mesh(path);
    if (file.mesh.faces() > 0 || ending_of(path) != ".obj") return mesh_json(path, file);
    try {
        return curve_json(path);
    } catch (const Failure&) {
        // Neither faces nor one line: told as a mesh without faces.
        return mesh_json(path, file);
    }
}

std::string geometry_text(const Json& file) {
    const auto kind = file["kind"].get<std::string>();
    auto out =
        fmt::format("{}: {} bytes, ", file["file"].get<std::string>(), count_text(file["bytes"]));
    if (kind == "mesh")
        out += fmt::format("a mesh of {} vertices and {} faces", count_text(file["vertices"]),
                           count_text(file["faces"]));
    else if (kind == "points") out += fmt::format("{} points", count_text(file["points"]));
    else
        out += fmt::format(
            "{} curve of {} points, {} long", file["closed"].get<bool>() ? "a closed" : "an open",
            count_text(file["points"]),
            file["length"].is_array() ? range_text(file["length"])
                                      : fmt::format("{:g}", file["length"].get<double>()));
    if (file.contains("world_box")) out += ", world " + world_text(file["world_box"]);
    out += "\n";
    for (const auto& attribute : file["attributes"]) {
        out += fmt::format("  {}  {}", attribute["name"].get<std::string>(),
                           attribute["type"].get<std::string>());
        if (attribute.contains("on")) out += ", on " + attribute["on"].get<std::string>();
        out += "\n";
    }
    for (const auto& oddity : file["oddities"])
        out += "  note: " + oddity.get<std::string>() + "\n";
    return out;
}

}  // namespace

FileInspector geometry_inspector() {
    auto endings = all_mesh_endings();
    endings.emplace_back(".csv");
    return {std::move(endings),
            {".csv"},
            "attributes",
            &look_at_geometry,
            [](const std::vector<Json>&) { return std::vector<std::string>(); },
            &geometry_text};
}

}  // namespace fluidcarve
