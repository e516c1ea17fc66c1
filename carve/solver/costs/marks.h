#pragma once

#include "carve/field/missed_range.h"
#include "carve/lattice/alignment.h"
#include "carve/lattice/lattice.h"
#include "carve/solver/costs/column_places.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fluidcarve {

/// How many vertices each mask of a solver marks; nothing: it has no such mask.
struct MarkCounts {
    std::optional<std::size_t> protect, attract;
    /// Why a mask is empty, if known.
    std::optional<MissedRange> protect_missed{}, attract_missed{};
};

/// Where a mask is set, that is, active, in the columns of a lattice. A mask is set around a vertex
/// if any of the 8 voxels whose centres surround the vertex is active. For a vertex on a voxel
/// centre, within 1e-5 voxels, only that voxel counts; on a line or face between centres, only the
/// voxels at its ends or corners.
class MaskColumns {
public:
    /// @param mask  of any type that can be carved; mask and lattice must outlive this
    /// @throws Failure naming the type of a grid that is no mask
    MaskColumns(const openvdb::GridBase& mask, const Lattice& lattice, Axis axis);
    bool empty() const { return box_.empty(); }

    /// Marks columns. One thread uses it at a time.
    class Marker {
    public:
        explicit Marker(const MaskColumns& mask);
        /// Writes a code at the marked vertices of the column `(lateral, k)`.
        /// @param code   protected_code or attracted_code
        /// @param codes  one for each entry
        /// @return number of marked vertices
        std::size_t operator()(int lateral, int k, std::uint16_t code,
                               std::span<std::uint16_t> codes);

    private:
        bool set_around(const openvdb::Vec3d& at) const;

        const MaskColumns& mask_;
        const openvdb::CoordBBox reach_;  ///< holds all places around which the mask may be set
        openvdb::tree::ValueAccessor<const openvdb::MaskTree> set_;
        ColumnPlaces places_;
    };

private:
    const Axis axis_;
    const Lattice& lattice_;
    const openvdb::math::Transform& transform_;
    const openvdb::MaskTree set_;
    /// Holds the lowest of the 8 voxels around a vertex, if any of the 8 may be set.
    openvdb::CoordBBox box_;
    const std::optional<Alignment> alignment_;
};

/// Writes a code at all vertices of a lattice around which a mask is set.
/// @param code   as Marker takes it
/// @param codes  as sample_columns() fills them
/// @return number of marked vertices
/// @throws Failure as MaskColumns
std::size_t mark_vertices(const openvdb::GridBase& mask, const Lattice& lattice, Axis axis,
                          std::uint16_t code, std::span<std::uint16_t> codes);

/// Warnings about masks that mark nothing.
std::vector<std::string> mask_warnings(const MarkCounts& marks);

}  // namespace fluidcarve
