#pragma once

#include "carve/lattice/rig_extent.h"
#include "carve/seam/anchor.h"
#include "carve/seam/vertex_range.h"
#include "carve/warp/amount.h"
#include "graph/types/param.h"

#include <optional>
#include <string>

// How a pipeline states the method's own types.

namespace fluidcarve {

/// An anchor is `low`, `middle`, `high`, or a vertex.
template <>
struct ParamTraits<Anchor> {
    static Shape shape();
    static std::optional<Anchor> parse(const Value& value, ValueReader& reader);
    static std::string text(const Anchor& anchor);
};

/// `[-1.5, 1.5]`, or shares, `[-150%, 150%]`.
template <>
struct ParamTraits<RigExtent> {
    static Shape shape();
    static std::optional<RigExtent> parse(const Value& value, ValueReader& reader);
    static std::string text(const RigExtent& extent);
};

/// `[2, 14]`, or shares, `[0%, 50%]`.
template <>
struct ParamTraits<VertexRange> {
    static Shape shape();
    static std::optional<VertexRange> parse(const Value& value, ValueReader& reader);
    static std::string text(const VertexRange& range);
};

/// A range, or two, of which the first lies below the main window: `[[0%, 20%], [80%, 100%]]`.
template <>
struct ParamTraits<PairRanges> {
    static Shape shape();
    static std::optional<PairRanges> parse(const Value& value, ValueReader& reader);
    static std::string text(const PairRanges& ranges);
};

/// `-7.25`, `-30%`, or `{along: w | time, at: [[0, 0], [1, -12]], over: [[1, 0], [24, 1]]}`.
template <>
struct ParamTraits<WarpAmount> {
    static Shape shape();
    static std::optional<WarpAmount> parse(const Value& value, ValueReader& reader);
    static std::string text(const WarpAmount& amount);
};

}  // namespace fluidcarve
