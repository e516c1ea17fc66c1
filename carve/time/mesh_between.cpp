#include "carve/time/mesh_between.h"

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace fluidcarve {
namespace {

bool is_float(const Mesh::Attribute& attribute) {
    return attribute.type == NumberType::float32 || attribute.type == NumberType::float64;
}

/// Whether the values of both correspond one to one.
bool alike(const Mesh::Attribute& a, const Mesh::Attribute& b) {
    return a.type == b.type && a.on == b.on && a.parts == b.parts && a.at == b.at &&
           a.values.size() == b.values.size();
}

/// A vertex at which each entry of an attribute lies.
std::vector<std::uint32_t> vertices_of(const Mesh::Attribute& attribute, const Mesh& mesh) {
    std::vector<std::uint32_t> out(attribute.entries());
    if (attribute.on == Mesh::Attribute::On::vertices) {
        std::iota(out.begin(), out.end(), 0);
        return out;
    }
    for (std::size_t face = 0; face < mesh.faces(); ++face)
        for (auto corner = mesh.begin(face); corner < mesh.ends[face]; ++corner) {
            const auto vertex = mesh.corners[corner];
            const auto entry = Mesh::entry_of(attribute, face, corner, vertex);
            if (entry != Mesh::Attribute::none) out[entry] = vertex;
        }
    return out;
}

}  // namespace

bool same_faces(const Mesh& a, const Mesh& b) {
    return a.points.size() == b.points.size() && a.corners == b.corners && a.ends == b.ends;
}

Mesh mesh_between(const Mesh& a, const Mesh& b, const ShareAt& share, const Mesh& nearer) {
    auto out = nearer;
    if (!same_faces(a, b)) return out;
    std::vector<double> shares;
    for (const auto& point : a.points) shares.push_back(share(point));
    const auto mix = [](auto from, auto to, double by) {
        // At both ends the result is that of a frame, bit for bit.
        return by == 0 ? from : by == 1 ? to : from + by * (to - from);
    };
    for (std::size_t n = 0; n < out.points.size(); ++n)
        out.points[n] = mix(a.points[n], b.points[n], shares[n]);
    for (auto& attribute : out.attributes) {
        const auto *const from = a.find(attribute.name), *const to = b.find(attribute.name);
        if (!from || !to || !is_float(attribute) || !alike(*from, *to)) continue;
        const auto vertices = vertices_of(*from, a);
        for (std::size_t n = 0; n < attribute.values.size(); ++n)
            attribute.values[n] =
                mix(from->values[n], to->values[n], shares[vertices[n / attribute.parts.size()]]);
    }
    return out;
}

Mesh mesh_between(const Mesh& a, const Mesh& b, double share) {
    return mesh_between(
        a, b, [&](const openvdb::Vec3d&) { return share; }, share < 0.5 ? a : b);
}

double squared_distance(const Mesh& a, const Mesh& b) {
    double sum = 0;
    for (std::size_t n = 0; n < a.points.size(); ++n)
        sum += (a.points[n] - b.points[n]).lengthSqr();
    return a.points.empty() ? 0 : sum / double(a.points.size());
}

}  // namespace fluidcarve
