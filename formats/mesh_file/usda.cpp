#include "formats/mesh_file/usda.h"

#include "formats/geometry_file/usda.h"
#include "formats/mesh_file/mesh_formats.h"

namespace fluidcarve {
namespace {

using Entries = std::vector<double>;

std::string interpolation_of(Mesh::Attribute::On on) {
    using On = Mesh::Attribute::On;
    return on == On::vertices ? "vertex" : on == On::faces ? "uniform" : "faceVarying";
}

/// The values of an attribute, those of corners one by one. A corner without an entry gets 0.
/// @param scale  factor of all values
/// @return `[vertex, face or corner][part]`, the parts from `first` to before `last`
Entries entries_of(const Mesh::Attribute& attribute, std::size_t first, std::size_t last,
                   double scale = 1) {
    Entries out;
    const auto put = [&](std::uint32_t entry) {
        for (auto part = first; part < last; ++part)
            out.push_back(entry == Mesh::Attribute::none ? 0
                                                         : scale * attribute.entry(entry)[part]);
    };
    if (attribute.on == Mesh::Attribute::On::corners)
        for (const auto entry : attribute.at) put(entry);
    else
        for (std::size_t n = 0; n < attribute.entries(); ++n) put(static_cast<std::uint32_t>(n));
    return out;
}

/// Adds an attribute as USD's own one. @return false if USD has none, or the prim has it already
bool put_as_own(UsdGeometry& out, const Mesh::Attribute& attribute) {
    const auto on = interpolation_of(attribute.on);
    const auto parts = attribute.parts.size();
    const auto& name = attribute.name;
    if (name == "uv" && parts >= 2 && !out.has("primvars:st")) {
        out.add({"texCoord2f", "primvars:st", on, 2}, entries_of(attribute, 0, 2));
    } else if (name == "normal" && parts == 3 && !out.has("normals")) {
        out.add({"normal3f", "normals", on, 3}, entries_of(attribute, 0, 3));
    } else if (name == "colour" && (parts == 3 || parts == 4) &&
               !out.has("primvars:displayColor") && !out.has("primvars:displayOpacity")) {
        const double light = 1 / full_intensity(attribute.type);
        out.add({"color3f", "primvars:displayColor", on, 3}, entries_of(attribute, 0, 3, light));
        if (parts == 4)
            out.add({"float", "primvars:displayOpacity", on}, entries_of(attribute, 3, 4, light));
    } else if (name == "velocity" && parts == 3 && attribute.on == Mesh::Attribute::On::vertices &&
               !out.has("velocities")) {
        out.add({"vector3f", "velocities", {}, 3}, entries_of(attribute, 0, 3));
    } else {
        return false;
    }
    return true;
}

}  // namespace

std::vector<std::string> write_mesh_usda(const std::string& path, const Mesh& mesh,
                                         const Placement* placement, std::optional<int> frame,
                                         const Provenance& provenance) {
    Losses losses;
    lines_for(mesh, "usda", losses);
    UsdGeometry out("Mesh", frame);
    out.add("uniform token subdivisionScheme = \"none\"");
    Entries counts;
    for (std::size_t n = 0; n < mesh.faces(); ++n)
        counts.push_back(static_cast<double>(mesh.face(n).size()));
    out.add_positions(mesh.points, placement);
    out.add({"int", "faceVertexCounts", {}, 1, NumberType::int32}, counts);
    out.add({"int", "faceVertexIndices", {}, 1, NumberType::int32},
            {mesh.corners.begin(), mesh.corners.end()});
    for (const auto& attribute : mesh.attributes) {
        const auto parts = attribute.parts.size();
        if (!put_as_own(out, attribute) &&
            !out.add_primvar(attribute.name, interpolation_of(attribute.on), parts, attribute.type,
                             entries_of(attribute, 0, parts)))
            lose(losses, attribute, ".usda has no type for them");
    }
    write_usda(path, out.text(), provenance);
    return losses;
}

}  // namespace fluidcarve
