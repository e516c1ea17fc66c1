#pragma once

#include "carve/base/values.h"
#include "carve/time/sequence.h"

#include <cstddef>
#include <cstdint>
#include <future>
#include <list>
#include <mutex>

namespace fluidcarve {

/// The motion from each frame of a sequence to the next, found on first request. The motions
/// requested last are held.
class Motions {
public:
    /// @param sequence       must outlive this
    /// @param scale          displacement per frame at a velocity of 1, world units
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
    mutable std::list<Found> found_;  ///< the last requested one comes first
};

}  // namespace fluidcarve
