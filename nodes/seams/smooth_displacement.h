#pragma once

#include "nodes/seams/carve_step.h"

#include <openvdb/Types.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace fluidcarve {

/// How far the displacements of a carve are smoothed (METHOD 10): by a tent along `u`, `v`, `w` and time, whose weight at a
/// distance of `x` is in proportion to `1 - x / (reach + 1)`. Whole vertices move where both are 0.
struct Softness {
    double vertices = 0;
    double frames = 0;
    explicit operator bool() const { return vertices > 0 || frames > 0; }
};

/// A step's displacements `d` in one frame, smoothed, at the vertices `(entry, lateral, k)` of its carved space. Smoothing keeps
/// the map `u + d` monotone, since it is a mean of monotone maps.
class SmoothDisplacement {
public:
    /// Box-filtered along the axis (METHOD 5): over 2n + 1 entries, n the number of the step's seams, but not beyond the first and
    /// the last entry, where fewer count, as many on both sides. So an end moves as far as before.
    explicit SmoothDisplacement(const CarveStep& step);
    /// Smoothed by a tent in space and time; not scaled. Half a vertex beyond either end of a span nothing changes: there the map goes on
    /// as its own mirror image, so that it squeezes what is at an end and cuts nothing off.
    /// @param steps  the same step in neighbouring frames: an odd number, this frame in the middle
    /// @param spans  the step's windows, rising
    static SmoothDisplacement soft(std::span<const CarveStep* const> steps, std::span<const CarveStep::Span> spans, const Softness& softness);

    /// Vertices. @param entry  any: those beyond all that is smoothed move as the nearest that is
    float entry(int entry, int lateral, int k) const {
        const auto all = column(lateral, k);
        return all[static_cast<std::size_t>(std::clamp(entry, first_, last_) - first_)];
    }
    /// The displacements of entries first() to last() of a column.
    std::span<const float> column(int lateral, int k) const {
        const auto size = static_cast<std::size_t>(last_ - first_) + 1;
        const auto column = static_cast<std::size_t>(lateral - first_lateral_) + static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(k);
        return {entries_.data() + column * size, size};
    }
    int first() const { return first_; }  ///< entries below it move as it does
    int last() const { return last_; }    ///< entries above it move as it does

    struct Value {
        double d;                 ///< vertices
        openvdb::Vec3d gradient;  ///< along u, v and w: central differences, one-sided at rims and open ends
    };
    /// Both trilinear between the vertices.
    /// @param at  carved lattice coordinates, inside the step's
    /// @param step  that was smoothed: values and slopes are scaled where it fades
    Value at(const openvdb::Vec3d& at, const CarveStep& step) const;

private:
    SmoothDisplacement(const CarveStep& step, int first, int last);
    /// Replaces each value by a weighted sum of those before and behind it in a lateral direction. @param along_w  else across
    void smooth_across(std::span<const double> weights, bool along_w);

    int axis_, laterals_, slices_, first_lateral_;
    bool closed_;
    Window carved_;                                  ///< entries of the carved space
    std::optional<std::pair<double, double>> ends_;  ///< displacements half a vertex beyond them, where the map is mirrored there
    int first_, last_;                               ///< entries beyond which nothing changes along the axis
    std::vector<float> entries_;                     ///< `[column][entry]`, first_ to last_
};

/// Smooths a step's displacements in space and time.
/// @param seams  what the step was made of
/// @param t      the frame's place in seams.frames
void soften(CarveStep& step, const Seams& seams, std::size_t t, const Softness& softness);

}  // namespace fluidcarve
