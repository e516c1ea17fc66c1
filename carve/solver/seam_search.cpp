#include "carve/solver/seam_search.h"

#include "carve/base/failure.h"
#include "carve/solver/pyramid.h"
#include "carve/solver/search/find_seams.h"
#include "carve/solver/task/no_more.h"
#include "carve/solver/task/space.h"
#include "carve/solver/task/task.h"

#include <memory>
#include <utility>

namespace fluidcarve {

void SeamSearch::add(const Ref<Lattice>& lattice, const FrameGrids& grids) {
    require_ends(wish_, *lattice);
    const int finest = finest_for(wish_, *lattice);
    require_frame_fits(grids, *lattice, limits_.memory, finest);
    const auto frame = sample_frame(grids, lattice, wish_.axis, wish_.measure, finest);
    gathered_.add(wish_, frame, {frames_.at(added_), added_, frames_.size()}, limits_);
    ++added_;
}

Ref<Seams> SeamSearch::find(const Tick& tick) {
    const std::vector<Ref<Seams>> before;
    const CarvedSpace space(gathered_.lattices(), before, frames_);
    const int finest = gathered_.finest();
    const auto task = task_of(wish_, space, finest);
    auto out = std::make_shared<Seams>(empty_seams(wish_, task, space));
    if (task.count == 0) return out;
    gathered_.require_met();
    auto [energy, thick] = gathered_.take(wish_, space, limits_);
    if (thick) out->thickness = thick->thickness * finest;
    const Pyramid pyramid(Quality::normal, 16);
    const auto found = [&, &energy = energy, &thick = thick](const SeamTask::Part& part) {
        Continued search;
        search.memory_budget = limits_.memory;
        search.folder = limits_.folder;
        search.best_effort = wish_.best_effort;
        search.thick = thick;
        if (finest > 1)
            search.full = FullSize{columns_of(task, space), task.shape[dimension(task.axis)]};
        try {
            return find_seams(energy, part.kind, task.count, part.window, pyramid, tick, nullptr,
                              part.static_, search)
                .seams;
        } catch (const NoSeam& none) {
            throw Failure(why_no_more(none, task, part, space));
        }
    };
    // The pair window comes first: seams there do not move the window below.
    if (task.pairs) out->pairs = found(*task.pairs);
    out->seams = found(task.seams);
    out->find_shifts();
    return out;
}

}  // namespace fluidcarve
