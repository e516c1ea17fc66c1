#pragma once

#include "carve/base/values.h"
#include "carve/seam/window.h"

#include <optional>
#include <string>

namespace fluidcarve {

/// A window as a pipeline states it: `[2, 14]`, first and last vertex along the carved axis, or
/// shares of the way from the first vertex to the last, `[0%, 50%]`, so that it holds for any
/// spacing.
struct VertexRange {
    double first = 0, last = 0;  ///< whole vertices, or percent
    bool percent = false;

    /// The window in vertices; percentages are rounded. @param size  vertices along the axis
    Window of(int size) const;
    /// The window, if it is stated in vertices and so does not depend on the lattice.
    std::optional<Window> vertices() const;
};

/// Pair windows: they grow where the main window shrinks, and the other way round. One lies above
/// the main window; a second may lie below it.
struct PairRanges {
    VertexRange above;
    std::optional<VertexRange> below;
};

/// The window of a range that is stated in vertices; nothing for percentages, or for no range.
std::optional<Window> vertices_of(const Auto<VertexRange>& range);

/// Why a window and its pair window can't lie where they do, for a message; nothing if they can.
/// @param share  whether they may share a vertex
std::optional<std::string> pair_fault(const Window& window, const VertexRange& window_stated,
                                      const Window& pair, const VertexRange& pair_stated,
                                      bool share);

/// The same for a pair below the window. They may share a vertex.
std::optional<std::string> pair_below_fault(const Window& window, const VertexRange& window_stated,
                                            const Window& pair, const VertexRange& pair_stated);

/// The range as a pipeline states it.
std::string to_text(const VertexRange& range);
/// The same for pairs: `[20, 30]`, or `[[0, 8], [20, 30]]`.
std::string to_text(const PairRanges& ranges);

}  // namespace fluidcarve
