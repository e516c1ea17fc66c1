#pragma once

#include "carve/base/values.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// By how much a warp makes a lattice longer along its axis: a number of vertices, which need not
/// be whole, or a percentage of the vertices along the axis, or of the visible content there.
/// Negative makes it shorter. A curve (METHOD 11 "Ramps") states other amounts at other planes or
/// frames; a file may state one curve along the lattice for each of several frames.
struct WarpAmount {
    enum class Along { w, time };
    struct Point {
        /// Along w: 0, the first plane, to 1, the last one; along time: a frame number.
        double at = 0;
        Count amount;
    };
    struct Factor {
        double at = 0;  ///< place along the other dimension
        double factor = 0;
    };
    struct Section {
        double at = 0;              ///< a frame number
        std::vector<Point> points;  ///< along w
    };

    /// The least distance between the places of two points.
    static constexpr double least_step = 1e-6;

    Count constant;          ///< the amount everywhere, if there is no curve
    Along along = Along::w;  ///< of `points`
    /// Points of a curve, rising; linear between them, constant beyond; empty: no curve.
    std::vector<Point> points;
    std::vector<Factor> factors;  ///< along the other dimension, the same way; empty: all 1
    /// Curves at frames, rising; linear between them, constant beyond. There are then no `points`
    /// and `factors`; empty: none.
    std::vector<Section> sections;

    bool varies() const { return !points.empty() || !sections.empty(); }
    bool varies_along(Along dimension) const {
        return varies() && (dimension == along || !factors.empty() || !sections.empty());
    }
    /// Whether all amounts are 0.
    bool nothing() const;
    /// The same with all percentages in vertices. @param size  vertices that make 100 %
    WarpAmount in_vertices(double size) const;
    /// Whether any part of it is a percentage.
    bool has_percent() const;
    /// The amount of a plane in a frame, vertices.
    /// @param w     place of the plane along the lattice, 0 to 1
    /// @param size  vertices along the axis
    double at(double w, double frame, int size) const;
};

template <>
struct ChoiceNames<WarpAmount::Along> {
    static constexpr std::array names = {std::pair{"w", WarpAmount::Along::w},
                                         std::pair{"time", WarpAmount::Along::time}};
};

/// The amount as a pipeline states it.
std::string to_text(const WarpAmount& amount);

}  // namespace fluidcarve
