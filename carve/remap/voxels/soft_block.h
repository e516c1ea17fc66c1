#pragma once

#include "carve/lattice/alignment.h"
#include "carve/remap/voxels/blend.h"
#include "carve/remap/voxels/blocks.h"
#include "carve/remap/voxels/windows.h"
#include "carve/seam/carve_step.h"
#include "carve/seam/smooth_displacement.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace fluidcarve {

/// The sources of a block's 8^3 points under a smoothed step. Each point belongs to a voxel;
/// arrays are in the order of a leaf. Content moves only along the lines of voxels that run along
/// the step's axis.
struct SoftSources {
    static constexpr std::size_t voxels = 512;
    /// Entries from a point to the last one at or below its source.
    std::array<std::int32_t, voxels> shift;
    std::array<float, voxels> part;  ///< position of the source between that entry and the next, 0
                                     ///< to 1
    /// A bit for each point: whether its line is in the step's lattice. Other points do not
    /// change.
    std::array<std::uint8_t, voxels / 8> in_lines;
    std::array<std::uint8_t, voxels / 8> freed;  ///< likewise: whether the step frees the point
    int least, most;  ///< bounds of the shifts; `least` is larger if no line is in the lattice
};

/// The lines of voxels along a step's axis.
struct StepLines {
    const Alignment& alignment;
    const CarveStep& step;
    int index_axis;             ///< along which the lines run
    int direction;              ///< 1: entries rise with the index; -1: they fall
    std::array<int, 2> across;  ///< the other index axes, rising

    StepLines(const Alignment& aligned, const CarveStep& carve) : alignment(aligned), step(carve) {
        const auto& along = aligned.step[static_cast<std::size_t>(carve.axis())];
        index_axis = along.x() != 0 ? 0 : along.y() != 0 ? 1 : 2;
        direction = along[index_axis];
        across = {index_axis == 0 ? 1 : 0, index_axis == 2 ? 1 : 2};
    }
};

/// Offset of points from their voxels.
struct Beside {
    int axis = 0;  ///< of the lattice
    /// Half a vertex below the voxel's vertex (-1) or above it (1); 0: at the vertex.
    int side = 0;
};

/// Finds the sources of the points of a block.
/// @param lines  of a smoothed step
/// @param block  the block's first voxel
void find_sources(const StepLines& lines, const openvdb::Coord& block, const Beside& beside,
                  SoftSources& out);

/// Carves blocks of a grid whose voxels stand on the vertices, under a single smoothed step. Each
/// value is interpolated between two voxels of a line.
template <class GridT>
class SoftBlock {
    using TreeT = typename GridT::TreeType;
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;
    using Voxel = typename BlockWindow<TreeT>::Voxel;
    static constexpr bool has_faces = openvdb::VecTraits<Value>::IsVec && can_blend<Value>;

public:
    SoftBlock(const GridT& grid, const StepLines& lines)
        : lines_(lines),
          nothing_(grid.background()),
          staggered_(has_faces && grid.getGridClass() == openvdb::GRID_STAGGERED) {
        for (int c = 0; c < 3; ++c)
            for (int axis = 0; axis < 3; ++axis)
                if (const int along = lines.alignment.step[static_cast<std::size_t>(axis)][c];
                    along != 0)
                    faces_[static_cast<std::size_t>(c)] = {axis, -along};
    }

    /// Whether component c of a value stands half a voxel below its voxel's centre along index axis
    /// c.
    bool staggered() const { return staggered_; }

    /// Carves the block of a leaf.
    /// @param window  holds all voxels that the step may read
    /// @param held    index box of these voxels
    /// @return false if the block stays as it is; then `out` is not set
    bool carve(const BlockWindow<TreeT>& window, const openvdb::CoordBBox& held, Leaf& out) {
        const auto components = staggered_ ? std::size_t{3} : 1;
        int least = std::numeric_limits<int>::max(), most = std::numeric_limits<int>::min();
        bool all = true;
        for (std::size_t c = 0; c < components; ++c) {
            find_sources(lines_, out.origin(), staggered_ ? faces_[c] : Beside{}, sources_[c]);
            least = std::min(least, sources_[c].least);
            most = std::max(most, sources_[c].most);
            all = all && std::ranges::all_of(sources_[c].in_lines,
                                             [](std::uint8_t row) { return row == 0xff; });
        }
        if (least > most) return false;
        auto read = openvdb::CoordBBox::createCube(out.origin(), 8);
        const auto low = lines_.direction * (lines_.direction > 0 ? least : most + 1),
                   high = lines_.direction * (lines_.direction > 0 ? most + 1 : least);
        read.min()[lines_.index_axis] += low;
        read.max()[lines_.index_axis] += high;
        read.intersect(held);
        voxels_.move_to(window, read);
        const auto next = lines_.direction * voxels_.step(lines_.index_axis);
        std::array<Voxel, 8> row;
        for (std::size_t n = 0; n < SoftSources::voxels; n += row.size()) {
            const auto at = out.offsetToGlobalCoord(static_cast<openvdb::Index>(n));
            if (!all) window.read(at, row);
            carve_row(n, voxels_.place(at), next, row);
            BlockWindow<TreeT>::write(out, static_cast<openvdb::Index>(n), row);
        }
        return true;
    }

private:
    /// Carves eight voxels along z.
    /// @param n      offset of the first one in the leaf
    /// @param first  its place in voxels_
    /// @param next   step in voxels_ to the next entry
    /// @param row    the voxels before the carve, if some of them stay
    void carve_row(std::size_t n, std::ptrdiff_t first, std::ptrdiff_t next,
                   std::array<Voxel, 8>& row) const {
        if constexpr (has_faces) {
            if (staggered_) return carve_faces(n, first, next, row);
        }
        const auto& sources = sources_[0];
        for (unsigned left = sources.in_lines[n / 8]; left != 0; left &= left - 1) {
            const auto z = static_cast<std::size_t>(std::countr_zero(left));
            if (sources.freed[n / 8] >> z & 1) {
                row[z] = {nothing_, false};
                continue;
            }
            const auto part = sources.part[n + z];
            const auto from = first + static_cast<std::ptrdiff_t>(z) + next * sources.shift[n + z],
                       nearer = part < 0.5f ? from : from + next;
            if constexpr (can_blend<Value>)
                row[z].value = part == 0 ? voxels_.value(place(from))
                                         : mix(voxels_.value(place(from)),
                                               voxels_.value(place(from + next)), part);
            else row[z].value = voxels_.value(place(nearer));
            row[z].on = voxels_.on(place(nearer)) ||
                        shows<Value>(row[z].value, voxels_.value(place(nearer)), nothing_);
        }
    }

    /// The same in a staggered grid, component by component.
    void carve_faces(std::size_t n, std::ptrdiff_t first, std::ptrdiff_t next,
                     std::array<Voxel, 8>& row) const {
        const unsigned all_in_lines =
            sources_[0].in_lines[n / 8] & sources_[1].in_lines[n / 8] & sources_[2].in_lines[n / 8];
        for (std::size_t z = 0; z < row.size(); ++z) {
            // A component that stays keeps its voxel's state.
            if (all_in_lines >> z & 1) row[z].on = false;
            for (int c = 0; c < 3; ++c) {
                const auto& sources = sources_[static_cast<std::size_t>(c)];
                if ((sources.in_lines[n / 8] >> z & 1) == 0) continue;
                if (sources.freed[n / 8] >> z & 1) {
                    row[z].value[c] = nothing_[c];
                    continue;
                }
                const auto part = sources.part[n + z];
                const auto from =
                    first + static_cast<std::ptrdiff_t>(z) + next * sources.shift[n + z];
                const auto& value = voxels_.values()[place(from)][c];
                row[z].value[c] =
                    part == 0 ? value : mix(value, voxels_.values()[place(from + next)][c], part);
                const auto nearer = place(part < 0.5f ? from : from + next);
                row[z].on = row[z].on || voxels_.on(nearer) ||
                            shows(row[z].value[c], voxels_.values()[nearer][c], nothing_[c]);
            }
        }
    }

    static std::size_t place(std::ptrdiff_t at) { return static_cast<std::size_t>(at); }

    /// Interpolates between two values; if the result is not finite, returns the nearer one.
    /// @param part  position between them, 0 to 1
    template <class T>
    static T mix(const T& from, const T& to, float part) {
        using Weight = typename openvdb::VecTraits<T>::ElementType;
        const T out(from + (to - from) * static_cast<Weight>(part));
        return openvdb::math::isFinite(out) ? out : part < 0.5f ? from : to;
    }

    StepLines lines_;
    Value nothing_;
    bool staggered_;
    std::array<Beside, 3> faces_;  ///< where a staggered grid's components stand
    std::array<SoftSources, 3> sources_;
    VoxelWindow<TreeT> voxels_;
};

}  // namespace fluidcarve
