#pragma once

#include "carve/seam/carve_step.h"

#include <openvdb/Types.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace fluidcarve {

/// The joins of a step in one frame: the surfaces at which both sides of each seam are blended
/// (METHOD 10 "Joins"). A join lies between two carved entries. It is smooth: the mean of the
/// seam's positions in neighbouring columns and frames.
class Joins {
public:
    /// One of the sources blended at a point: the point displaced by whole vertices.
    struct Side {
        double by;      ///< displacement along the axis, vertices
        double weight;  ///< above 0, at most 1
    };

    /// @param steps    the same step in neighbouring frames: an odd number, this frame in the
    ///   middle
    /// @param windows  of the step, rising: fades stay within them
    /// @param fade     vertices over which both sides are blended
    Joins(std::span<const CarveStep* const> steps, std::span<const CarveStep::Span> windows,
          double fade);

    double fade() const { return fade_; }
    /// Finds the sides blended at a point of the carved space. Their weights sum to 1; far from
    /// all joins there is only one side.
    /// @param at  carved lattice coordinates that the step holds
    /// @param to  becomes the sides, in the order of the joins
    void sides(const openvdb::Vec3d& at, std::vector<Side>& to) const;
    /// Finds the places of a particle after the step: none if it is removed, several if it is
    /// doubled. Where sides are blended, each side shows a fraction of the particles equal to its
    /// weight; `share` decides whether this particle is among them.
    /// @param at     lattice coordinates before the step
    /// @param share  the particle's own number in [0, 1), evenly distributed over particles
    /// @param to     becomes the coordinates along the axis, rising from side to side
    void places(const CarveStep& step, const openvdb::Vec3d& at, double share,
                std::vector<double>& to) const;
    /// Bounds of the displacements of all sides of all points of a box, vertices.
    /// @param first, size  vertices of the box, by entry, lateral column and slice; columns and
    ///   slices may go round
    std::array<double, 2> range(const std::array<int, 3>& first,
                                const std::array<int, 3>& size) const;

private:
    /// The displacement behind the first `passed` seams of a column, vertices.
    double displacement(std::size_t passed) const;
    /// @param index  ColumnGrid::index
    const float* column(std::size_t index) const { return places_.data() + index * seams_; }

    ColumnGrid columns_;
    int shift_;
    bool inserts_, paired_;
    std::size_t seams_;  ///< in a column
    double fade_;
    std::vector<CarveStep::Span> windows_;
    std::vector<float> places_;  ///< `[column][seam]`, rising: positions of the joins, half a
                                 ///< vertex before the first displaced entry
};

}  // namespace fluidcarve
