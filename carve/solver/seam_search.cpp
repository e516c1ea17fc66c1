#include "carve/solver/seam_search.h"

#include "carve/solver/pyramid.h"
#include "carve/solver/search/find_seams.h"
#include "carve/solver/task/part_finder.h"
#include "carve/solver/task/space.h"
#include "carve/solver/task/task.h"

#include <memory>
#include <utility>
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
    auto [energy, thick, thickness] = gathered_.take_priced(params_, space, limits_);
    out->thickness = thickness;
    const FindSeam solver = Pyramid(Quality::normal, Pyramid::usual_starts);
    const PartFinder find(energy, task, space, solver, limits_);
    SearchOptions search;
    search.best_effort = params_.best_effort;
    search.thick = thick;
    auto found =
        find_parts(task, [&](const SeamPart& part, int count, const FoundSeams& /*pairs*/) {
            return find(part, count, tick, search);
        });
    out->seams = std::move(found.seams.seams);
    out->pairs = std::move(found.pairs.seams);
    if (task.pairs) out->pairs.resize(out->seams.size());
    out->find_shifts();
    return out;
}

}  // namespace fluidcarve
