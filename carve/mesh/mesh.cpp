#include "carve/mesh/mesh.h"

#include "carve/base/find_or_null.h"

#include <algorithm>
#include <utility>

namespace fluidcarve {

using openvdb::Vec3d;

const Mesh::Attribute* Mesh::find(const std::string& name) const {
    return find_or_null(attributes, name, &Attribute::name);
}

Mesh placed(Mesh mesh, const Placement& placement) {
    if (placement == Placement()) return mesh;
    auto stored = std::make_shared<Mesh::StoredForm>(*mesh.stored);
    stored->placement = placement;
    stored->in_file = mesh.points;
    for (auto& point : mesh.points) point = placement.scale * point + placement.translate;
    mesh.stored = std::move(stored);
    return mesh;
}

std::vector<Vec3d> unplaced(const Mesh& mesh, const Placement* placement) {
    auto out = mesh.points;
    const auto& undo = placement ? *placement : mesh.stored ? mesh.stored->placement : Placement();
    if (undo == Placement()) return out;
    const bool from_file =
        mesh.stored && mesh.stored->placement == undo && mesh.stored->in_file.size() == out.size();
    for (std::size_t n = 0; n < out.size(); ++n) {
        auto& point = out[n];
        const bool unmoved =
            from_file && point == undo.scale * mesh.stored->in_file[n] + undo.translate;
        point = unmoved ? mesh.stored->in_file[n] : (point - undo.translate) / undo.scale;
    }
    return out;
}

std::optional<Mesh::Attribute> per_vertex(const Mesh& mesh, const Mesh::Attribute& attribute,
                                          std::size_t& several) {
    using Attribute = Mesh::Attribute;
    std::vector<std::uint32_t> entries(mesh.points.size(), Attribute::none);
    std::vector<bool> differs(mesh.points.size());
    for (std::size_t corner = 0; corner < mesh.corners.size(); ++corner) {
        const auto vertex = mesh.corners[corner], entry = attribute.at[corner];
        auto& first = entries[vertex];
        if (first == Attribute::none) first = entry;
        if (entry == Attribute::none ||
            !std::ranges::equal(attribute.entry(entry), attribute.entry(first)))
            differs[vertex] = true;
    }
    several = static_cast<std::size_t>(std::ranges::count(differs, true));
    if (several > 0) return std::nullopt;
    auto out = attribute;
    out.on = Attribute::On::vertices;
    out.at.clear();
    out.values.assign(mesh.points.size() * out.parts.size(), 0);
    for (std::size_t n = 0; n < entries.size(); ++n)
        if (entries[n] != Attribute::none)
            std::ranges::copy(
                attribute.entry(entries[n]),
                out.values.begin() + static_cast<std::ptrdiff_t>(n * out.parts.size()));
    return out;
}

}  // namespace fluidcarve
