#include "nodes/seam/seam_node.h"

#include "nodes/seam/energy_slab.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace fluidcarve {

namespace {

std::string text(const openvdb::BBoxd& box) {
    return fmt::format("({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g})", box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z());
}

Window window_of(const SeamNode::Params& params, int size) {
    if (!params.window) return {0, size - 1};
    const auto& [low, high] = *params.window;
    if (high > size - 1)
        throw Failure(
            fmt::format("window [{:g}, {:g}] leaves the lattice, which has {} vertices along {}: 0 to {}", low, high, size, to_text(params.axis), size - 1));
    return {static_cast<int>(low), static_cast<int>(high)};
}

}  // namespace

void SeamNode::check(const Params& params, NodeCheck& check) {
    if (params.window && (std::floor(params.window->low) != params.window->low || std::floor(params.window->high) != params.window->high))
        check.fault("window", fmt::format("parameter 'window' wants whole vertices, not [{:g}, {:g}]", params.window->low, params.window->high));
}

void SeamNode::add(const Params& params, const Ports& io, Context& context) {
    const bool first = added_++ == 0;
    const auto& lattice = *io.lattice;
    const int size = lattice.shape[static_cast<std::size_t>(params.axis)];
    // A window that does not fit is better told before the frames are read than after.
    if (first) window_of(params, size);
    transform_.require("the energy", *io.energy, context.frame());
    if (params.count.of(size) == 0) return;
    if (!energy_) energy_.emplace(lattice.shape, params.axis, context.frames().size(), context.memory_budget(), context.work_folder());
    if (const auto box = io.energy->evalActiveVoxelBoundingBox(); !box.empty()) {
        any_active_ = true;
        any_met_ = any_met_ || meets_active_voxels(*io.energy, lattice);
        active_box_.expand(io.energy->transform().indexToWorld(openvdb::BBoxd(box.min().asVec3d(), box.max().asVec3d())));
    }
    sample_energy(*io.energy, lattice, params.axis, energy_->slab(context.place()));
}

void SeamNode::solve(const Params& params, Ports& io, Context& context, const FindSeam& find) {
    const auto& lattice = *io.lattice;
    const auto& frames = context.frames();
    const int size = lattice.shape[static_cast<std::size_t>(params.axis)], count = params.count.of(size);
    const auto window = window_of(params, size);

    auto out = std::make_shared<Seams>();
    out->axis = params.axis;
    out->kind = count > 0 ? Seams::Kind::insert : Seams::Kind::remove;
    out->shape = lattice.shape;
    out->frames = frames;
    out->lattice = lattice.description;
    out->lattice_hash = lattice.hash;

    std::vector<double> energies, seconds;
    if (energy_) {
        if (any_active_ && !any_met_)
            throw Failure(fmt::format("the lattice misses the energy: its {}, but the active voxels span {}", lattice.description, text(active_box_)));
        // An energy that is the same for all frames comes once.
        for (std::size_t t = added_; t < frames.size(); ++t) std::ranges::copy(energy_->slab(0), energy_->slab(t).begin());
        // Energies and seams share the budget; what does not fit with the energies goes beside them on disk.
        const auto columns = out->columns_per_frame() * frames.size();
        const auto seam_bytes = static_cast<std::uint64_t>(std::abs(count)) * columns * sizeof(std::uint16_t);
        const auto energy_bytes = static_cast<std::uint64_t>(columns) * energy_->stride() * sizeof(std::uint16_t);
        KeepSeam keep;
        if (energy_bytes + seam_bytes > context.memory_budget())
            keep = [&](const SeamEntries& entries) { return SeamEntries::in_file(entries, context.work_folder()); };
        auto found = find_seams(
            *energy_, out->kind, std::abs(count), window, find,
            [&](double fraction) {
                context.check_cancelled();
                context.progress(fraction);
            },
            keep);
        energy_.reset();
        out->seams = std::move(found.seams);
        seconds = std::move(found.wall_s);
        for (const auto& seam : out->seams) energies.push_back(seam.energy);
        if (std::all_of(energies.begin(), energies.end(), [](double energy) { return energy == 0; }))
            context.warn("no seam meets any energy, so that carving may change nothing visible; `window: [first, last]` holds seams where the content is");
    }
    context.report("seams", {{"axis", to_text(out->axis)},
                             {"kind", to_text(out->kind)},
                             {"shape", {lattice.shape[0], lattice.shape[1], lattice.shape[2], frames.size()}},
                             {"energy", energies},
                             {"wall_s", seconds}});
    io.seams = std::move(out);
}

}  // namespace fluidcarve
