#pragma once

#include "carve/lattice/block_places.h"
#include "carve/lattice/mapping.h"
#include "carve/remap/voxels/band_blend.h"
#include "carve/remap/voxels/blend.h"
#include "carve/remap/voxels/joined_sides.h"
#include "carve/remap/voxels/slow_part.h"
#include "carve/remap/voxels/voxel_reader.h"

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

namespace fluidcarve {

/// Reads the voxels of a grid under a map whose seams are joined by fades (METHOD 10 "Joins").
/// Holds one point at a time.
template <class GridT>
class JoinedReader {
public:
    /// All must outlive it.
    /// @param slow  the grid's slow part; null: sides are only faded
    JoinedReader(const GridT& grid, const Mapping& mapping, const BlockPlaces& places,
                 JoinedSides sides, std::shared_ptr<const SlowPart> slow)
        : grid_(grid), places_(places), sides_(std::move(sides)), slow_(std::move(slow)) {
        if (mapping.slabs()) return;
        using openvdb::Vec3d;
        const auto at = [&](const Vec3d& vertex) {
            return grid.transform().worldToIndex(mapping.position(vertex));
        };
        steps_ = {at(Vec3d(1, 0, 0)) - at(Vec3d(0)), at(Vec3d(0, 1, 0)) - at(Vec3d(0)),
                  at(Vec3d(0, 0, 1)) - at(Vec3d(0))};
    }

    /// Moves to a point.
    /// @param p  its index coordinates
    void move_to(const openvdb::Vec3d& p, const BlockPlaces::Place& place) {
        p_ = p;
        place_ = &place;
        sides_.find(place.at);
    }
    /// Whether the point has one source only, and which: lattice coordinates.
    bool rigid() const { return sides_.rigid(); }
    const openvdb::Vec3d& source() const { return sides_.stretched(); }
    /// The position at which the point reads the content of other lattice coordinates. In a
    /// straight box all steps are equal.
    openvdb::Vec3d position(const openvdb::Vec3d& source) const {
        const auto by = source - place_->at;
        return steps_ ? p_ + by.x() * (*steps_)[0] + by.y() * (*steps_)[1] + by.z() * (*steps_)[2]
                      : places_.moved(p_, *place_, by);
    }
    /// Blends the sides of the point.
    /// @param own  the content of the point itself
    template <class Pick, class Part = typename Pick::Part>
    ValueAndState<Part> blend(VoxelReader<GridT>& reader, const Pick& pick,
                              const ValueAndState<Part>& own) const {
        const ValueAndState<Part> nothing{pick(grid_.background()), false};
        if (sides_.freed()) return nothing;
        const auto read = [&](const JoinedSides::Side& side, const openvdb::Vec3d& at) {
            return side.nothing ? nothing : side.at == place_->at ? own : reader.read(at, pick);
        };
        if constexpr (can_blend<Part>) {
            if (slow_) {
                const auto stretched = position(sides_.stretched());
                BandBlend<Part> out(reader.read(stretched, pick), slow(stretched, pick),
                                    nothing.value);
                for (const auto& side : sides_.all()) {
                    const auto at = position(side.at);
                    if (side.nothing) out.add_nothing(side.weight);
                    else out.add(read(side, at), slow(at, pick), side.weight);
                }
                return out.result();
            }
        }
        Blend<Part> out;
        for (const auto& side : sides_.all()) out.add(read(side, position(side.at)), side.weight);
        return out.result(nothing.value);
    }

private:
    /// The slow part at index coordinates.
    template <class Pick>
    std::array<double, 3> slow(const openvdb::Vec3d& at, const Pick& pick) const {
        std::array<double, 3> out{};
        for (std::size_t c = 0; c < components_of<typename Pick::Part>; ++c)
            out[c] = slow_->at(at, pick.component + c);
        return out;
    }

    const GridT& grid_;
    const BlockPlaces& places_;
    JoinedSides sides_;
    const std::shared_ptr<const SlowPart> slow_;
    /// In a straight box: from a vertex to the next along u, v and w, voxels.
    std::optional<std::array<openvdb::Vec3d, 3>> steps_;
    openvdb::Vec3d p_;
    const BlockPlaces::Place* place_ = nullptr;
};

}  // namespace fluidcarve
