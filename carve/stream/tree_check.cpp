#include "carve/stream/tree_check.h"

#include "carve/base/find_or_null.h"
#include "carve/stream/point_check.h"
#include "carve/stream/tree_bytes.h"

#include <openvdb/io/Compression.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <map>
#include <set>
#include <string_view>
#include <vector>

namespace fluidcarve {
namespace {

using openvdb::Coord;

/// Log2 of the number of children along an edge of an internal node, by level: 1 holds leaves, 2
/// holds nodes of level 1.
constexpr std::array<int, 3> log2_dim{3, 4, 5};
constexpr std::size_t slots(std::size_t level) { return std::size_t{1} << (3 * log2_dim[level]); }
/// Voxels that a tile in a node of this level stands for.
constexpr std::uint64_t tile_voxels(std::size_t level) {
    std::uint64_t out = 1;
    for (std::size_t below = 0; below < level; ++below) out *= slots(below);
    return out;
}

std::uint64_t count_on(std::span<const char> mask) {
    std::uint64_t out = 0;
    for (const auto byte : mask)
        out += static_cast<std::uint64_t>(std::popcount(static_cast<unsigned char>(byte)));
    return out;
}

/// Reads a tree's bytes as OpenVDB does, and checks them.
class TreeCheck {
public:
    TreeCheck(const TreeFormat& format, std::span<const char> topology)
        : format_(format), in_(topology) {
        root();
    }

    const TreeSize& size() const { return size_; }
    /// Value masks of all leaves, in the order in which their buffers are read.
    const std::vector<std::span<const char>>& leaves() const { return leaves_; }
    std::uint64_t left() const { return in_.left(); }  ///< bytes
    void require_end(std::string_view fault) const { in_.require(in_.left() == 0, fault); }
    /// Continues with buffers that do not follow the topology.
    void go_on(std::span<const char> bytes) { in_ = TreeBytes(bytes); }

    void buffers() {
        if (format_.leaves == TreeFormat::Leaves::point_data) check_points(in_, leaves_);
        else
            for (const auto& mask : leaves_) leaf(mask);
    }

private:
    bool old() const {
        return format_.file_version < openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION;
    }

    void root() {
        in_.skip(sizeof(std::int32_t));  // number of buffers: OpenVDB reads it and moves on
        value();                         // background
        const auto tiles = in_.number<std::uint32_t>(), children = in_.number<std::uint32_t>();
        constexpr auto whole = std::int32_t{1} << (log2_dim[0] + log2_dim[1] + log2_dim[2]);
        std::set<Coord> places;
        const auto place = [&] {
            const Coord at(in_.number<std::array<std::int32_t, 3>>().data());
            in_.require(at.x() % whole == 0 && at.y() % whole == 0 && at.z() % whole == 0,
                        "a child of its root lies between the places for children");
            in_.require(places.insert(at).second, "two children of its root lie at the same place");
            return at;
        };
        for (std::uint32_t n = 0; n < tiles; ++n) {
            place();
            value();
            const auto active = in_.number<std::uint8_t>();
            in_.require(active <= 1, "the state of a tile is neither on nor off");
            size_.active_voxels += active * tile_voxels(3);
        }
        // Buffers come in the order of the root's map, not of the topology.
        std::map<Coord, std::vector<std::span<const char>>> leaves;
        for (std::uint32_t n = 0; n < children; ++n) {
            const auto at = place();
            node<2>();
            leaves[at].swap(leaves_);
        }
        for (const auto& [at, masks] : leaves)
            leaves_.insert(leaves_.end(), masks.begin(), masks.end());
    }

    /// A background or the value of a root's tile. In trees of points it can only be 0: other
    /// values are offsets into a leaf's points.
    void value() {
        const auto bytes = in_.take(format_.value_bytes);
        if (format_.leaves != TreeFormat::Leaves::point_data) return;
        in_.require(std::ranges::all_of(bytes, [](char byte) { return byte == 0; }),
                    "it has points outside of its leaves");
    }

    template <std::size_t level>
    void node() {
        if constexpr (level == 0) {
            leaves_.push_back(in_.take(slots(0) / 8));
            size_.active_voxels += count_on(leaves_.back());
            size_.bytes += slots(0) * format_.value_bytes + leaf_overhead;
        } else {
            const auto children = in_.take(slots(level) / 8), values = in_.take(slots(level) / 8);
            for (std::size_t n = 0; n < children.size(); ++n)
                in_.require((children[n] & values[n]) == 0,
                            "a node has a child and a value at the same place");
            const auto child_count = count_on(children), on = count_on(values);
            size_.active_voxels += on * tile_voxels(level);
            size_.bytes += slots(level) * std::max(format_.value_bytes, sizeof(void*));
            chunk(old() ? slots(level) - child_count : slots(level), on, slots(level));
            for (std::uint64_t n = 0; n < child_count; ++n) node<level - 1>();
        }
    }

    void leaf(std::span<const char> mask) {
        using Leaves = TreeFormat::Leaves;
        in_.skip(mask.size());
        constexpr auto origin = 3 * sizeof(std::int32_t);
        if (format_.leaves == Leaves::masks) return in_.skip(origin);
        if (format_.leaves == Leaves::bools) return in_.skip(origin + slots(0) / 8);
        if (old()) {
            in_.skip(origin);
            in_.require(in_.number<std::int8_t>() <= 1, "a leaf has several buffers");
        }
        chunk(slots(0), count_on(mask), slots(0));
    }

    /// The values of a node.
    /// @param count  number of values without mask compression
    /// @param on     number of active values
    void chunk(std::uint64_t count, std::uint64_t on, std::uint64_t mask_bits) {
        using namespace openvdb::io;
        if (!old()) {
            const auto kind = in_.number<std::int8_t>();
            in_.require(kind >= NO_MASK_OR_INACTIVE_VALS && kind <= NO_MASK_AND_ALL_VALS,
                        "a node's values are stored in an unknown way");
            if (kind == NO_MASK_AND_ONE_INACTIVE_VAL || kind == MASK_AND_ONE_INACTIVE_VAL)
                in_.skip(format_.value_bytes);
            if (kind == MASK_AND_TWO_INACTIVE_VALS) in_.skip(2 * format_.value_bytes);
            if (kind == MASK_AND_NO_INACTIVE_VALS || kind == MASK_AND_ONE_INACTIVE_VAL ||
                kind == MASK_AND_TWO_INACTIVE_VALS)
                in_.skip(mask_bits / 8);
            if ((format_.compression & COMPRESS_ACTIVE_MASK) && kind != NO_MASK_AND_ALL_VALS)
                count = on;
        }
        // If there are no values, OpenVDB reads nothing at all for half floats.
        if (count == 0 && format_.stored_bytes < format_.value_bytes) return;
        in_.skip_data(count * format_.stored_bytes, format_.compression);
    }

    static constexpr std::uint64_t leaf_overhead = 96;  ///< mask, origin, buffer

    const TreeFormat& format_;
    TreeBytes in_;
    TreeSize size_;
    std::vector<std::span<const char>> leaves_;
};

struct KnownTree {
    std::string type;
    TreeFormat::Leaves leaves;
    std::size_t value_bytes, half_bytes;
};

const KnownTree* known_tree(const std::string& type) {
    using Leaves = TreeFormat::Leaves;
    static const std::vector<KnownTree> all{
        {openvdb::FloatTree::treeType(), Leaves::values, 4, 2},
        {openvdb::DoubleTree::treeType(), Leaves::values, 8, 2},
        {openvdb::Vec3STree::treeType(), Leaves::values, 12, 6},
        {openvdb::Vec3DTree::treeType(), Leaves::values, 24, 6},
        {openvdb::Int32Tree::treeType(), Leaves::values, 4, 4},
        {openvdb::Int64Tree::treeType(), Leaves::values, 8, 8},
        {openvdb::Vec3ITree::treeType(), Leaves::values, 12, 12},
        {openvdb::BoolTree::treeType(), Leaves::bools, 1, 1},
        {openvdb::MaskTree::treeType(), Leaves::masks, 1, 1},
        {"Tree_ptdataidx32_5_4_3", Leaves::point_data, 4, 4}};
    return find_or_null(all, type, &KnownTree::type);
}

}  // namespace

bool is_known_tree(const std::string& type) {
    return known_tree(type) && openvdb::GridBase::isRegistered(type);
}

TreeFormat tree_format(const std::string& type, bool half, std::uint32_t file_version,
                       std::uint32_t compression) {
    const auto& known = *known_tree(type);
    return {known.leaves, known.value_bytes, half ? known.half_bytes : known.value_bytes,
            file_version, compression};
}

TreeSize size_of_tree(const TreeFormat& format, std::span<const char> topology) {
    return TreeCheck(format, topology).size();
}

TreeLength length_of_tree(const TreeFormat& format, std::span<const char> bytes) {
    TreeCheck check(format, bytes);
    const auto behind_topology = check.left();
    check.buffers();
    return {static_cast<std::int64_t>(bytes.size() - behind_topology),
            static_cast<std::int64_t>(behind_topology - check.left())};
}

TreeSize check_tree(const TreeFormat& format, std::span<const char> topology,
                    std::span<const char> buffers) {
    TreeCheck check(format, topology);
    check.require_end("its topology is shorter than stated");
    check.go_on(buffers);
    check.buffers();
    check.require_end("its buffers are shorter than stated");
    return check.size();
}

TreeSize check_tree(const TreeFormat& format, std::span<const char> bytes) {
    TreeCheck check(format, bytes);
    check.buffers();
    return check.size();
}

}  // namespace fluidcarve
