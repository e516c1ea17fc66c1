#pragma once

#include "carve/remap/voxels/carve_block.h"
#include "carve/seam/joins.h"

#include <openvdb/Types.h>

#include <cstddef>
#include <vector>

namespace fluidcarve {

/// The sources that are blended at a point under a map whose seams are joined by fades (METHOD 10
/// "Joins"). Holds one point at a time.
class JoinedSides {
public:
    /// One of the blended sources.
    struct Side {
        openvdb::Vec3d at;  ///< lattice coordinates before the carve
        double weight;      ///< all weights sum to 1
        bool nothing;       ///< whether it is background that the carve freed
    };

    /// @param map, block  must outlive this object; the block must hold the points
    JoinedSides(const CarveMap& map, const CarveBlock& block) : map_(map), block_(block) {}

    /// Finds the sides of a point.
    /// @param at  carved lattice coordinates
    void find(const openvdb::Vec3d& at);
    const std::vector<Side>& all() const { return sides_; }
    /// Source of the point's slow part: lattice coordinates before the carve.
    const openvdb::Vec3d& stretched() const { return stretched_; }
    /// Whether the carve frees the point.
    bool freed() const { return sides_.size() == 1 && sides_.front().nothing; }
    /// Whether there is only one side, which is also the source of the slow part.
    bool rigid() const {
        return sides_.size() == 1 && !sides_.front().nothing && sides_.front().at == stretched_;
    }

private:
    /// A step's displacement: smoothed if it is soft, else by whole vertices.
    double displacement(std::size_t step, const openvdb::Vec3d& at) const;

    const CarveMap& map_;
    const CarveBlock& block_;
    std::vector<Side> sides_, next_;
    std::vector<Joins::Side> of_step_;
    openvdb::Vec3d stretched_{0.0};
};

}  // namespace fluidcarve
