#include "formats/points_file/usda.h"

#include "carve/points/point_grid.h"
#include "formats/geometry_file/usda.h"

#include <array>

namespace fluidcarve {
namespace {

/// Neighbouring columns that are one attribute: three of a vector, or one.
struct UsdAttribute {
    std::string name;
    std::size_t first = 0, parts = 1;  ///< in PointTable::columns
};

std::vector<UsdAttribute> attributes_of(const PointTable& points) {
    const auto& columns = points.columns;
    const auto named = [&](std::size_t n, const std::array<std::string, 3>& names) {
        for (std::size_t c = 0; c < 3; ++c)
            if (n + c >= columns.size() || columns[n + c].name != names[c] ||
                columns[n + c].type != columns[n].type)
                return false;
        return true;
    };
    std::vector<UsdAttribute> out;
    for (std::size_t n = 0; n < columns.size();) {
        const auto& name = columns[n].name;
        const auto base = name.ends_with("_x") ? name.substr(0, name.size() - 2) : std::string();
        if (name == "x" || name == "y" || name == "z") {
            ++n;
            continue;
        }
        if (named(n, {"nx", "ny", "nz"})) out.push_back({"normal", n, 3});
        else if (named(n, {"red", "green", "blue"})) out.push_back({"colour", n, 3});
        else if (!base.empty() && named(n, {base + "_x", base + "_y", base + "_z"}))
            out.push_back({base, n, 3});
        else out.push_back({name, n, 1});
        n += out.back().parts;
    }
    return out;
}

/// @param scale  factor of all values
std::vector<double> values_of(const PointTable& points, const UsdAttribute& attribute,
                              double scale = 1) {
    std::vector<double> out;
    for (std::size_t row = 0; row < points.size; ++row)
        for (std::size_t c = 0; c < attribute.parts; ++c)
            out.push_back(scale * PointTable::number(points.columns[attribute.first + c], row));
    return out;
}

/// Adds an attribute as USD's own one. @return false if USD has none, or the prim has it already
bool put_as_own(UsdGeometry& out, const PointTable& points, const UsdAttribute& attribute) {
    const auto type = points.columns[attribute.first].type;
    const bool vector = attribute.parts == 3, floats = is_floating(type);
    const auto& name = attribute.name;
    if (vector && name == "normal" && !out.has("normals")) {
        out.add({"normal3f", "normals", {}, 3}, values_of(points, attribute));
    } else if (vector && name == "colour" && !out.has("primvars:displayColor")) {
        out.add({"color3f", "primvars:displayColor", "vertex", 3},
                values_of(points, attribute, 1 / full_intensity(type)));
    } else if (vector && floats && (name == "velocity" || name == "v") && !out.has("velocities")) {
        out.add({"vector3f", "velocities", {}, 3}, values_of(points, attribute));
    } else if (!vector && !floats && name == "id" && !out.has("ids")) {
        out.add({"int64", "ids", {}, 1, type}, values_of(points, attribute));
    } else if (!vector && floats && (name == "radius" || name == "pscale") && !out.has("widths")) {
        out.add({"float", "widths", "vertex"}, values_of(points, attribute, 2));
    } else {
        return false;
    }
    return true;
}

}  // namespace

PointLosses write_points_usda(const std::string& path, const Points& points,
                              const UsdPointsRequest& request) {
    PointLosses losses;
    UsdGeometry out("Points", request.frame);
    out.add_positions(points.positions(), request.placement);
    const auto columns = points.ply ? *points.ply : ply_of(*points.grid, losses.attributes);
    const auto put_width = [&](double width) { out.add({"float", "widths", "constant"}, {width}); };
    if (request.width) put_width(*request.width);
    for (const auto& attribute : attributes_of(columns)) {
        const auto type = columns.columns[attribute.first].type;
        if (!put_as_own(out, columns, attribute) &&
            !out.add_primvar(attribute.name, "vertex", attribute.parts, type,
                             values_of(columns, attribute)))
            losses.attributes.push_back(attribute.name);
    }
    const double unit = request.placement ? request.placement->scale : 1;
    if (!out.has("widths") && points.grid) put_width(points.grid->voxelSize().x() / 2 / unit);
    losses.width = !out.has("widths");
    write_usda(path, out.text(), request.provenance);
    return losses;
}

}  // namespace fluidcarve
