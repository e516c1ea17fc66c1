#include "formats/usd/fields.h"

#include "carve/base/failure.h"
#include "carve/volume/triplet.h"

#include <fmt/format.h>

#include <array>
#include <map>
#include <string_view>
#include <utility>

namespace fluidcarve {
namespace {

/// OpenVDB's name of a grid's values and the schema's name.
constexpr std::array<std::pair<std::string_view, std::string_view>, 19> data_types{
    {{"float", "float"},
     {"double", "double"},
     {"half", "half"},
     {"int32", "int"},
     {"uint32", "uint"},
     {"int64", "int64"},
     {"vec2s", "float2"},
     {"vec2d", "double2"},
     {"vec2i", "int2"},
     {"vec3s", "float3"},
     {"vec3d", "double3"},
     {"vec3h", "half3"},
     {"vec3i", "int3"},
     {"mat3d", "matrix3d"},
     {"mat4d", "matrix4d"},
     {"quatd", "quatd"},
     {"bool", "bool"},
     {"mask", "mask"},
     {"string", "string"}}};

/// The schema's name of a grid's values; empty if it has none.
std::string data_type_of(const openvdb::GridBase& grid) {
    // Such as `Tree_float_5_4_3`. A grid's value type does not tell masks from truth values.
    const auto type = grid.type();
    const auto begin = type.find('_') + 1;
    const auto value = type.substr(begin, type.find('_', begin) - begin);
    for (const auto& [openvdb_name, usd_name] : data_types) {
        if (value != openvdb_name) continue;
        std::string out(usd_name);
        if (grid.saveFloatAsHalf())
            for (const std::string_view real : {"float", "double"})
                if (out.starts_with(real)) return "half" + out.substr(real.size());
        return out;
    }
    return {};
}

std::string class_of(const openvdb::GridBase& grid) {
    switch (grid.getGridClass()) {
        case openvdb::GRID_LEVEL_SET: return "levelSet";
        case openvdb::GRID_FOG_VOLUME: return "fogVolume";
        case openvdb::GRID_STAGGERED: return "staggered";
        case openvdb::GRID_UNKNOWN: break;
    }
    return "unknown";
}

std::string role_of(const openvdb::GridBase& grid) {
    switch (grid.getVectorType()) {
        case openvdb::VEC_INVARIANT: break;
        case openvdb::VEC_COVARIANT:
        case openvdb::VEC_COVARIANT_NORMALIZE: return "Normal";
        case openvdb::VEC_CONTRAVARIANT_RELATIVE: return "Vector";
        case openvdb::VEC_CONTRAVARIANT_ABSOLUTE: return "Point";
    }
    return "None";
}

Placement undone(const openvdb::GridBase& grid, const Placement* stated) {
    const auto stored = stored_form_of(grid);
    auto out = stated ? *stated : stored ? stored->placement : Placement{};
    out.offset = openvdb::Vec3d(0);
    return out;
}

}  // namespace

UsdFields usd_fields(const Volume& volume, const Placement* placement) {
    UsdFields out;
    std::map<std::string, int> found;
    for (const auto& grid : volume.grids)
        for (const auto& part : split(grid)) {
            const auto in_file = unplaced(part, placement);
            const auto name = in_file->getName();
            const int index = found[name]++;
            const auto type = data_type_of(*in_file);
            if (type.empty()) {
                out.left_out.push_back(name);
                continue;
            }
            const auto by = undone(*part, placement);
            if (!out.fields.empty() && by != out.placement)
                throw Failure(
                    fmt::format("grids '{}' and '{}' have different placements, and a USD volume "
                                "has one: write them to two files by two vdb.write",
                                out.fields.front().name, name));
            out.placement = by;
            out.fields.push_back({name, index, type, class_of(*in_file),
                                  type.ends_with('3') ? role_of(*in_file) : std::string()});
        }
    return out;
}

}  // namespace fluidcarve
