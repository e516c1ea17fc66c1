#include "nodes/grid/prune.h"

#include "nodes/grid/each_grid.h"

#include <openvdb/tools/Prune.h>
#include <openvdb/tools/ValueTransformer.h>

#include <cmath>
#include <type_traits>

namespace fluidcarve {
namespace {

struct Prune {
    struct Params {
        double tolerance = 0;
        Auto<double> below;
    };
    struct Ports {
        Ref<Volume> source, volume;
    };
    static void run(const Params& params, Ports& io, Context&) { io.volume = std::make_shared<Volume>(pruned(*io.source, params.tolerance, params.below)); }
};

template <class Value>
double amount(const Value& value) {
    if constexpr (openvdb::VecTraits<Value>::IsVec) return value.length();
    else return std::abs(static_cast<double>(value));
}

}  // namespace

Volume pruned(const Volume& volume, double tolerance, std::optional<double> below) {
    return each_grid(volume, [&]<class GridT>(const std::shared_ptr<const GridT>& grid) -> openvdb::GridBase::ConstPtr {
        using Value = typename GridT::ValueType;
        using Element = typename openvdb::VecTraits<Value>::ElementType;
        const auto out = grid->deepCopy();
        if (grid->getGridClass() == openvdb::GRID_LEVEL_SET) {
            if constexpr (std::is_floating_point_v<Value>) openvdb::tools::pruneLevelSet(out->tree());
            return out;
        }
        if constexpr (std::is_floating_point_v<Element>) {
            if (below)
                // Of all values: an iterator of active ones loses its count when other threads make some inactive.
                openvdb::tools::foreach (out->beginValueAll(), [background = out->background(), least = *below](const typename GridT::ValueAllIter& value) {
                    if (!value.isValueOn() || amount(*value) >= least) return;
                    value.setValue(background);
                    value.setActiveState(false);
                });
            openvdb::tools::prune(out->tree(), Value(Element(tolerance)));
        } else {
            openvdb::tools::prune(out->tree());
        }
        return out;
    });
}

NodeType grid_prune() {
    return Declare<Prune>("grid.prune", "Makes grids smaller: takes out what hardly shows, and joins equal voxels to tiles.")
        .input("source", &Prune::Ports::source, "The grids, or one grid.")
        .param("tolerance", &Prune::Params::tolerance, Unit::none, at_least(0),
               "Voxels that differ by no more become a tile of their median, in the unit of each grid. 0 joins only equal ones.")
        .param("below", &Prune::Params::below, Unit::none, at_least(0),
               "Values of less, or vectors of less length, become background and inactive. auto takes nothing out. Level sets are left out.")
        .output("volume", &Prune::Ports::volume, "The same grids. Points stay.")
        .names_as("volume", "source");
}

}  // namespace fluidcarve
