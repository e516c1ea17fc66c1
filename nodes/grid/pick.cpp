#include "nodes/grid/pick.h"

#include "nodes/io/grid_names.h"

namespace fluidcarve {
namespace {

struct PickGrids {
    struct Params {
        std::vector<std::string> keep, drop;
    };
    struct Ports {
        Ref<Volume> source, volume;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (params.keep.empty() == params.drop.empty()) check.fault("type", "needs either 'keep' or 'drop'");
    }

    static void run(const Params& params, Ports& io, Context&) {
        const bool keep = !params.keep.empty();
        io.volume = std::make_shared<Volume>(picked(*io.source, keep ? params.keep : params.drop, keep));
    }
};

}  // namespace

Volume picked(const Volume& volume, const std::vector<std::string>& names, bool keep) {
    const auto named = grids_named(volume, names);
    auto out = volume;
    std::erase_if(out.grids, [&](const VolumeGrid& grid) { return named.contains(&grid.header()) != keep; });
    return out;
}

NodeType grid_pick() {
    return Declare<PickGrids>("grid.pick", "Keeps some grids of a volume, or drops them.")
        .input("source", &PickGrids::Ports::source, "The grids.")
        .param("keep", &PickGrids::Params::keep, "Names of the grids to keep, or patterns: vel* is all that begin with vel.")
        .param("drop", &PickGrids::Params::drop, "Names or patterns of the grids to leave out, instead of `keep`.")
        .output("volume", &PickGrids::Ports::volume, "The grids that are left, in their order.")
        .names_as("volume", "source");
}

}  // namespace fluidcarve
