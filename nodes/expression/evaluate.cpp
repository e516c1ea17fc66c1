#include "nodes/expression/evaluate.h"

#include "carve/base/failure.h"
#include "carve/base/find_or_null.h"
#include "carve/base/words.h"
#include "carve/field/collocate.h"
#include "carve/field/lowest_wrong.h"
#include "carve/field/same_transform.h"

#include <fmt/format.h>

#include <cmath>

namespace fluidcarve {
namespace {

using openvdb::FloatTree;

/// The grid in the form that a program reads: a mask as 1 and 0, a staggered vector grid
/// collocated.
openvdb::GridBase::ConstPtr readable(const std::string& name,
                                     const openvdb::GridBase::ConstPtr& grid,
                                     std::uint64_t budget) {
    if (grid->isType<FloatGrid>()) return grid;
    if (const auto vectors = openvdb::gridConstPtrCast<VectorGrid>(grid)) {
        require_collocation_fits(*vectors, budget);
        return collocated(vectors);
    }
    if (!grid->isType<MaskGrid>())
        throw Failure(
            fmt::format("input '{}' is the grid '{}' of type {}; programs read numbers (float), "
                        "vectors (vec3s) and masks",
                        name, grid->getName(), grid->valueType()));
    const auto out = FloatGrid::create(std::make_shared<FloatTree>(
        openvdb::gridConstPtrCast<MaskGrid>(grid)->tree(), 0.0f, 1.0f, openvdb::TopologyCopy()));
    out->setName(grid->getName());
    out->setTransform(grid->transform().copy());
    return out;
}

/// A tree with the union of the grids' active voxels and leaves.
FloatTree::Ptr united_topology(const std::vector<NamedGrid>& grids) {
    FloatTree::Ptr out;
    const auto add = [&](const auto& tree) {
        if (out) out->topologyUnion(tree);
        else out = std::make_shared<FloatTree>(tree, 0.0f, openvdb::TopologyCopy());
    };
    for (const auto& [name, grid] : grids) {
        if (grid->isType<FloatGrid>()) add(static_cast<const FloatGrid&>(*grid).tree());
        else add(static_cast<const VectorGrid&>(*grid).tree());
    }
    return out;
}

using GridInputs = std::vector<std::pair<std::string, Ref<AnyGrid>>>;
/// A place in a program's text, as messages name it.
using PlaceText = std::function<std::string(int line, int column)>;

/// The inputs in the form that a program reads. @throws Failure if it reads one as another kind
std::vector<NamedGrid> readable_inputs(const CompiledExpression& program, const GridInputs& inputs,
                                       std::uint64_t budget, const PlaceText& place) {
    std::vector<NamedGrid> out;
    for (const auto& [name, any] : inputs) {
        const auto grid = readable(name, any->grid, budget);
        const auto* const read =
            find_or_null(program.reads, name, &CompiledExpression::Read::input);
        if (read && read->vector != grid->isType<VectorGrid>())
            throw Failure(fmt::format(
                "input '{0}' holds {1}, but {2} reads it as {3}@{0}; write {4}@{0}", name,
                read->vector ? "numbers" : "vectors", place(read->line, read->column),
                read->vector ? "v" : "", read->vector ? "" : "v"));
        if (!out.empty())
            require_same_transform(fmt::format("inputs '{}' and '{}'", out.front().first, name),
                                   *out.front().second, *grid);
        out.emplace_back(name, grid);
    }
    return out;
}

}  // namespace

FloatGrid::Ptr evaluated(const ExpressionModule& module, const CompiledExpression& program,
                         const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs,
                         const std::string& output, float least, std::uint64_t budget,
                         const std::function<std::string(int line, int column)>& place) {
    const auto grids = readable_inputs(program, inputs, budget, place);
    const auto out = FloatGrid::create(united_topology(grids));
    out->setTransform(grids.front().second->transform().copy());
    out->setName(output);
    if (const auto bytes = out->activeVoxelCount() * sizeof(float);
        program.asks_where && bytes > budget)
        throw Failure(
            fmt::format("the program reads voxel positions, so each of {} voxels, also of those in "
                        "tiles, needs its own value: {:.1f} GiB, but --memory allows {:.1f}",
                        out->activeVoxelCount(), static_cast<double>(bytes) / 0x1p30,
                        static_cast<double>(budget) / 0x1p30));
    module.run(program, grids, *out);
    if (const auto wrong = lowest_wrong(*out, least))
        throw Failure(fmt::format(
            "@{} is {} at voxel [{}]; {}", output, wrong->value, numbers_text(wrong->at),
            std::isfinite(wrong->value)
                ? fmt::format("it must be at least {}: use max(..., {}) or abs(...)", least, least)
                : "guard divisions, roots and logarithms against inputs such as 0 or negative "
                  "numbers"));
    return out;
}

}  // namespace fluidcarve
