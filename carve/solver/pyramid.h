#pragma once

#include "carve/solver/dynamic.h"
#include "carve/solver/search/find_seams.h"
#include "carve/solver/search/strip_messages.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace fluidcarve {

/// How much work is spent on a seam.
enum class Quality { draft, normal, best };

/// Finds seams from coarse to fine (METHOD 8). Images and small energies are solved exactly. Others
/// are first solved at half, a quarter, ... of the resolution. The coarsest is cut as a whole
/// (exactly, except with a field). From there each finer one is solved in a narrow strip around the
/// coarser seam, by messages (search/strip_messages.h) and line sweeps (search/line_sweeps.h).
/// Thin seams are never worse than those of seam.greedy: its searches compete with the coarse one.
class Pyramid {
public:
    static constexpr int usual_starts = 16;
    /// @param starts  number of greedy searches; for slabs it is 1
    Pyramid(Quality quality, int starts) : quality_(quality), starts_(starts) {}

    /// A FindSeam. `bounds`, if given, are computed in parallel with the search from coarse to
    /// fine, and stop greedy searches early.
    Seams::Seam operator()(const EnergyVolume& energy, Window window, int number, const Tick& tick,
                           SeamBounds* bounds = nullptr) const;

private:
    /// A seam at one resolution, and the messages that led to it; none if the energy was cut as a
    /// whole.
    struct Level {
        std::vector<std::uint16_t> seam;
        std::optional<StripMessages> messages;
    };

    /// Number of message passes.
    /// @param reduced  with a field and for slabs, whose seams of less energy look no better: less
    ///   effort
    /// @param level    0: the finest
    int passes(bool reduced, int level) const;
    Level coarse_to_fine(const EnergyVolume& energy, Window window, int number, int level,
                         bool reduced, bool attracts, const std::function<void()>& check) const;
    /// Improves a seam within the strip of its messages.
    /// @param attracts  whether seams are to take marked vertices
    void refine(StripMessages& messages, int level, bool reduced, bool attracts, int number,
                std::vector<std::uint16_t>& seam, const std::function<void()>& check) const;

    Quality quality_;
    int starts_;
    KeptMemory memory_;   ///< of strips and messages
    DynamicSeams lines_;  ///< of energies whose columns stand in one line
};

}  // namespace fluidcarve
