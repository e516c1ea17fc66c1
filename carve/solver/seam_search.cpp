#include "carve/solver/seam_search.h"

#include "carve/solver/pyramid.h"
#include "carve/solver/search/find_seams.h"
#include "carve/solver/task/part_finder.h"
#include "carve/solver/task/space.h"
#include "carve/solver/task/task.h"

#include <memory>
#include <vector>

namespace fluidcarve {

void SeamSearch::add(const Ref<Lattice>& lattice, const FrameGrids& grids) {
    require_ends(params_, lattice->form());
    const int finest = finest_for(params_, *lattice);
    require_frame_fits(grids, *lattice, limits_.memory, finest);
    const auto frame = sample_frame(grids, lattice, params_.axis, params_.measure, finest);
    gathered_.add(params_, frame, {frames_.at(added_), added_, frames_.size()}, limits_);
    ++added_;
}

Ref<Seams> SeamSearch::find(const Tick& tick) {
    const std::vector<Ref<Seams>> before;
    params_ = params_for(params_, gathered_.has_field(), frames_.size());
    const CarvedSpace space(gathered_.lattices(), before, frames_);
    const int finest = gathered_.finest();
    const auto task = task_of(params_, space, finest);
    auto out = std::make_shared<Seams>(empty_seams(params_, task, space));
    if (task.count == 0) return out;
    gathered_.require_met();
    auto [energy, thick] = gathered_.take(params_, space, limits_);
    if (thick) out->thickness = thick->thickness * finest;
    const FindSeam solver = Pyramid(Quality::normal, Pyramid::usual_starts);
    const PartFinder found(energy, task, space, solver, limits_);
    SearchOptions search;
    search.best_effort = params_.best_effort;
    search.thick = thick;
    int count = task.count;
    // The pair window comes first: seams there do not move the window below.
    if (task.pairs) {
        out->pairs = found(*task.pairs, count, tick, search).seams;
        count = static_cast<int>(out->pairs.size());
    }
    out->seams = found(task.seams, count, tick, search).seams;
    // Drops second seams whose first seam was not found.
    if (task.pairs) out->pairs.resize(out->seams.size());
    out->find_shifts();
    return out;
}

}  // namespace fluidcarve
