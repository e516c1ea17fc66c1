#include "carve/points/point_grid.h"

#include "carve/base/each_in_parallel.h"
#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/field/extent.h"

#include <fmt/format.h>
#include <openvdb/points/PointDataGrid.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>

namespace fluidcarve {
namespace {

using openvdb::Coord;
using openvdb::Index;
using openvdb::Vec3d;
using openvdb::Vec3f;
using namespace openvdb::points;
using Leaf = PointDataTree::LeafNodeType;
using Positions = AttributeHandle<Vec3f>;

const PointDataGrid& as_points(const openvdb::GridBase& grid) {
    return static_cast<const PointDataGrid&>(grid);
}

/// The leaves of a grid, and the index of the first point of each.
struct Leaves {
    std::vector<const Leaf*> all;
    std::vector<std::size_t> first{0};

    explicit Leaves(const openvdb::GridBase& grid) { add(grid); }
    void add(const openvdb::GridBase& grid) {
        for (auto leaf = as_points(grid).tree().cbeginLeaf(); leaf; ++leaf) {
            all.push_back(&*leaf);
            first.push_back(first.back() + leaf->pointCount());
        }
    }
    std::size_t size() const { return first.back(); }

    /// Calls `visit(leaf, index of the leaf)` for all leaves, in parallel.
    template <class Visit>
    void each(const Visit& visit) const {
        each_in_parallel(all.size(), 1, [&](std::size_t n) { visit(*all[n], n); });
    }
};

/// Calls `visit(point, voxel)` for all points of a leaf, with indices within the leaf.
template <class Visit>
void each_point(const Leaf& leaf, const Visit& visit) {
    Index point = 0;
    for (Index voxel = 0; voxel < Leaf::SIZE; ++voxel)
        for (const Index end = leaf.getValue(voxel); point < end; ++point) visit(point, voxel);
}

template <class T>
std::optional<std::uint64_t> whole_number(const AttributeArray& ids, Index point) {
    if (ids.valueType() != openvdb::typeNameAsString<T>()) return std::nullopt;
    return static_cast<std::uint64_t>(AttributeHandle<T>(ids).get(point));
}

/// Index pairs for AttributeArray::copyValuesUnsafe.
struct CopyRun {
    const std::vector<std::pair<Index, Index>>* pairs;  ///< source, target
    std::size_t at = 0;
    explicit operator bool() const { return at < pairs->size(); }
    CopyRun& operator++() {
        ++at;
        return *this;
    }
    Index sourceIndex() const { return (*pairs)[at].first; }
    Index targetIndex() const { return (*pairs)[at].second; }
};

/// The points of one leaf of the result.
struct Gathered {
    struct Point {
        Index voxel;
        Index point;       ///< index in its source leaf
        std::size_t leaf;  ///< index of the source leaf
        bool moved;
        Vec3f within;  ///< position relative to the voxel centre, in voxels, if it moved
    };
    Coord origin;
    std::vector<Point> points;
};

std::vector<Gathered> gather(const openvdb::GridBase& grid, const Leaves& leaves,
                             const std::vector<PointImage>& images) {
    std::vector<Gathered> out;
    std::unordered_map<Coord, std::size_t> places;
    std::size_t leaf = 0, known = leaves.all.size();
    std::vector<Index> voxels;
    for (const auto& image : images) {
        while (image.source >= leaves.first[leaf + 1]) ++leaf;
        const auto& from = *leaves.all[leaf];
        if (known != leaf) {
            voxels.clear();
            each_point(from, [&](Index, Index voxel) { voxels.push_back(voxel); });
            known = leaf;
        }
        const auto point = static_cast<Index>(image.source - leaves.first[leaf]);
        Gathered::Point entry{voxels[point], point, leaf, image.moved, {}};
        auto origin = from.origin();
        if (image.moved) {
            const auto at = grid.transform().worldToIndex(image.position);
            if (!voxel_at(at))
                throw Failure(fmt::format(
                    "a point of grid '{}' is moved beyond all voxels; check the lattice",
                    grid.getName()));
            const auto voxel = Coord::round(at);
            origin = voxel & ~static_cast<std::int32_t>(Leaf::DIM - 1);
            entry.voxel = Leaf::coordToOffset(voxel);
            entry.within = Vec3f(at - voxel.asVec3d());
        }
        const auto place = places.try_emplace(origin, out.size()).first->second;
        if (place == out.size()) out.push_back({origin, {}});
        out[place].points.push_back(entry);
    }
    return out;
}

bool unchanged(const Gathered& gathered, const Leaves& leaves) {
    const auto leaf = gathered.points.front().leaf;
    return gathered.points.size() == leaves.all[leaf]->pointCount() &&
           std::ranges::all_of(gathered.points, [&](const auto& point) {
               return point.leaf == leaf && !point.moved;
           });
}

/// Copies the values of an attribute from the leaves that points come from.
/// @param runs  for each of the leaves
void copy_values(const Leaves& leaves,
                 const std::unordered_map<std::size_t, std::vector<std::pair<Index, Index>>>& runs,
                 std::size_t attribute, AttributeArray& to) {
    to.expand();
    bool uniform = true;
    for (const auto& [leaf, pairs] : runs) {
        const auto& source = *leaves.all[leaf]->attributeSet().getConst(attribute);
        uniform = uniform && source.isUniform();
        // A uniform array stores one value, but copyValuesUnsafe reads as many as the stride.
        AttributeArray::Ptr whole;
        if (source.isUniform() && source.stride() > 1) {
            whole = source.copy();
            whole->expand();
        }
        to.copyValuesUnsafe(whole ? *whole : source, CopyRun{&pairs});
    }
    if (uniform) to.compact();
}

std::unique_ptr<Leaf> made(Gathered& gathered, const Leaves& leaves,
                           const AttributeArray::ScopedRegistryLock& lock) {
    auto& points = gathered.points;
    std::ranges::stable_sort(points,
                             [](const auto& a, const auto& b) { return a.voxel < b.voxel; });
    const auto& like = leaves.all[points.front().leaf]->attributeSet();
    auto set = std::make_unique<AttributeSet>(like, static_cast<Index>(points.size()), &lock);

    std::unordered_map<std::size_t, std::vector<std::pair<Index, Index>>> runs;
    for (std::size_t n = 0; n < points.size(); ++n)
        runs[points[n].leaf].emplace_back(points[n].point, static_cast<Index>(n));
    for (std::size_t n = 0; n < set->size(); ++n) copy_values(leaves, runs, n, *set->get(n));
    AttributeWriteHandle<Vec3f> positions(*set->get("P"));
    for (std::size_t n = 0; n < points.size(); ++n)
        if (points[n].moved) positions.set(static_cast<Index>(n), points[n].within);

    std::vector<Leaf::ValueType> ends(Leaf::SIZE);
    for (std::size_t voxel = 0, n = 0; voxel < Leaf::SIZE; ++voxel) {
        while (n < points.size() && points[n].voxel == voxel) ++n;
        ends[voxel] = static_cast<Index>(n);
    }
    auto out = std::make_unique<Leaf>(gathered.origin);
    out->replaceAttributeSet(set.release(), true);
    out->setOffsets(ends);
    return out;
}

/// Checks the leaves of a grid, one after the other.
template <class Refuse>
class SoundLeaves {
public:
    /// @param refuse  throws, with a text that says what is wrong
    explicit SoundLeaves(const Refuse& refuse) : refuse(refuse) {}

    void require(const Leaf& leaf) {
        try {
            leaf.validateOffsets();
        } catch (const openvdb::Exception& error) {
            refuse(error.what());
        }
        const auto& set = leaf.attributeSet();
        const auto* const positions = set.getConst("P");
        if (!positions || positions->valueType() != openvdb::typeNameAsString<Vec3f>() ||
            positions->stride() != 1)
            refuse("it has no attribute P of type vec3s, which holds the positions");
        if (first_ && &first_->descriptor() != &set.descriptor() &&
            first_->descriptor() != set.descriptor())
            refuse("its points have other attributes here than there");
        first_ = first_ ? first_ : &set;
        for (std::size_t n = 0; n < set.size(); ++n)
            require_values(leaf, *set.getConst(n), first_->getConst(n)->stride());
        const Positions handle(*positions);
        each_point(leaf, [&](Index point, Index voxel) {
            if (openvdb::math::isFinite(handle.get(point))) return;
            refuse(fmt::format("the position of a point in voxel {} is not finite",
                               place_of(leaf.offsetToGlobalCoord(voxel))));
        });
    }

    const Refuse refuse;

private:
    static std::string place_of(const Coord& at) { return fmt::format("[{}]", numbers_text(at)); }

    /// @param stride  of the attribute in the first leaf
    void require_values(const Leaf& leaf, const AttributeArray& array, Index stride) const {
        // A uniform array can state any number of points without using memory.
        constexpr std::uint64_t values_per_byte = 16;
        if (!array.hasConstantStride())
            refuse("it has an attribute of a length that varies from point to point");
        if (array.stride() < 1 || array.stride() != stride)
            refuse("it has an attribute of other lengths here than there");
        if (array.size() != leaf.pointCount())
            refuse(fmt::format("it counts {} points at {}, but has {} values", leaf.pointCount(),
                               place_of(leaf.origin()), array.size()));
        const auto values = std::uint64_t{array.size()} * array.stride(),
                   most = values_per_byte * leaf.memUsage();
        if (values > most)
            refuse(
                fmt::format("it states {} values in the voxels from {}, more than the {} that "
                            "as many bytes can mean",
                            values, place_of(leaf.origin()), most));
    }

    const AttributeSet* first_ = nullptr;  ///< of the first leaf
};

}  // namespace

void require_sound(const openvdb::GridBase& grid, const std::string& path) {
    SoundLeaves leaves([&](const std::string& fault) {
        throw Failure(fmt::format("{} is damaged: grid '{}': {}", path, grid.getName(), fault),
                      Failure::Kind::input);
    });
    std::uint64_t count = 0;
    for (auto leaf = as_points(grid).tree().cbeginLeaf(); leaf; ++leaf) {
        leaves.require(*leaf);
        count += leaf->pointCount();
    }
    if (count > 0xffffffffu)
        leaves.refuse(fmt::format("it has {} points; the most is {}", count, 0xffffffffu));
}

std::size_t point_count(const openvdb::GridBase& grid) { return Leaves(grid).size(); }

std::vector<Vec3d> point_positions(const openvdb::GridBase& grid) {
    const Leaves leaves(grid);
    std::vector<Vec3d> out(leaves.size());
    leaves.each([&](const Leaf& leaf, std::size_t n) {
        const Positions positions(*leaf.attributeSet().getConst("P"));
        each_point(leaf, [&](Index point, Index voxel) {
            out[leaves.first[n] + point] = grid.indexToWorld(
                leaf.offsetToGlobalCoord(voxel).asVec3d() + Vec3d(positions.get(point)));
        });
    });
    return out;
}

std::vector<std::uint64_t> point_identities(const openvdb::GridBase& grid) {
    const Leaves leaves(grid);
    std::vector<std::uint64_t> out(leaves.size());
    leaves.each([&](const Leaf& leaf, std::size_t n) {
        const Positions positions(*leaf.attributeSet().getConst("P"));
        const auto* const ids = leaf.attributeSet().getConst("id");
        each_point(leaf, [&](Index point, Index voxel) {
            auto& identity = out[leaves.first[n] + point];
            for (int c = 0; c < 3; ++c)
                identity =
                    identity * 0x100000001b3u +
                    std::bit_cast<std::uint64_t>(leaf.offsetToGlobalCoord(voxel)[c] +
                                                 static_cast<double>(positions.get(point)[c]));
            if (!ids || ids->stride() != 1) return;
            auto id = whole_number<std::int32_t>(*ids, point);
            if (!id) id = whole_number<std::int64_t>(*ids, point);
            identity = id.value_or(identity);
        });
    });
    return out;
}

bool has_point_ids(const openvdb::GridBase& grid) {
    const auto leaf = as_points(grid).tree().cbeginLeaf();
    const auto* const ids = leaf ? leaf->attributeSet().getConst("id") : nullptr;
    return ids && ids->stride() == 1 &&
           (ids->valueType() == openvdb::typeNameAsString<std::int32_t>() ||
            ids->valueType() == openvdb::typeNameAsString<std::int64_t>());
}

bool alike(const openvdb::GridBase& a, const openvdb::GridBase& b) {
    const auto x = as_points(a).tree().cbeginLeaf(), y = as_points(b).tree().cbeginLeaf();
    return !x || !y || x->attributeSet().descriptor() == y->attributeSet().descriptor();
}

openvdb::GridBase::ConstPtr with_images(const openvdb::GridBase& grid,
                                        const std::vector<PointImage>& images,
                                        const openvdb::GridBase* more) {
    Leaves leaves(grid);
    if (more) leaves.add(*more);
    auto gathered = gather(grid, leaves, images);
    std::vector<std::unique_ptr<Leaf>> made_leaves(gathered.size());
    const AttributeArray::ScopedRegistryLock lock;
    each_in_parallel(gathered.size(), 1, [&](std::size_t n) {
        made_leaves[n] = unchanged(gathered[n], leaves)
                             ? std::make_unique<Leaf>(*leaves.all[gathered[n].points.front().leaf])
                             : made(gathered[n], leaves, lock);
    });
    const auto tree = std::make_shared<PointDataTree>(as_points(grid).background());
    for (auto& leaf : made_leaves) tree->addLeaf(leaf.release());
    // Share the transform: a copy of a map computes its inverse again.
    const auto out = std::const_pointer_cast<openvdb::GridBase>(grid.copyGridReplacingTransform(
        std::const_pointer_cast<openvdb::math::Transform>(grid.transformPtr())));
    out->setTree(tree);
    return out;
}

}  // namespace fluidcarve
