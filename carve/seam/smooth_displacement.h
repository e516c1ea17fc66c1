#pragma once

#include "carve/base/frame_store.h"
#include "carve/seam/carve_step.h"

#include <openvdb/Types.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>

namespace fluidcarve {

/// How far the displacements of a carve are smoothed (METHOD 10): by a tent along `u`, `v`, `w` and
/// time. Its weight at distance `x` is proportional to `1 - x / (reach + 1)`. Whole vertices move
/// if both reaches are 0.
struct Softness {
    double vertices = 0;  ///< reach along u, v and w
    double frames = 0;    ///< reach in time
    double fade = 0;      ///< vertices over which both sides of seams are blended (Joins); 0: they
                          ///< are not
    std::optional<double> across = std::nullopt;  ///< reach across the axis; nothing: as along it
    explicit operator bool() const { return vertices > 0 || frames > 0; }
};

/// Smoothed displacements `d` of a step in one frame, at the vertices `(entry, lateral, slice)` of
/// its carved space. The map `u + d` stays monotone, since it is a mean of monotone maps.
class SmoothDisplacement {
public:
    /// Box-filters displacements along the axis (METHOD 5), over 2n + 1 entries, where n is the
    /// number of the step's seams. Near the first and last entry the filter is narrower, but
    /// symmetric, so that an end moves as far as before.
    explicit SmoothDisplacement(const CarveStep& step);
    /// Smooths displacements by a tent in space and time. They are not scaled by
    /// CarveStep::rim_scale. Half a vertex beyond either end of a span, displacements stay as they
    /// were: the map continues there as its own mirror image. So content at an end is squeezed, not
    /// cut off.
    /// @param steps    the same step in neighbouring frames: an odd number, this frame in the
    ///   middle
    /// @param windows  of the step, rising
    static SmoothDisplacement soft(std::span<const CarveStep* const> steps,
                                   std::span<const CarveStep::Span> windows,
                                   const Softness& softness);

    /// Displacements of a warp: the inverse of its map from the space before to the carved one,
    /// column by column. Beyond the ends of the content the map continues straight.
    /// @param step  the warp's step; its displacements are not read
    static SmoothDisplacement of(const CarveStep& step, const Warp& warp, std::size_t t);

    /// Displacement of an entry, vertices.
    /// @param entry   any; entries outside first() to last() move as the nearest one inside
    /// @param column  ColumnGrid::index
    float entry(int entry, std::size_t column) const {
        const auto all = this->column(column);
        return all[static_cast<std::size_t>(std::clamp(entry, first_, last_) - first_)];
    }
    float entry(int at, int lateral, int slice) const {
        return entry(at, columns_.index(lateral, slice));
    }
    /// Displacements of entries first() to last() of a column, vertices.
    /// @param column  ColumnGrid::index
    std::span<const float> column(std::size_t column) const {
        const auto size = static_cast<std::size_t>(last_ - first_) + 1;
        return {entries_->entries(0).data() + column * row_, size};
    }
    std::span<const float> column(int lateral, int slice) const {
        return column(columns_.index(lateral, slice));
    }
    int first() const { return first_; }  ///< entries below it move as it does
    int last() const { return last_; }    ///< entries above it move as it does

    /// A displacement and its gradient.
    struct Value {
        double d;                 ///< vertices
        openvdb::Vec3d gradient;  ///< of d along u, v and w: central differences, one-sided at rims
                                  ///< and open ends
    };
    /// Displacement and gradient at a point, trilinear between the vertices.
    /// @param at    carved lattice coordinates, inside the step's
    /// @param step  the step that was smoothed; its rims' fade scales values and slopes
    Value at(const openvdb::Vec3d& at, const CarveStep& step) const;

private:
    SmoothDisplacement(const CarveStep& step, int first, int last);
    /// Makes room for entries first_ to `last`, all 0.
    void resize(int last);
    float* entries() { return entries_->entries(0).data(); }

    ColumnGrid columns_;
    Window carved_;                                  ///< entries of the carved space
    std::optional<std::pair<double, double>> ends_;  ///< displacements half a vertex beyond these
                                                     ///< entries; set if the map is mirrored there
    int first_, last_;  ///< displacements are constant along the axis below first_ and above last_
    std::size_t row_;   ///< floats per column in entries_: one per entry, then zeros
    /// `[column][entry]`, entries first_ to last_, vertices; copies share it.
    std::shared_ptr<FloatFrameStore> entries_;
};

/// Smooths a step's displacements in space and time.
/// @param seams  the seams that the step was made of; no warp
/// @param t      index of the frame in seams.frames
void soften(CarveStep& step, const Seams& seams, std::size_t t, const Softness& softness);

}  // namespace fluidcarve
