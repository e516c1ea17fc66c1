#include "tools/compare/grids.h"

#include "carve/base/words.h"
#include "carve/field/same_transform.h"
#include "carve/points/point_grid.h"
#include "carve/stream/raw_grid.h"
#include "carve/volume/grid_types.h"

#include <openvdb/points/PointDataGrid.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <type_traits>

namespace fluidcarve {
namespace {

using openvdb::Coord;
using openvdb::GridBase;

template <class T>
constexpr bool is_vector = openvdb::VecTraits<T>::IsVec;

template <class T>
double difference(const T& a, const T& b) {
    if constexpr (is_vector<T>) {
        double squares = 0;
        for (int c = 0; c < 3; ++c) {
            const double part = difference_of(static_cast<double>(a[c]), static_cast<double>(b[c]));
            squares += part * part;
        }
        return std::sqrt(squares);
    } else if constexpr (std::is_same_v<T, std::int64_t>) {
        // Neighbours above 2^53 are one double.
        return static_cast<double>(
            std::abs(static_cast<long double>(a) - static_cast<long double>(b)));
    } else {
        return difference_of(static_cast<double>(a), static_cast<double>(b));
    }
}

template <class T>
double magnitude(const T& value) {
    if constexpr (is_vector<T>) return openvdb::Vec3d(value).length();
    else return std::abs(static_cast<double>(value));
}

template <class T>
std::vector<double> numbers(const T& value) {
    if constexpr (is_vector<T>)
        return {static_cast<double>(value[0]), static_cast<double>(value[1]),
                static_cast<double>(value[2])};
    else return {static_cast<double>(value)};
}

template <class T>
std::string text(const T& value) {
    const auto all = numbers(value);
    return all.size() == 1 ? fmt::format("{:g}", all[0]) : fmt::format("[{}]", numbers_text(all));
}

/// A value of a grid, and whether it is active.
template <class T>
struct Sample {
    T value;
    bool on;
};

/// The differences of some values, each at a place: a voxel, or the number of a point.
template <class Place>
struct Tally {
    PartDifference sums;
    Place at{};

    /// @param times  how many voxels have these two values
    template <class T>
    void see(const Place& place, std::uint64_t times, const Sample<T>& a, const Sample<T>& b,
             const Tolerance& tolerance) {
        const double apart = difference(a.value, b.value);
        const bool finite = std::isfinite(apart);
        sums.compared += times;
        if (finite) {
            sums.sum += apart * static_cast<double>(times);
            sums.squares += apart * apart * static_cast<double>(times);
        } else {
            sums.not_finite += times;
        }
        if (a.on != b.on) (a.on ? sums.only_a : sums.only_b) += times;
        auto allowed = tolerance.absolute;
        if (tolerance.relative > 0)
            allowed = std::max(
                allowed, tolerance.relative * std::max(magnitude(a.value), magnitude(b.value)));
        if (!finite || apart > allowed || (a.on != b.on && tolerance.none())) sums.over += times;
        if (apart > tolerance.warn) sums.warned += times;
        if ((apart > 0 || a.on != b.on) && better(apart, place)) {
            sums.peak = apart;
            sums.worst = WorstPlace{{}, {}, numbers(a.value), numbers(b.value)};
            at = place;
        }
    }

    void join(const Tally& other) {
        const bool theirs = other.sums.worst && better(other.sums.peak, other.at);
        sums.add_sums(other.sums);
        if (!theirs) return;
        sums.peak = other.sums.peak;
        sums.worst = other.sums.worst;
        at = other.at;
    }

private:
    bool better(double peak, const Place& place) const {
        return !sums.worst || peak > sums.peak || (peak == sums.peak && place < at);
    }
};

/// Walks two trees at once. Where both have tiles, they are compared as such.
template <class Tree>
class Walk {
public:
    using Leaf = typename Tree::LeafNodeType;
    using Value = typename Tree::ValueType;

    Walk(const Tree& a, const Tree& b, const Tolerance& tolerance)
        : a_(a), b_(b), at_a_(a), at_b_(b), tolerance_(tolerance) {}

    Tally<Coord> compare() {
        std::set<Coord> blocks;
        for (const auto* const tree : {&a_, &b_})
            for (auto block = tree->root().cbeginChildAll(); block; ++block)
                blocks.insert(block.getCoord());
        for (const auto& block : blocks) visit(block, 0);
        using Range = tbb::blocked_range<std::size_t>;
        constexpr std::size_t at_once = 64;
        // The order in which sums are added up is that of the ranges, however many threads there
        // are.
        const auto leaves = tbb::parallel_deterministic_reduce(
            Range(0, leaves_.size(), at_once), Tally<Coord>(),
            [&](const Range& range, Tally<Coord> tally) {
                for (auto n = range.begin(); n < range.end(); ++n)
                    compare_leaves(leaves_[n], tally);
                return tally;
            },
            [](Tally<Coord> left, const Tally<Coord>& right) { return left.join(right), left; });
        tiles_.join(leaves);
        return tiles_;
    }

private:
    using Upper = typename Tree::RootNodeType::ChildNodeType;
    using Lower = typename Upper::ChildNodeType;
    static constexpr std::array<int, 4> sizes{Upper::DIM, Lower::DIM, Leaf::DIM, 1};

    /// @param level  of the block: as many nodes lie above it, except at the root
    void visit(const Coord& block, int level) {
        const int size = sizes[static_cast<std::size_t>(level)];
        if (std::max(at_a_.getValueDepth(block), at_b_.getValueDepth(block)) <= level) {
            const Sample<Value> a{at_a_.getValue(block), at_a_.isValueOn(block)},
                b{at_b_.getValue(block), at_b_.isValueOn(block)};
            const auto side = static_cast<std::uint64_t>(size);
            if (a.on || b.on) tiles_.see(block, side * side * side, a, b, tolerance_);
            return;
        }
        if (size == Leaf::DIM) return leaves_.push_back(block);
        const int step = sizes[static_cast<std::size_t>(level) + 1];
        for (int x = 0; x < size; x += step)
            for (int y = 0; y < size; y += step)
                for (int z = 0; z < size; z += step) visit(block.offsetBy(x, y, z), level + 1);
    }

    /// A block of the size of a leaf, which may lie in a tile.
    class Block {
    public:
        Block(const Tree& tree, const Coord& origin) : leaf_(tree.probeConstLeaf(origin)) {
            if (!leaf_) tile_ = {tree.getValue(origin), tree.isValueOn(origin)};
        }
        Sample<Value> at(openvdb::Index offset) const {
            return leaf_ ? Sample<Value>{leaf_->getValue(offset), leaf_->isValueOn(offset)} : tile_;
        }

    private:
        const Leaf* leaf_;
        Sample<Value> tile_{};
    };

    void compare_leaves(const Coord& origin, Tally<Coord>& tally) const {
        const Block a(a_, origin), b(b_, origin);
        for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
            const auto in_a = a.at(n), in_b = b.at(n);
            if (in_a.on || in_b.on)
                tally.see(Leaf::offsetToLocalCoord(n) + origin, 1, in_a, in_b, tolerance_);
        }
    }

    const Tree& a_;
    const Tree& b_;
    openvdb::tree::ValueAccessor<const Tree> at_a_, at_b_;
    const Tolerance& tolerance_;
    Tally<Coord> tiles_;
    std::vector<Coord> leaves_;  ///< origins of the blocks where a tree has a leaf
};

template <class GridT>
PartDifference compare_voxels(const GridT& a, const GridT& b, const Tolerance& tolerance) {
    const auto tally = Walk<typename GridT::TreeType>(a.tree(), b.tree(), tolerance).compare();
    auto out = tally.sums;
    if (out.worst) {
        const auto world = a.transform().indexToWorld(tally.at);
        out.worst->index = {tally.at.x(), tally.at.y(), tally.at.z()};
        out.worst->world = {world.x(), world.y(), world.z()};
    }
    if (difference(a.background(), b.background()) != 0)
        out.faults.push_back(fmt::format("background: {} in A, {} in B", text(a.background()),
                                         text(b.background())));
    return out;
}

std::vector<openvdb::Vec3d> sound_positions(const GridBase& grid, const std::string& path) {
    require_sound(grid, path);
    return point_positions(grid);
}

const RawGrid::Bytes& bytes_of(const RawGrid& grid) {
    return static_cast<const RawGrid::Bytes&>(grid.constBaseTree());
}

PartDifference compare_values(const GridBase& a, const GridBase& b, const FilePair& paths,
                              const Tolerance& tolerance) {
#define FLUIDCARVE_COMPARE(GridT)                                                         \
    if (a.isType<GridT>())                                                                \
        return compare_voxels(static_cast<const GridT&>(a), static_cast<const GridT&>(b), \
                              tolerance);
    FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_COMPARE)
#undef FLUIDCARVE_COMPARE
    if (a.isType<openvdb::points::PointDataGrid>())
        return compare_positions({}, "points", sound_positions(a, paths.a),
                                 sound_positions(b, paths.b), tolerance);
    PartDifference out;
    const auto* const raw_a = RawGrid::of(a);
    const auto* const raw_b = RawGrid::of(b);
    if (!raw_a || !raw_b)
        out.faults.push_back(fmt::format("grids of type {} can't be compared", a.type()));
    else if (bytes_of(*raw_a).topology != bytes_of(*raw_b).topology ||
             bytes_of(*raw_a).buffers != bytes_of(*raw_b).buffers)
        out.faults.push_back(
            fmt::format("other bytes, of type {}, which OpenVDB does not know", a.type()));
    return out;
}

void compare_headers(const GridBase& a, const GridBase& b, std::vector<std::string>& faults) {
    if (a.transform() != b.transform()) {
        const auto in_a = place_text(a.transform()), in_b = place_text(b.transform());
        faults.push_back(in_a == in_b
                             ? fmt::format("transform: not the same, though both have {}", in_a)
                             : fmt::format("transform: {} in A; {} in B", in_a, in_b));
    }
    if (a.getGridClass() != b.getGridClass())
        faults.push_back(fmt::format("class: {} in A, {} in B",
                                     GridBase::gridClassToString(a.getGridClass()),
                                     GridBase::gridClassToString(b.getGridClass())));
}

}  // namespace

double difference_of(double a, double b) {
    if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
    const double out = std::abs(a - b);
    return std::isfinite(out) ? out : std::numeric_limits<double>::infinity();
}

PartDifference compare_grids(const std::string& name, const GridBase& a, const GridBase& b,
                             const FilePair& paths, const Tolerance& tolerance) {
    PartDifference out;
    if (a.type() == b.type()) out = compare_values(a, b, paths, tolerance);
    else out.faults.push_back(fmt::format("type: {} in A, {} in B", a.valueType(), b.valueType()));
    compare_headers(a, b, out.faults);
    out.name = name;
    return out;
}

PartDifference compare_positions(const std::string& name, const std::string& values,
                                 const std::vector<openvdb::Vec3d>& a,
                                 const std::vector<openvdb::Vec3d>& b, const Tolerance& tolerance) {
    Tally<std::size_t> tally;
    if (a.size() == b.size())
        for (std::size_t n = 0; n < a.size(); ++n)
            tally.see<openvdb::Vec3d>(n, 1, {a[n], true}, {b[n], true}, tolerance);
    auto out = std::move(tally.sums);
    out.name = name;
    out.values = values;
    if (a.size() != b.size())
        out.faults.push_back(fmt::format("{}: {} in A, {} in B", values, a.size(), b.size()));
    if (out.worst) {
        out.worst->index = {static_cast<std::int64_t>(tally.at)};
        out.worst->world = {a[tally.at].x(), a[tally.at].y(), a[tally.at].z()};
    }
    return out;
}

}  // namespace fluidcarve
