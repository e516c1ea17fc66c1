#include "carve/points/point_vectors.h"

#include <openvdb/points/PointDataGrid.h>

#include <array>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

namespace fluidcarve {
namespace {

using openvdb::Index;
using openvdb::Vec3d;
using openvdb::Vec3f;
using namespace openvdb::points;

/// The columns of a vector in a PLY file, or nothing.
std::optional<std::array<std::size_t, 3>> columns_of(const PointTable& table,
                                                     const std::string& name) {
    for (const std::string between : {"", "_", "."}) {
        std::array<std::size_t, 3> out{};
        int found = 0;
        for (std::size_t n = 0; n < table.columns.size(); ++n)
            for (std::size_t axis = 0; axis < 3; ++axis)
                if (table.columns[n].name == name + between + "xyz"[axis]) {
                    out[axis] = n;
                    ++found;
                }
        if (found == 3) return out;
    }
    return std::nullopt;
}

/// Calls `visit(leaf, attribute, index of the leaf's first point)` for all leaves that have it.
template <class Tree, class Visit>
void each_leaf(Tree& tree, const std::string& name, const Visit& visit) {
    std::size_t first = 0;
    for (auto leaf = tree.beginLeaf(); leaf; ++leaf) {
        visit(*leaf, leaf->attributeSet().find(name), first);
        first += leaf->pointCount();
    }
}

bool holds_vectors(const AttributeArray& array) {
    return array.stride() == 1 && (array.valueType() == openvdb::typeNameAsString<Vec3f>() ||
                                   array.valueType() == openvdb::typeNameAsString<Vec3d>());
}

/// Names of all vectors.
std::set<std::string> vector_names(const Points& points) {
    std::set<std::string> out;
    if (points.grid) {
        const auto& tree = static_cast<const PointDataGrid&>(*points.grid).tree();
        const auto leaf = tree.cbeginLeaf();
        if (!leaf) return out;
        const auto& set = leaf->attributeSet();
        for (const auto& [name, place] : set.descriptor().map())
            if (holds_vectors(*set.getConst(place))) out.insert(name);
        return out;
    }
    for (const auto& column : points.ply->columns) {
        if (column.name.empty() || column.name.back() != 'x') continue;
        auto name = column.name.substr(0, column.name.size() - 1);
        if (!name.empty() && (name.back() == '_' || name.back() == '.')) name.pop_back();
        if (!name.empty() && columns_of(*points.ply, name)) out.insert(name);
    }
    return out;
}

}  // namespace

std::string velocity_name(const Points& points) {
    const auto names = vector_names(points);
    for (const auto* const usual : {"v", "vel", "velocity"})
        if (names.count(usual) > 0) return usual;
    std::string out;
    for (const auto& name : names) {
        if (!std::string_view(name).ends_with("velocity")) continue;
        if (!out.empty()) return "";
        out = name;
    }
    return out;
}

std::vector<Vec3d> vectors_of(const Points& points, const std::string& name) {
    if (vector_names(points).count(name) == 0) return {};
    std::vector<Vec3d> out(points.size());
    if (!points.grid) {
        const auto columns = *columns_of(*points.ply, name);
        for (std::size_t n = 0; n < out.size(); ++n)
            for (int axis = 0; axis < 3; ++axis)
                out[n][axis] = PointTable::number(
                    points.ply->columns[columns[static_cast<std::size_t>(axis)]], n);
        return out;
    }
    const auto& tree = static_cast<const PointDataGrid&>(*points.grid).tree();
    each_leaf(tree, name, [&](const auto& leaf, std::size_t place, std::size_t first) {
        const auto& array = *leaf.attributeSet().getConst(place);
        const auto read = [&](const auto& values) {
            for (Index n = 0; n < array.size(); ++n) out[first + n] = Vec3d(values.get(n));
        };
        if (array.valueType() == openvdb::typeNameAsString<Vec3f>())
            read(AttributeHandle<Vec3f>(array));
        else read(AttributeHandle<Vec3d>(array));
    });
    return out;
}

Points with_vectors(const Points& points, const std::string& name,
                    const std::vector<Vec3d>& vectors) {
    auto out = points;
    if (!points.grid) {
        auto table = std::make_shared<PointTable>(*points.ply);
        const auto columns = *columns_of(*table, name);
        for (std::size_t n = 0; n < vectors.size(); ++n)
            for (int axis = 0; axis < 3; ++axis)
                PointTable::set(table->columns[columns[static_cast<std::size_t>(axis)]], n,
                                vectors[n][axis]);
        out.ply = std::move(table);
        return out;
    }
    const auto tree =
        std::make_shared<PointDataTree>(static_cast<const PointDataGrid&>(*points.grid).tree());
    each_leaf(*tree, name, [&](auto& leaf, std::size_t place, std::size_t first) {
        auto& array = leaf.attributeArray(place);
        array.expand();
        const auto write = [&]<class Vector>(Vector) {
            AttributeWriteHandle<Vector> values(array);
            for (Index n = 0; n < array.size(); ++n) values.set(n, Vector(vectors[first + n]));
        };
        if (array.valueType() == openvdb::typeNameAsString<Vec3f>()) write(Vec3f{});
        else write(Vec3d{});
    });
    // Share the transform: a copied map would move points by rounding errors.
    const auto grid =
        std::const_pointer_cast<openvdb::GridBase>(points.grid->copyGridReplacingTransform(
            std::const_pointer_cast<openvdb::math::Transform>(points.grid->transformPtr())));
    grid->setTree(tree);
    out.grid = grid;
    return out;
}

}  // namespace fluidcarve
