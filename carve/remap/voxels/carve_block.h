#pragma once

#include "carve/remap/voxels/trilinear.h"
#include "carve/seam/carve_map.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

namespace fluidcarve {

/// A carve map in a box of lattice coordinates, such as that of a block of voxels. It looks up the
/// displacements of the box's entries once.
class CarveBlock {
public:
    /// The cell of a step's carved space that holds a point: the columns that count, and the
    /// displacements of their entries.
    struct Cell {
        struct Column {
            double weight;
            int low, high;  ///< displacements of the entries below and above, half vertices
        };
        std::array<Column, 4> columns;
        std::size_t count;
        double fraction;  ///< of the point between the two entries, 0 to 1
        bool rigid;       ///< whether all displacements are the same
    };

    /// @param map  must outlive this object
    explicit CarveBlock(const CarveMap& map) : map_(map), tables_(map.steps().size()) {}

    /// Moves to a box of carved lattice coordinates. It may reach beyond the lattice; `w` of a
    /// closed lattice, and `v` around a rig, are as in Mapping::range.
    /// @return false if nothing in the box moves
    bool move_to(const openvdb::BBoxd& range);

    /// Bounds of the displacements along u, v and w, from output positions to their sources,
    /// vertices.
    const openvdb::Vec3d& least() const { return least_; }
    const openvdb::Vec3d& most() const { return most_; }
    /// Whether part of the box becomes background.
    bool frees() const { return frees_; }
    /// The displacement, if all points of the box are displaced by the same whole vertices.
    const std::optional<openvdb::Vec3d>& rigid() const { return rigid_; }
    /// Whether a rim's fade scales some displacements down (CarveMap::fade_rims).
    bool rims_fade() const { return fades_; }

    /// The cell that holds a point.
    /// @param step  index of the step in the map
    /// @param at    coordinates within that step's carved space, as later steps lead there from
    ///   the box
    Cell cell(std::size_t step, const openvdb::Vec3d& at) const;
    /// The displacement of a smoothed step, vertices: trilinear, and a whole number where its
    /// cell's corners have the same whole number.
    double smooth(std::size_t step, const openvdb::Vec3d& at) const;
    /// The displacement of a point through all steps.
    struct Rigid {
        openvdb::Vec3d by{0.0};  ///< along u, v and w, vertices
        bool fades = false;      ///< whether a rim's fade scaled it down
    };
    /// The displacement of a point of the box, if in each step all corners of its cell are
    /// displaced by the same whole vertices, or smoothly; else nothing.
    std::optional<Rigid> rigid_at(openvdb::Vec3d at) const;

private:
    /// Displacements of a box of vertices under one step.
    struct Table {
        std::array<int, 3> first{}, size{};  ///< along the carved, the lateral and the slice axis
        /// `[slice][lateral][entry]`, half vertices; beyond a rim, as at the rim.
        std::vector<int> all;
        std::vector<float> smooth;  ///< the same for a smoothed step, vertices
        int low = 0, high = 0;      ///< bounds of all displacements, half vertices
        void fill(const CarveStep& step);
        /// Index of the displacement of a cell's lowest entry.
        int cell(int i, int j, int k, const CarveStep& step) const {
            const int slice = k < first[2] ? k + step.columns().slices - first[2] : k - first[2];
            const int lateral =
                j < first[1] ? j + step.columns().laterals - first[1] : j - first[1];
            return (slice * size[1] + lateral) * size[0] + i - first[0];
        }

    private:
        template <class Column>
        void each_column(const CarveStep& step, const Column& column) const;
        void fill_smooth(const CarveStep& step);
    };

    /// The displacements of two consecutive entries, packed into one number.
    static std::uint64_t edge_at(const int* entry) {
        std::uint64_t out;
        std::memcpy(&out, entry, sizeof(out));
        return out;
    }

    const CarveMap& map_;
    std::vector<Table> tables_;  ///< `[step]`
    openvdb::Vec3d least_, most_;
    bool frees_ = false, fades_ = false;
    std::optional<openvdb::Vec3d> rigid_;
};

inline CarveBlock::Cell CarveBlock::cell(std::size_t step, const openvdb::Vec3d& at) const {
    const auto& table = tables_[step];
    const auto& of = map_.steps()[step];
    const double u = at[of.axis()], v = at[of.lateral_axis()], w = at[of.slice_axis()];
    const int i = static_cast<int>(u), j = static_cast<int>(v), k = static_cast<int>(w);
    Cell out;
    out.fraction = u - i;
    out.count = 0;
    out.rigid = true;
    const int* const corner = table.all.data() + table.cell(i, j, k, of);
    const double to_j = v - j, to_k = w - k;
    for (int n = 0; n < 4; ++n) {
        const double weight = (n & 1 ? to_j : 1 - to_j) * (n & 2 ? to_k : 1 - to_k);
        if (weight == 0) continue;
        const int* const entry = corner + ((n >> 1) * table.size[1] + (n & 1)) * table.size[0];
        auto& column = out.columns[out.count++];
        column = {weight, entry[0], out.fraction > 0 ? entry[1] : entry[0]};
        out.rigid =
            out.rigid && column.low == out.columns[0].low && column.high == out.columns[0].low;
    }
    return out;
}

inline double CarveBlock::smooth(std::size_t step, const openvdb::Vec3d& at) const {
    const auto& table = tables_[step];
    const auto& of = map_.steps()[step];
    const double u = at[of.axis()], v = at[of.lateral_axis()], w = at[of.slice_axis()];
    const int i = static_cast<int>(u), j = static_cast<int>(v), k = static_cast<int>(w);
    const float* const a = table.smooth.data() + table.cell(i, j, k, of);
    const auto above = static_cast<std::size_t>(table.size[0]),
               behind = above * static_cast<std::size_t>(table.size[1]);
    return trilinear([a](std::size_t n) { return a[n]; }, {1, above, behind},
                     std::array{static_cast<float>(u - i), static_cast<float>(v - j),
                                static_cast<float>(w - k)});
}

inline std::optional<CarveBlock::Rigid> CarveBlock::rigid_at(openvdb::Vec3d at) const {
    Rigid out;
    for (auto n = tables_.size(); n-- > 0;) {
        const auto& step = map_.steps()[n];
        const int axis = step.axis();
        if (!step.holds(at)) continue;
        const double scale = step.rim_scale(at);
        if (!step.carves(at, scale)) return std::nullopt;
        const auto& table = tables_[n];
        if (step.soft()) {
            const double by = smooth(n, at), source = at[axis] + scale * by,
                         clamped = step.clamped(source);
            const double scaled = clamped == source ? scale * by : clamped - at[axis];
            at[axis] += scaled;
            out.by[axis] += scaled;
            out.fades = out.fades || scale < 1;
            continue;
        }
        const int* const a =
            table.all.data() + table.cell(static_cast<int>(at[axis]),
                                          static_cast<int>(at[step.lateral_axis()]),
                                          static_cast<int>(at[step.slice_axis()]), step);
        const int *const b = a + table.size[0], *const c = a + table.size[0] * table.size[1],
                         *const d = c + table.size[0];
        const int by = a[0];
        const auto edge = edge_at(a);
        if (((by & 1) | (a[1] ^ by)) != 0 ||
            ((edge ^ edge_at(b)) | (edge ^ edge_at(c)) | (edge ^ edge_at(d))) != 0)
            return std::nullopt;
        const double whole = 0.5 * by,
                     scaled = scale < 1
                                  ? step.faded_source(at[axis], at[axis] + whole, scale) - at[axis]
                                  : whole;
        at[axis] += scaled;
        out.by[axis] += scaled;
        out.fades = out.fades || scale < 1;
    }
    return out;
}

}  // namespace fluidcarve
