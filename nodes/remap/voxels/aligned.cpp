#include "nodes/remap/voxels/aligned.h"

#include "nodes/field/extent.h"
#include "nodes/grid_types.h"
#include "nodes/remap/voxels/blend.h"
#include "nodes/remap/voxels/blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace fluidcarve {

namespace {

using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;

CoordBBox voxels(const Alignment& alignment, const BBoxd& range) {
    const auto at = [&](const openvdb::Vec3d& p, auto&& round) { return alignment.voxel(round(p.x()), round(p.y()), round(p.z())); };
    const auto a = at(range.min(), [](double x) { return static_cast<int>(std::floor(x)); }),
               b = at(range.max(), [](double x) { return static_cast<int>(std::ceil(x)); });
    return {Coord::minComponent(a, b), Coord::maxComponent(a, b)};
}

/// Carves an aligned grid block by block.
template <class GridT>
class AlignedCarve {
    using TreeT = typename GridT::TreeType;
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;
    using Voxel = typename BlockWindow<TreeT>::Voxel;
    static constexpr bool has_faces = openvdb::VecTraits<Value>::IsVec && can_blend<Value>;

public:
    AlignedCarve(const GridT& grid, const Alignment& alignment, const CarveMap& map)
        : alignment_(alignment), map_(map), steps_(map.steps()), window_(grid.tree()), nothing_{grid.background(), false} {
        const auto& along = alignment.step[static_cast<std::size_t>(steps_.back().axis())];
        index_axis_ = along.x() != 0 ? 0 : along.y() != 0 ? 1 : 2;
        direction_ = along[index_axis_];
        staggered_ = has_faces && steps_.back().soft() && grid.getGridClass() == openvdb::GRID_STAGGERED;
        for (int c = 0; c < 3; ++c)
            for (int axis = 0; axis < 3; ++axis)
                if (const int step = alignment.step[static_cast<std::size_t>(axis)][c]; step != 0) faces_[static_cast<std::size_t>(c)] = {axis, -step};
    }

    bool operator()(const Coord& block, Leaf& out) {
        const auto a = alignment_.vertex(block), b = alignment_.vertex(block.offsetBy(7));
        BBoxd range(Coord::minComponent(a, b).asVec3d(), Coord::maxComponent(a, b).asVec3d());
        if (staggered_) range.expand(0.5);
        bool frees = false;
        if (!map_.trace(range, frees)) return false;
        window_.move_to(voxels(alignment_, range));
        if (window_.uniform() && (!frees || (!window_.tile().on && same_bits(window_.tile().value, nothing_.value)))) return false;

        const bool soft = steps_.back().soft() != nullptr;
        // In planes outside the lattice nothing moves. Of a block of an image, that is all but one.
        const auto held = [&](int k) { return k >= 0 && k < steps_.back().slices(); };
        const bool within = staggered_ || (held(a.z()) && held(b.z()));
        if (!within) window_.read(out);
        Coord line;
        const int p = index_axis_ == 0 ? 1 : 0, q = index_axis_ == 2 ? 1 : 2;
        line[index_axis_] = block[index_axis_] + (direction_ > 0 ? 0 : 7);
        for (line[p] = block[p]; line[p] < block[p] + 8; ++line[p])
            for (line[q] = block[q]; line[q] < block[q] + 8; ++line[q]) {
                if (!within && !held(alignment_.vertex(line).z())) continue;
                if (!soft) {
                    carve_row(line, out);
                    continue;
                }
                if constexpr (has_faces) {
                    if (staggered_) {
                        carve_faces_softly(line, out);
                        continue;
                    }
                }
                carve_row_softly(line, out);
            }
        return true;
    }

private:
    /// Where the content of eight points comes from, in the direction of rising entries. Each point belongs to a voxel of one line.
    struct Sources {
        std::array<int, 8> below;                                                           ///< entry
        std::array<float, 8> part;                                                          ///< of the way to the next entry, 0 to 1
        unsigned freed = 0;                                                                 ///< a bit for each point: nothing comes there
        int low = std::numeric_limits<int>::max(), high = std::numeric_limits<int>::min();  ///< of the entries that are read

        bool is_freed(std::size_t n) const { return (freed >> n & 1) != 0; }
        /// Whether the points are eight entries in a row.
        bool in_row() const {
            bool out = freed == 0;
            for (int n = 0; n < 8; ++n) out = out && part[static_cast<std::size_t>(n)] == 0 && below[static_cast<std::size_t>(n)] == below[0] + n;
            return out;
        }
    };
    /// Where points stand beside their voxels.
    struct Beside {
        int axis;  ///< of the lattice
        int side;  ///< half a vertex below the voxel's vertex (-1) or above it (1); 0: at the vertex
    };

    /// Finds the sources under a smoothed step.
    /// @param vertex  of the voxel of the first point
    Sources sources_of(const Coord& vertex, const Beside& beside) const {
        const auto& step = steps_.back();
        const auto& soft = *step.soft();
        // A point between two columns, or between two entries of one, moves by their mean.
        auto low_vertex = vertex, high_vertex = vertex;
        if (beside.side < 0) --low_vertex[beside.axis];
        if (beside.side > 0) ++high_vertex[beside.axis];
        const int axis = step.axis(), lateral = step.lateral_axis(), first = vertex[axis], offset = low_vertex[axis] - first;
        const auto carved = [&](const Coord& at) { return step.has_column(at[lateral], at.z()); };
        const bool in_columns = carved(low_vertex) && carved(high_vertex);
        std::array<float, 8> moved{};
        if (in_columns) {
            const auto read = [&](const Coord& column, int entry) { return eight_of(soft, soft.column(column[lateral], column.z()), entry); };
            moved = read(low_vertex, first + offset);
            if (beside.side != 0) {
                const auto other = read(high_vertex, first + high_vertex[axis] - vertex[axis]);
                for (std::size_t n = 0; n < moved.size(); ++n) moved[n] += (other[n] - moved[n]) * 0.5f;
            }
        }
        auto at = vertex.asVec3d();
        at[beside.axis] += 0.5 * beside.side;
        const double u = at[axis];
        const auto [begin, end] = in_columns ? step.ends(at, 1) : CarveStep::Ends{};
        const int step_low = step.low(), step_high = step.high(), origin = step.origin(), last_before = step.last_before();
        // Coordinates are whole or halves: as floats they are exact.
        const auto down = static_cast<float>(origin - u), up = static_cast<float>(last_before - u);
        Sources out;
        // Without branches, for vector instructions.
        for (int n = 0; n < 8; ++n) {
            const auto i = static_cast<std::size_t>(n);
            const float d = std::min(std::max(moved[i], down - static_cast<float>(n)), up - static_cast<float>(n));
            const int towards_0 = static_cast<int>(d), below = towards_0 - (static_cast<float>(towards_0) > d ? 1 : 0);
            out.below[i] = first + n + below;
            out.part[i] = d - static_cast<float>(below);
        }
        if (!in_columns || u < step_low || u + 7 > step_high || u < begin || u + 7 > end)
            for (int n = 0; n < 8; ++n) {
                const double point = u + n;
                const bool held = in_columns && point >= step_low && point <= step_high;
                if (held && point >= begin && point <= end) continue;
                const auto i = static_cast<std::size_t>(n);
                out.below[i] = first + n;
                out.part[i] = 0;
                if (held && point >= origin && point <= last_before) out.freed |= 1u << n;
            }
        for (std::size_t n = 0; n < out.below.size(); ++n) {
            if (out.is_freed(n)) continue;
            out.low = std::min(out.low, out.below[n]);
            out.high = std::max(out.high, out.below[n] + (out.part[n] > 0 ? 1 : 0));
        }
        return out;
    }

    /// Displacements of eight entries of a column.
    static std::array<float, 8> eight_of(const SmoothDisplacement& soft, std::span<const float> column, int entry) {
        std::array<float, 8> out;
        const int from = entry - soft.first(), most = static_cast<int>(column.size()) - 1;
        if (from >= 0 && from + 7 <= most) std::copy_n(column.data() + from, out.size(), out.begin());
        else
            for (int n = 0; n < 8; ++n) out[static_cast<std::size_t>(n)] = column[static_cast<std::size_t>(std::clamp(from + n, 0, most))];
        return out;
    }

    /// Reads what sources need into line_. @param voxel  of the first point; its entry is `first`
    void read_line(const Coord& voxel, int first, const Sources& sources) {
        if (sources.low > sources.high) return;
        line_.resize(static_cast<std::size_t>(sources.high - sources.low) + 1);
        auto from = voxel;
        from[index_axis_] += direction_ * (sources.low - first);
        window_.read_row(from, index_axis_, direction_, line_);
    }

    /// Copies eight voxels that come from as many in a row. @param voxel  the first one; its entry is `first`
    void copy_row(Coord voxel, int first, const Sources& sources, Leaf& out) const {
        const auto to = Leaf::coordToOffset(voxel);
        voxel[index_axis_] += direction_ * (sources.below[0] - first);
        window_.copy_line(voxel, index_axis_, direction_, 8, out, to);
    }

    /// Carves eight voxels in the direction of rising entries, under a smoothed step. Each value comes from between two voxels on the line.
    void carve_row_softly(const Coord& voxel, Leaf& out) {
        const auto vertex = alignment_.vertex(voxel);
        const int first = vertex[steps_.back().axis()];
        const auto sources = sources_of(vertex, {0, 0});
        if (sources.in_row()) return copy_row(voxel, first, sources, out);
        read_line(voxel, first, sources);
        std::array<Voxel, 8> row;
        for (std::size_t n = 0; n < row.size(); ++n)
            row[n] = sources.is_freed(n) ? nothing_ : between(sources.part[n], line_.data() + (sources.below[n] - sources.low));
        window_.write_line(out, Leaf::coordToOffset(voxel), index_axis_, direction_, row);
    }

    /// The same for a staggered grid: component c stands half a voxel below its voxel's centre along index axis c.
    void carve_faces_softly(const Coord& voxel, Leaf& out) {
        const auto vertex = alignment_.vertex(voxel);
        const int first = vertex[steps_.back().axis()];
        std::array<Sources, 3> sources;
        for (std::size_t c = 0; c < 3; ++c) sources[c] = sources_of(vertex, faces_[c]);
        const auto alike = [&](const Sources& each) { return each.in_row() && each.below[0] == sources[0].below[0]; };
        if (std::ranges::all_of(sources, alike)) return copy_row(voxel, first, sources[0], out);
        std::array<Voxel, 8> row{};
        for (int c = 0; c < 3; ++c) {
            const auto& source = sources[static_cast<std::size_t>(c)];
            read_line(voxel, first, source);
            for (std::size_t n = 0; n < row.size(); ++n) {
                if (source.is_freed(n)) {
                    row[n].value[c] = nothing_.value[c];
                    continue;
                }
                const float part = source.part[n];
                const auto* const from = line_.data() + (source.below[n] - source.low);
                row[n].value[c] = part == 0 ? from[0].value[c] : mix(from[0].value[c], from[1].value[c], part);
                row[n].on = row[n].on || from[part < 0.5f ? 0 : 1].on;
            }
        }
        window_.write_line(out, Leaf::coordToOffset(voxel), index_axis_, direction_, row);
    }

    /// The value between two. @param part  of the way to the second, 0 to 1
    template <class T>
    static T mix(const T& from, const T& to, float part) {
        using Weight = typename openvdb::VecTraits<T>::ElementType;
        return T(from + (to - from) * static_cast<Weight>(part));
    }

    /// The voxel between one voxel of a line and the next.
    /// @param part  of the way to the next, 0 to 1
    static Voxel between(float part, const Voxel* line) {
        if (part == 0) return line[0];
        if constexpr (can_blend<Value>) {
            return {mix(line[0].value, line[1].value, part), line[part < 0.5f ? 0 : 1].on};
        } else {
            return line[part < 0.5f ? 0 : 1];
        }
    }

    /// Carves eight voxels in the direction of rising entries, under the last step. So the bounds of their column are passed only once.
    void carve_row(Coord voxel, Leaf& out) {
        const auto& step = steps_.back();
        const auto rest = steps_.size() - 1;
        const int axis = step.axis();
        const auto first = alignment_.vertex(voxel);
        const bool carved = step.has_column(first[step.lateral_axis()], first.z());
        const auto bounds = carved ? step.bounds(first[step.lateral_axis()], first.z()) : std::span<const std::uint16_t>();
        auto passed = CarveStep::passed(first[axis], bounds);

        const int end = first[axis] + 8;
        for (int entry = first[axis], count = 1; entry < end; entry += count, voxel[index_axis_] += direction_ * count) {
            while (passed < bounds.size() && bounds[passed] <= entry) ++passed;
            const auto moved = [&](int source) {
                auto place = voxel;
                place[index_axis_] += direction_ * (source - entry);
                return place;
            };
            const auto at = [&](int source) { return rest == 0 ? window_.get(moved(source)) : resolve(rest, alignment_.vertex(moved(source))); };
            count = 1;
            const bool in_step = carved && entry >= step.low() && entry <= step.high();
            if (in_step && (entry < step.start() || entry > step.last())) {
                write(out, voxel, nothing_);
                continue;
            }
            const int d = in_step ? step.displacement(entry, passed, bounds) : 0;
            if (rest > 0 || d % 2 != 0) {
                write(out, voxel, displaced(entry, d, at));
                continue;
            }
            // The entries up to the next bound are displaced alike.
            int same = end;
            if (in_step) same = std::min({end, step.last() + 1, passed < bounds.size() ? static_cast<int>(bounds[passed]) : end});
            else if (carved && entry < step.low()) same = std::min(end, step.low());
            count = same - entry;
            window_.copy_line(moved(entry + d / 2), index_axis_, direction_, count, out, Leaf::coordToOffset(voxel));
        }
    }

    /// The voxel at a vertex after the first `count` steps.
    Voxel resolve(std::size_t count, Coord vertex) const {
        for (; count > 0; --count) {
            const auto& step = steps_[count - 1];
            const int axis = step.axis(), entry = vertex[axis];
            if (!step.has_column(vertex[step.lateral_axis()], vertex.z()) || entry < step.low() || entry > step.high()) continue;
            if (entry < step.start() || entry > step.last()) return nothing_;
            const int d = step.displacement(entry, vertex[step.lateral_axis()], vertex.z());
            if (d % 2 != 0)
                return displaced(entry, d, [&](int source) {
                    vertex[axis] = source;
                    return resolve(count - 1, vertex);
                });
            vertex[axis] += d / 2;
        }
        return window_.get(alignment_.voxel(vertex.x(), vertex.y(), vertex.z()));
    }

    template <class At>
    static Voxel displaced(int entry, int d, At&& at) {
        if (d % 2 == 0) return at(entry + d / 2);
        const Voxel low = at(entry + (d - 1) / 2);
        const Voxel high = at(entry + (d + 1) / 2);
        // In a mask the state is the value.
        if constexpr (std::is_same_v<typename TreeT::BuildType, openvdb::ValueMask>) return low;
        else return {inserted_value(low.value, high.value), low.on || high.on};
    }

    static void write(Leaf& out, const Coord& at, const Voxel& voxel) {
        const auto offset = Leaf::coordToOffset(at);
        out.setValueOnly(offset, voxel.value);
        out.setActiveState(offset, voxel.on);
    }

    const Alignment& alignment_;
    const CarveMap& map_;
    const std::vector<CarveStep>& steps_;
    BlockWindow<TreeT> window_;
    const Voxel nothing_;
    int index_axis_, direction_;
    bool staggered_;
    std::array<Beside, 3> faces_{};  ///< where a staggered grid's components stand
    std::vector<Voxel> line_;        ///< of the line that is being carved softly
};

}  // namespace

template <class GridT>
typename GridT::ConstPtr carve_aligned(const typename GridT::ConstPtr& grid, const Alignment& alignment, const CarveMap& map) {
    if (map.empty()) return grid;
    // A component's face may lie in the lattice where its voxel's centre does not.
    return rewrite_blocks<GridT>(grid, padded(voxels(alignment, map.moved()), 1), [&] {
        return
            [worker = std::make_shared<AlignedCarve<GridT>>(*grid, alignment, map)](const Coord& block, LeafOf<GridT>& out) { return (*worker)(block, out); };
    });
}

#define FLUIDCARVE_INSTANTIATE(GridT) template GridT::ConstPtr carve_aligned<GridT>(const GridT::ConstPtr&, const Alignment&, const CarveMap&);
FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_INSTANTIATE)
#undef FLUIDCARVE_INSTANTIATE

}  // namespace fluidcarve
