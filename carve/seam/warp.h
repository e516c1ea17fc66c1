#pragma once

#include "carve/base/frame_store.h"
#include "carve/base/limits.h"
#include "carve/seam/anchor.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace fluidcarve {

/// A displacement of content along a lattice's axis, found as a whole (METHOD 4 "Warps"). The
/// content of vertex `(u, lateral, k)` in frame `t` goes to `u + scale() * value`, vertices. Values
/// stand at points. Point `p` of a dimension of `n` vertices stands at vertex `min(p * factor(), n
/// - 1)`. In a ring the point behind the last one is the first, at vertex `n`. Between points the
/// displacement is trilinear.
/// Copies share their values, but not their scale.
class Warp {
public:
    /// Dimensions whose last vertex is followed by their first.
    struct Rings {
        bool lateral = false;  ///< in a lattice around its rig
        bool w = false;        ///< in a closed lattice
        bool operator==(const Rings&) const = default;
    };

    /// All values are 0 at first.
    /// @param vertices  number of vertices along the axis, along the lateral axis and along w
    /// @param factor    vertices from point to point: 1, 2 or 4
    /// @param frames    number of frames; 1 if the warp is the same in all frames
    /// @param limits    a warp that needs more memory is held in a file
    /// @throws Failure if neither memory nor disk can hold the values
    Warp(const std::array<int, 3>& vertices, const Rings& rings, int factor, std::size_t frames,
         const Limits& limits = {});

    /// Number of points along the axis, laterally and along w.
    static std::array<int, 3> points_of(const std::array<int, 3>& vertices, const Rings& rings,
                                        int factor);
    /// Along the axis, laterally, along w.
    const std::array<int, 3>& vertices() const { return vertices_; }
    /// Along the axis, laterally, along w.
    const std::array<int, 3>& points() const { return points_; }
    const Rings& rings() const { return rings_; }
    int factor() const { return factor_; }
    std::size_t frames() const { return values_->count(); }
    /// The vertex at which a point stands.
    int vertex_of(std::size_t dimension, int point) const {
        return std::min(point * factor_, vertices_[dimension] - 1);
    }

    /// Values of a frame, `[k][lateral][u]`, of points; vertices, not scaled.
    /// @param t  index of the frame; any, if the warp is the same in all frames
    std::span<float> values(std::size_t t);
    std::span<const float> values(std::size_t t) const;

    double scale() const { return scale_; }
    void set_scale(double scale) { scale_ = scale; }  ///< the displacement is linear in it

    /// Whether every scale gives the warp of an amount; else only the present scale does.
    bool linear() const { return linear_; }
    void set_linear(bool linear) { linear_ = linear; }

    /// Scaled displacements of a column's vertices. Where all values around a vertex are 0, its
    /// displacement is exactly 0.
    /// @param lateral, k  vertices
    /// @param out         vertices()[0] of them; vertices
    void column(std::size_t t, int lateral, int k, std::span<float> out) const;

    /// The first and the last of a column's displacements.
    std::array<double, 2> ends(std::size_t t, int lateral, int k) const;

    /// Subtracts from each column, in each frame, the displacement of the anchor there: low: the
    /// first value; middle: half of both ends' sum; high: the last value; vertex: the value there.
    /// So a column of zeros stays as it is.
    void anchor_at(const Anchor& anchor);

    /// Smallest and largest value, not scaled.
    struct Range {
        float least = 0, most = 0;
    };
    /// Bounds over all columns and frames.
    struct Bounds {
        Range first, last;  ///< values at the first and at the last vertex
        Range slope;        ///< vertices per vertex along the axis
        Range value;
    };
    /// Finds bounds(). Call it once values are set.
    void find_bounds();
    const Bounds& bounds() const { return bounds_; }
    /// One of the bounds, scaled. The map `u + displacement` rises, and so inverts no space, if
    /// the least scaled slope is above -1.
    Range scaled(const Range& range) const;

private:
    /// Calls `use` with a function that returns the scaled displacement of a point of a column.
    template <class Use>
    void with_column(std::size_t t, int lateral, int k, const Use& use) const;

    std::array<int, 3> vertices_, points_;
    Rings rings_;
    int factor_;
    double scale_ = 1;
    bool linear_ = true;
    Bounds bounds_;
    std::shared_ptr<FloatFrameStore> values_;
};

}  // namespace fluidcarve
