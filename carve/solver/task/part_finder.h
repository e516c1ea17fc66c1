#pragma once

#include "carve/base/limits.h"
#include "carve/solver/costs/energy_volume.h"
#include "carve/solver/search/find_seams.h"
#include "carve/solver/task/space.h"
#include "carve/solver/task/task.h"

#include <cstdint>
#include <functional>

namespace fluidcarve {

/// Finds the seams of a task, part by part. The energies, the seams of all parts and the search
/// share the memory that the limits allow; seams that do not fit go to files.
class PartFinder {
public:
    /// All but the limits must outlive it.
    /// @param energy  is consumed
    PartFinder(EnergyVolume& energy, const SeamTask& task, const CarvedSpace& space,
               const FindSeam& find, Limits limits);

    /// Bytes that a search may hold besides energies and seams.
    std::uint64_t memory() const { return fits_ ? limits_.memory - taken_ : 0; }

    /// @param count   of seams, including those that an earlier search found
    /// @param search  options of the search; its memory, folder and full size are set here
    /// @throws Failure saying how many seams are possible, and where the next one is blocked
    FoundSeams operator()(const SeamPart& part, int count, const Tick& tick,
                          SearchOptions search) const;

private:
    EnergyVolume& energy_;
    const SeamTask& task_;
    const CarvedSpace& space_;
    const FindSeam& find_;
    const Limits limits_;
    const std::uint64_t taken_;  ///< bytes of energies and seams
    const bool fits_;
};

/// What was found in the windows of a task. If there are more second seams than first ones, those
/// without a first seam are to be dropped.
struct FoundParts {
    FoundSeams pairs, seams;
};
/// Finds the seams of all windows of a task. The pair window comes first: seams there do not move
/// the window below. Then there are no more seams to find than pairs were found.
/// @param find  finds `count` seams of a part; `pairs` are those found before
FoundParts find_parts(const SeamTask& task,
                      const std::function<FoundSeams(const SeamPart& part, int count,
                                                     const FoundSeams& pairs)>& find);

}  // namespace fluidcarve
