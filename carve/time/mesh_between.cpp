#include "carve/time/mesh_between.h"

#include <cstddef>

namespace fluidcarve {
namespace {

bool is_float(const Mesh::Attribute& attribute) {
    return attribute.type == NumberType::float32 || attribute.type == NumberType::float64;
}

}  // namespace

bool same_faces(const Mesh& a, const Mesh& b) {
    return a.points.size() == b.points.size() && a.corners == b.corners && a.ends == b.ends;
}

Mesh mesh_between(const Mesh& a, const Mesh& b, double share) {
    const auto& nearer = share < 0.5 ? a : b;
    const auto& other = share < 0.5 ? b : a;
    const double weight = share < 0.5 ? share : 1 - share;  // of the other
    auto out = nearer;
    for (std::size_t n = 0; n < out.points.size(); ++n)
        out.points[n] += weight * (other.points[n] - nearer.points[n]);
    for (auto& attribute : out.attributes) {
        const auto* const there = other.find(attribute.name);
        if (!there || !is_float(attribute) || there->on != attribute.on ||
            there->parts != attribute.parts || there->at != attribute.at ||
            there->values.size() != attribute.values.size())
            continue;
        for (std::size_t n = 0; n < attribute.values.size(); ++n)
            attribute.values[n] += weight * (there->values[n] - attribute.values[n]);
    }
    return out;
}

double squared_distance(const Mesh& a, const Mesh& b) {
    double sum = 0;
    for (std::size_t n = 0; n < a.points.size(); ++n)
        sum += (a.points[n] - b.points[n]).lengthSqr();
    return a.points.empty() ? 0 : sum / double(a.points.size());
}

}  // namespace fluidcarve
