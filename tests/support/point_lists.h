#pragma once

#include "carve/points/point_grid.h"

#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace fluidcarve::test {

template <class T>
PointTable::Column column(const std::string& name, const std::string& type_name, NumberType type,
                          const std::vector<T>& values) {
    PointTable::Column out{name, type_name, type, {}};
    out.values.resize(values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(out.values.data(), values.data(), out.values.size());
    return out;
}

/// Vertices of doubles, with their number as `id`.
inline PointTable ply_at(const std::vector<openvdb::Vec3d>& positions) {
    PointTable out;
    out.size = positions.size();
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (const auto& at : positions) values.push_back(at[axis]);
        out.columns.push_back(
            column(std::string(1, "xyz"[axis]), "double", NumberType::float64, values));
    }
    std::vector<std::int32_t> ids;
    for (std::size_t n = 0; n < positions.size(); ++n) ids.push_back(static_cast<std::int32_t>(n));
    out.columns.push_back(column("id", "int", NumberType::int32, ids));
    return out;
}

inline Points points_at(const std::vector<openvdb::Vec3d>& positions) {
    Points out;
    out.ply = std::make_shared<PointTable>(ply_at(positions));
    return out;
}

/// The same points in a VDB grid.
inline Points in_vdb(const Points& points) {
    Points out;
    out.grid = grid_of(*points.ply);
    return out;
}

/// Uniformly random in a box of the world.
inline std::vector<openvdb::Vec3d> scattered(const openvdb::BBoxd& box, std::size_t count,
                                             unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<openvdb::Vec3d> out;
    for (std::size_t n = 0; n < count; ++n) {
        const openvdb::Vec3d share(unit(random), unit(random), unit(random));
        out.push_back(box.min() + share * (box.max() - box.min()));
    }
    return out;
}

}  // namespace fluidcarve::test
