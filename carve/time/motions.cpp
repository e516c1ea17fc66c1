#include "carve/time/motions.h"

#include "carve/time/motion.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <exception>

namespace fluidcarve {

Ref<VectorGrid> Motions::from(std::size_t place) const {
    std::promise<Ref<VectorGrid>> promise;
    std::shared_future<Ref<VectorGrid>> motion;
    bool known = false;
    {
        const std::scoped_lock lock(mutex_);
        const auto held = std::ranges::find(found_, place, &Found::place);
        known = held != found_.end();
        if (known) found_.splice(found_.begin(), found_, held);
        else found_.push_front({place, promise.get_future().share()});
        motion = found_.front().motion;
    }
    if (known) return motion.get();
    try {
        // A thread that waits within must not take a task that waits for this one.
        tbb::this_task_arena::isolate([&] { promise.set_value(find(place)); });
    } catch (...) {
        promise.set_exception(std::current_exception());
    }
    forget_old();
    return motion.get();
}

Ref<VectorGrid> Motions::find(std::size_t place) const {
    const auto shown = moving_in(sequence_.at(place), sequence_.at(place + 1));
    if (!shown) return nullptr;
    const auto& numbers = sequence_.numbers();
    const double frames = static_cast<double>(numbers[place + 1]) - numbers[place];
    return motion_between(shown->first, shown->second, scale_ * frames, budget_);
}

void Motions::forget_old() const {
    const std::scoped_lock lock(mutex_);
    std::uint64_t bytes = 0;
    for (auto each = found_.begin(); each != found_.end(); ++each) {
        if (each->motion.wait_for(std::chrono::seconds(0)) != std::future_status::ready) continue;
        try {
            if (const auto motion = each->motion.get()) bytes += motion->memUsage();
        } catch (...) {
            // The caller has got the exception from its future.
        }
        if (bytes > budget_ / 4) return void(found_.erase(each, found_.end()));
    }
}

}  // namespace fluidcarve
