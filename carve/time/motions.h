#pragma once

#include "carve/base/values.h"
#include "carve/time/sequence.h"

#include <cstddef>
#include <cstdint>
#include <future>
#include <list>
#include <mutex>

namespace fluidcarve {

/// How things move from each frame of a sequence to the next, found when it is first asked for.
/// Those asked for last are held.
class Motions {
public:
    /// @param sequence       must outlive this
    /// @param scale          how far a velocity of 1 moves in a frame, world units
    /// @param memory_budget  bytes; a quarter may be held
    Motions(const Sequence& sequence, double scale, std::uint64_t memory_budget)
        : sequence_(sequence), scale_(scale), budget_(memory_budget) {}

    /// May be called from many threads at once.
    /// @param place  of the first of both frames in the sequence
    /// @return as motion_between(); null: no float grid shows where things move
    /// @throws Failure as motion_between()
    Ref<VectorGrid> from(std::size_t place) const;

private:
    struct Found {
        std::size_t place;
        std::shared_future<Ref<VectorGrid>> motion;
    };

    Ref<VectorGrid> find(std::size_t place) const;
    void forget_old() const;

    const Sequence& sequence_;
    double scale_;
    std::uint64_t budget_;
    mutable std::mutex mutex_;
    mutable std::list<Found> found_;  ///< asked for last comes first
};

}  // namespace fluidcarve
