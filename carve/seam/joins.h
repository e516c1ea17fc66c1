#pragma once

#include "carve/seam/carve_step.h"

#include <openvdb/Types.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace fluidcarve {

/// Where both sides of each seam of a step meet in one frame, and how they are faded into each
/// other (METHOD 10 "Joins"). A join lies between two carved entries. It is a smooth surface: the
/// mean of the seam's places in columns and frames around.
class Joins {
public:
    /// Content that a point shows a part of: that of the point displaced by whole vertices.
    struct Side {
        double by;      ///< displacement along the axis, vertices
        double weight;  ///< above 0, at most 1
    };

    /// @param steps    the same step in neighbouring frames: an odd number, this frame in the
    ///   middle
    /// @param windows  of the step, rising: fades stay within them
    /// @param fade     vertices over which both sides are faded
    Joins(std::span<const CarveStep* const> steps, std::span<const CarveStep::Span> windows,
          double fade);

    double fade() const { return fade_; }
    /// The sides that a point of the carved space shows. Their weights sum to 1; far from all joins
    /// there is one.
    /// @param at  carved lattice coordinates that the step holds
    /// @param to  becomes the sides, in the order of the joins
    void sides(const openvdb::Vec3d& at, std::vector<Side>& to) const;
    /// Finds the places where a point shows after the step: none if it is removed, several if it is
    /// doubled. Where two sides are blended, each shows as large a part of the points as its
    /// weight; `share` decides whether this point belongs to it.
    /// @param at     lattice coordinates before the step
    /// @param share  of the point, from 0 up to 1, evenly distributed over points
    /// @param to     becomes the coordinates along the axis, rising from side to side
    void places(const CarveStep& step, const openvdb::Vec3d& at, double share,
                std::vector<double>& to) const;
    /// Bounds of the displacements of all sides that points of a box show, vertices.
    /// @param first, size  vertices of the box, by entry, lateral column and slice; columns and
    ///   slices may go round
    std::array<double, 2> range(const std::array<int, 3>& first,
                                const std::array<int, 3>& size) const;

private:
    /// The displacement behind so many seams of a column, vertices.
    double displacement(std::size_t passed) const;
    const float* column(int lateral, int k) const {
        return places_.data() +
               (static_cast<std::size_t>(lateral) +
                static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(k)) *
                   seams_;
    }
    /// Averages places over columns beside each other.
    /// @param ring  whether the last column is beside the first
    void smooth(int count, std::size_t stride, int lines, std::size_t between, bool ring);

    int axis_, lateral_axis_, slice_axis_, laterals_, slices_, first_lateral_, first_slice_, shift_;
    bool inserts_, paired_, closed_, around_;
    std::size_t seams_;  ///< in a column
    double fade_;
    std::vector<CarveStep::Span> windows_;
    std::vector<float> places_;  ///< `[column][seam]`, rising: entries, half a vertex before the
                                 ///< first that is displaced
};

}  // namespace fluidcarve
