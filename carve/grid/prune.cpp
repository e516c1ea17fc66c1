#include "carve/grid/prune.h"

#include "carve/grid/each_grid.h"

#include <openvdb/tools/Prune.h>
#include <openvdb/tools/ValueTransformer.h>

#include <cmath>
#include <memory>

namespace fluidcarve {

namespace {

template <class Value>
double amount(const Value& value) {
    if constexpr (openvdb::VecTraits<Value>::IsVec) return value.length();
    else return std::abs(static_cast<double>(value));
}

}  // namespace

Volume pruned(const Volume& volume, double tolerance, std::optional<double> below) {
    return each_grid(
        volume,
        [&]<class GridT>(const std::shared_ptr<const GridT>& grid) -> openvdb::GridBase::ConstPtr {
            using Value = typename GridT::ValueType;
            using Element = typename openvdb::VecTraits<Value>::ElementType;
            const auto out = grid->deepCopy();
            if (grid->getGridClass() == openvdb::GRID_LEVEL_SET) {
                if constexpr (std::is_floating_point_v<Value>)
                    openvdb::tools::pruneLevelSet(out->tree());
                return out;
            }
            if constexpr (std::is_floating_point_v<Element>) {
                if (below)
                    // Visits all values: an iterator over active ones loses its count when other
                    // threads make some inactive.
                    openvdb::tools::foreach (out->beginValueAll(),
                                             [background = out->background(), least = *below](
                                                 const typename GridT::ValueAllIter& value) {
                                                 if (!value.isValueOn() || amount(*value) >= least)
                                                     return;
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

}  // namespace fluidcarve
