#include "carve/base/failure.h"
#include "carve/points/point_grid.h"
#include "carve/volume/cubes.h"

#include <fmt/format.h>
#include <openvdb/points/PointDataGrid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace fluidcarve {
namespace {

using openvdb::Coord;
using openvdb::Index;
using openvdb::Vec3d;
using openvdb::Vec3f;
using openvdb::Vec3i;
using namespace openvdb::points;
using Leaf = PointDataTree::LeafNodeType;

template <class T>
constexpr bool is_vector = openvdb::VecTraits<T>::IsVec;

/// Calls `visit(T{})` with the C++ type of an OpenVDB attribute type.
/// @return false if PLY can't hold the type
template <class Visit>
bool with_value_type(const openvdb::Name& name, const Visit& visit) {
    const auto one = [&](auto value) {
        if (name != openvdb::typeNameAsString<decltype(value)>()) return false;
        visit(value);
        return true;
    };
    return one(float{}) || one(Vec3f{}) || one(std::int32_t{}) || one(double{}) || one(Vec3d{}) ||
           one(Vec3i{}) || one(std::int16_t{}) || one(std::int8_t{}) || one(bool{});
}

template <class T>
constexpr std::pair<NumberType, const char*> ply_type() {
    if constexpr (std::is_same_v<T, float>) return {NumberType::float32, "float"};
    else if constexpr (std::is_same_v<T, double>) return {NumberType::float64, "double"};
    else if constexpr (std::is_same_v<T, std::int32_t>) return {NumberType::int32, "int"};
    else if constexpr (std::is_same_v<T, std::int16_t>) return {NumberType::int16, "short"};
    else if constexpr (std::is_same_v<T, std::int8_t>) return {NumberType::int8, "char"};
    else return {NumberType::uint8, "uchar"};
}

/// Adds the columns of an attribute.
/// @param suffix  suffix of a column's name, per component of a vector
template <class T>
void add_columns(PointTable& out, const std::string& name,
                 const std::array<const char*, 3>& suffix = {"_x", "_y", "_z"}) {
    const auto add = [&](auto value, const std::string& full) {
        const auto [type, type_name] = ply_type<decltype(value)>();
        out.columns.push_back({full, type_name, type, {}});
        out.columns.back().values.reserve(out.size * sizeof value);
    };
    if constexpr (is_vector<T>)
        for (const auto* const each : suffix)
            add(typename openvdb::VecTraits<T>::ElementType{}, name + each);
    else add(T{}, name);
}

template <class T>
void append(PointTable::Column& column, T value) {
    const auto* const from = reinterpret_cast<const char*>(&value);
    column.values.insert(column.values.end(), from, from + sizeof value);
}

/// The columns that form one attribute: one, or three for a vector.
struct Source {
    std::string name;
    std::vector<std::size_t> columns;
};

/// Groups all columns but the position into attributes.
std::vector<Source> sources_of(const PointTable& points) {
    std::vector<Source> out;
    const auto place = [&](const std::string& name) {
        const auto* const found = points.column(name);
        return found ? static_cast<std::size_t>(found - points.columns.data())
                     : points.columns.size();
    };
    for (std::size_t n = 0; n < points.columns.size(); ++n) {
        const auto& [name, type_name, type, values] = points.columns[n];
        if (name == "x" || name == "y" || name == "z") continue;
        const auto base = name.size() > 2 ? name.substr(0, name.size() - 2) : std::string();
        const auto x = place(base + "_x"), y = place(base + "_y"), z = place(base + "_z"),
                   none = points.columns.size();
        const bool vector = (n == x || n == y || n == z) && !base.empty() && x != none &&
                            y != none && z != none &&
                            points.columns[y].type == points.columns[x].type &&
                            points.columns[z].type == points.columns[x].type &&
                            (points.columns[x].type == NumberType::float32 ||
                             points.columns[x].type == NumberType::float64 ||
                             points.columns[x].type == NumberType::int32);
        if (!vector) out.push_back({name, {n}});
        else if (n == std::min({x, y, z})) out.push_back({base, {x, y, z}});
    }
    return out;
}

/// Calls `visit(T{})` with the C++ type of the attribute for PLY values of this type.
template <class Visit>
void with_attribute_type(NumberType type, bool vector, const Visit& visit) {
    switch (type) {
        case NumberType::float32: return vector ? visit(Vec3f{}) : visit(float{});
        case NumberType::float64: return vector ? visit(Vec3d{}) : visit(double{});
        case NumberType::int32: return vector ? visit(Vec3i{}) : visit(std::int32_t{});
        case NumberType::int8: return visit(std::int8_t{});
        case NumberType::uint8:
        case NumberType::int16: return visit(std::int16_t{});
        case NumberType::uint16: return visit(std::int32_t{});
        case NumberType::uint32: return visit(std::int64_t{});
    }
}

double voxel_size_of(const Vec3d& size, std::size_t count) {
    constexpr double points_per_voxel = 8;
    const double longest = std::max({size.x(), size.y(), size.z()});
    if (!(longest > 0)) return 1;
    // Points that almost lie in a plane or on a line would give very small voxels.
    double volume = 1;
    for (int n = 0; n < 3; ++n) volume *= std::max(size[n], longest / 1000);
    return std::cbrt(volume * points_per_voxel / static_cast<double>(count));
}

/// A transform with its origin near the centre of the points, since index coordinates are limited.
openvdb::math::Transform::Ptr transform_around(const std::vector<Vec3d>& positions) {
    if (positions.empty()) return openvdb::math::Transform::createLinearTransform(1);
    openvdb::BBoxd box;
    for (const auto& at : positions) box.expand(at);
    const double voxel = std::max(least_voxel, voxel_size_of(box.extents(), positions.size()));
    const auto out = cubes_of(voxel);
    const auto middle = box.getCenter() / voxel;
    out->postTranslate(
        voxel * Vec3d(std::round(middle.x()), std::round(middle.y()), std::round(middle.z())));
    return out;
}

/// Makes a grid of a table's points.
class GridOfTable {
public:
    explicit GridOfTable(const PointTable& points)
        : points_(points),
          sources_(sources_of(points)),
          like_(AttributeSet::Descriptor::create(TypedAttributeArray<Vec3f>::attributeType()), 1) {
        for (std::size_t n = 0; n < points.size; ++n) positions_.push_back(points.position(n));
        grid_->setTransform(transform_around(positions_));
        grid_->setName("points");
    }

    openvdb::GridBase::Ptr make() {
        auto leaves = rows_of_leaves();
        for (const auto& source : sources_) add_attribute(source);
        for (auto& [origin, rows] : leaves) {
            std::ranges::stable_sort(
                rows, [](const auto& a, const auto& b) { return a.first < b.first; });
            grid_->tree().addLeaf(leaf_of(origin, rows).release());
        }
        return grid_;
    }

private:
    /// The voxel of each point of a leaf, and its row in the table.
    using Rows = std::vector<std::pair<Index, std::size_t>>;

    /// The points of each leaf, by the leaf's origin.
    std::map<Coord, Rows> rows_of_leaves() const {
        std::map<Coord, Rows> out;
        for (std::size_t n = 0; n < points_.size; ++n) {
            const auto at = grid_->worldToIndex(positions_[n]);
            if (!(at.length() < 1e9))
                throw Failure(fmt::format(
                    "vertex {} is too far from the others to share a VDB grid with them", n));
            const auto voxel = Coord::round(at);
            out[voxel & ~static_cast<std::int32_t>(Leaf::DIM - 1)].emplace_back(
                Leaf::coordToOffset(voxel), n);
        }
        return out;
    }

    /// Calls `visit(T{})` with the C++ type of an attribute.
    template <class Visit>
    void with_type(const Source& source, const Visit& visit) const {
        with_attribute_type(points_.columns[source.columns[0]].type, source.columns.size() == 3,
                            visit);
    }

    void add_attribute(const Source& source) {
        if (!AttributeSet::Descriptor::validName(source.name) ||
            like_.find(source.name) != AttributeSet::INVALID_POS)
            throw Failure(
                fmt::format("the PLY property '{}' can't be the name of a VDB attribute; write a "
                            "PLY file, or name it otherwise",
                            source.name));
        with_type(source, [&](auto value) {
            like_.appendAttribute(source.name,
                                  TypedAttributeArray<decltype(value)>::attributeType());
        });
    }

    std::unique_ptr<Leaf> leaf_of(const Coord& origin, const Rows& rows) const {
        auto set = std::make_unique<AttributeSet>(like_, static_cast<Index>(rows.size()));
        AttributeWriteHandle<Vec3f> within(*set->get("P"));
        std::vector<Leaf::ValueType> ends(Leaf::SIZE);
        for (std::size_t n = 0; n < rows.size(); ++n) {
            const auto& [voxel, row] = rows[n];
            within.set(static_cast<Index>(n),
                       Vec3f(grid_->worldToIndex(positions_[row]) -
                             (origin + Leaf::offsetToLocalCoord(voxel)).asVec3d()));
            ends[voxel] = static_cast<Index>(n + 1);
        }
        for (std::size_t n = 1; n < ends.size(); ++n)
            ends[n] = std::max<Index>(ends[n], ends[n - 1]);
        for (const auto& source : sources_) fill(*set->get(source.name), source, rows);
        auto out = std::make_unique<Leaf>(origin);
        out->replaceAttributeSet(set.release(), true);
        out->setOffsets(ends);
        return out;
    }

    void fill(AttributeArray& array, const Source& source, const Rows& rows) const {
        with_type(source, [&](auto value) {
            using T = decltype(value);
            AttributeWriteHandle<T> handle(array);
            for (std::size_t n = 0; n < rows.size(); ++n) {
                const auto number = [&](std::size_t c) {
                    return PointTable::number(points_.columns[source.columns[c]], rows[n].second);
                };
                if constexpr (is_vector<T>) value = T(Vec3d(number(0), number(1), number(2)));
                else value = static_cast<T>(number(0));
                handle.set(static_cast<Index>(n), value);
            }
        });
        array.compact();
    }

    const PointTable& points_;
    const std::vector<Source> sources_;
    AttributeSet like_;  ///< of every leaf
    std::vector<Vec3d> positions_;
    const PointDataGrid::Ptr grid_ = PointDataGrid::create();
};

/// Makes the columns of an attribute, if PLY can hold its type.
/// @param place  of the attribute in the set of each leaf
bool take_columns(PointTable& out, const PointDataGrid& grid, const std::string& name,
                  std::size_t place) {
    const auto& set = grid.tree().cbeginLeaf()->attributeSet();
    const auto& like = *set.getConst(place);
    const auto stride = like.stride();
    return !isString(like) && with_value_type(set.descriptor().valueType(place), [&](auto value) {
        using T = decltype(value);
        for (Index m = 0; m < stride; ++m) {
            const auto columns = out.columns.size();
            add_columns<T>(out, stride == 1 ? name : fmt::format("{}_{}", name, m));
            for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
                const AttributeHandle<T> handle(*leaf->attributeSet().getConst(place));
                for (Index n = 0; n < leaf->pointCount(); ++n) {
                    const T each = handle.get(n, m);
                    if constexpr (is_vector<T>)
                        for (std::size_t c = 0; c < 3; ++c)
                            append(out.columns[columns + c], each[static_cast<int>(c)]);
                    else append(out.columns[columns], each);
                }
            }
        }
    });
}

}  // namespace

openvdb::GridBase::Ptr grid_of(const PointTable& points) {
    openvdb::initialize();
    return GridOfTable(points).make();
}

PointTable ply_of(const openvdb::GridBase& base, std::vector<std::string>& left_out) {
    const auto& grid = static_cast<const PointDataGrid&>(base);
    PointTable out;
    out.size = point_count(base);
    add_columns<Vec3d>(out, "", {"x", "y", "z"});
    for (const auto& at : point_positions(base))
        for (int c = 0; c < 3; ++c) append(out.columns[static_cast<std::size_t>(c)], at[c]);
    const auto first = grid.tree().cbeginLeaf();
    if (!first) return out;

    const auto& descriptor = first->attributeSet().descriptor();
    std::map<std::size_t, std::string> attributes;
    for (const auto& [name, place] : descriptor.map())
        if (name != "P" && !isGroup(*first->attributeSet().getConst(place)))
            attributes[place] = name;
    for (const auto& [place, name] : attributes)
        if (!take_columns(out, grid, name, place)) left_out.push_back(name);
    for (const auto& [name, offset] : descriptor.groupMap()) {
        add_columns<bool>(out, "group_" + name);
        for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
            const auto handle = leaf->groupHandle(name);
            for (Index n = 0; n < leaf->pointCount(); ++n)
                append(out.columns.back(), handle.getUnsafe(n));
        }
    }
    return out;
}

}  // namespace fluidcarve
