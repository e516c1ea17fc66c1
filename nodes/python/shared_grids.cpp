#include "nodes/python/shared_grids.h"

#include "graph/text/words.h"
#include "nodes/field/collocate.h"
#include "nodes/field/dense.h"
#include "nodes/field/same_transform.h"

#include <fmt/format.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <type_traits>

namespace fluidcarve {
namespace {

using Json = nlohmann::json;
using openvdb::Coord;
using MaskLeaf = openvdb::MaskTree::LeafNodeType;

constexpr std::uint64_t leaf_voxels = MaskLeaf::SIZE, leaf_states = leaf_voxels / 8;
constexpr std::uint64_t alignment = 64;

/// A place for so many bytes behind those before.
std::uint64_t reserved(std::uint64_t& at, std::uint64_t bytes) {
    const auto out = at;
    at += (bytes + alignment - 1) / alignment * alignment;
    return out;
}

openvdb::GridBase::ConstPtr shareable(const std::string& name, const openvdb::GridBase::ConstPtr& grid, std::uint64_t budget) {
    if (const auto vectors = openvdb::gridConstPtrCast<VectorGrid>(grid)) {
        require_collocation_fits(*vectors, budget);
        return collocated(vectors);
    }
    if (!grid->isType<FloatGrid>() && !grid->isType<MaskGrid>())
        throw Failure(fmt::format("input '{}' is the grid '{}' of type {}; scripts take numbers (float), vectors (vec3s) and masks", name, grid->getName(),
                                  grid->valueType()));
    return grid;
}

/// Calls `with` with a grid as what it is.
template <class With>
auto as_its_type(const openvdb::GridBase& grid, const With& with) {
    if (grid.isType<FloatGrid>()) return with(static_cast<const FloatGrid&>(grid));
    if (grid.isType<VectorGrid>()) return with(static_cast<const VectorGrid&>(grid));
    return with(static_cast<const MaskGrid&>(grid));
}

/// Bytes of the values in a leaf; a mask has states alone.
std::uint64_t value_bytes(const openvdb::GridBase& grid) {
    return grid.isType<FloatGrid>() ? leaf_voxels * sizeof(float) : grid.isType<VectorGrid>() ? leaf_voxels * sizeof(openvdb::Vec3s) : 0;
}

Json json_of(const Coord& at) { return {at.x(), at.y(), at.z()}; }
Json json_of(float value) { return value; }
Json json_of(const openvdb::Vec3s& value) { return {value[0], value[1], value[2]}; }

/// Tiles that are inactive and not background, such as the inside of a level set: [x, y, z, edge, value] each.
template <class Grid>
Json tiles_of(const Grid& grid) {
    auto out = Json::array();
    auto tile = grid.tree().cbeginValueOff();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        if (*tile != grid.background()) {
            const auto box = tile.getBoundingBox();
            out.push_back({json_of(box.min()), box.dim().x(), json_of(*tile)});
        }
    return out;
}

/// World = matrix * (index, 1), rows of 4; null if the transform is none of that kind.
Json matrix_of(const openvdb::math::Transform& transform) {
    if (!transform.isLinear()) return nullptr;
    const auto matrix = transform.baseMap()->getAffineMap()->getMat4();
    auto out = Json::array();
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) out.push_back(matrix(column, row));
    return out;
}

void copy_states(const MaskLeaf::NodeMaskType& mask, std::byte* to) {
    static_assert(sizeof(MaskLeaf::NodeMaskType) == leaf_states);
    std::memcpy(to, &mask, leaf_states);
}

}  // namespace

SharedGrids::SharedGrids(const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs, std::uint64_t budget) {
    for (const auto& [name, any] : inputs) {
        auto grid = shareable(name, any->grid, budget);
        if (!grids_.empty()) require_same_transform(fmt::format("inputs '{}' and '{}'", grids_.front().first, name), *grids_.front().second, *grid);
        require_dense_fits(*grid, static_cast<double>(sizeof(float)), budget);
        as_its_type(*grid, [&](const auto& typed) {
            if (voxels_) voxels_->topologyUnion(typed.tree());
            else voxels_ = std::make_shared<openvdb::MaskTree>(typed.tree(), false, true, openvdb::TopologyCopy());
        });
        grids_.emplace_back(name, std::move(grid));
    }
    voxels_->voxelizeActiveTiles();
    for (auto leaf = voxels_->cbeginLeaf(); leaf; ++leaf) leaves_.push_back(leaf.getLeaf());
    bytes_ = leaves_.size() * (sizeof(std::array<std::int32_t, 3>) + leaf_states);
    for (const auto& [name, grid] : grids_) bytes_ += leaves_.size() * (value_bytes(*grid) + leaf_states);
    if (!grid_fits(static_cast<double>(bytes_), budget))
        throw Failure(
            fmt::format("the inputs take {} as arrays, but --memory allows {}: crop the grids, or raise --memory", size_text(bytes_), size_text(budget)),
            Failure::Kind::input);
    bytes_ += alignment * (2 + 2 * grids_.size());
}

Json SharedGrids::write(Worker& worker) const {
    auto* const data = worker.given.grown(bytes_);
    std::uint64_t at = 0;
    const auto origins = reserved(at, leaves_.size() * sizeof(std::array<std::int32_t, 3>)), states = reserved(at, leaves_.size() * leaf_states);
    for (std::size_t n = 0; n < leaves_.size(); ++n) {
        const auto& origin = leaves_[n]->origin();
        const std::array<std::int32_t, 3> place{origin.x(), origin.y(), origin.z()};
        std::memcpy(data + origins + n * sizeof place, &place, sizeof place);
        copy_states(leaves_[n]->valueMask(), data + states + n * leaf_states);
    }
    auto grids = Json::object();
    for (const auto& [name, grid] : grids_) grids[name] = write_grid(*grid, data, at);
    openvdb::CoordBBox box;
    if (!voxels_->evalActiveVoxelBoundingBox(box)) box = {Coord(0), Coord(-1)};
    return {{"bytes", worker.given.size()},
            {"leaves", leaves_.size()},
            {"voxels", voxels_->activeVoxelCount()},
            {"origins", origins},
            {"states", states},
            {"box", {json_of(box.min()), json_of(box.max())}},
            {"matrix", matrix_of(grids_.front().second->transform())},
            {"grids", std::move(grids)}};
}

Json SharedGrids::write_grid(const openvdb::GridBase& grid, std::byte* data, std::uint64_t& at) const {
    const auto values = reserved(at, leaves_.size() * value_bytes(grid)), states = reserved(at, leaves_.size() * leaf_states);
    Json out{{"name", grid.getName()}, {"values", values}, {"states", states}, {"class", openvdb::GridBase::gridClassToString(grid.getGridClass())}};
    as_its_type(grid, [&](const auto& typed) {
        using Grid = std::decay_t<decltype(typed)>;
        using Value = typename Grid::ValueType;
        constexpr bool has_values = !std::is_same_v<Value, bool>;
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves_.size()), [&](const auto& range) {
            const auto accessor = typed.getConstUnsafeAccessor();
            for (auto n = range.begin(); n != range.end(); ++n) {
                const auto& origin = leaves_[n]->origin();
                auto* const state = data + states + n * leaf_states;
                const auto* const leaf = accessor.probeConstLeaf(origin);
                if (leaf) copy_states(leaf->valueMask(), state);
                else std::memset(state, accessor.isValueOn(origin) ? 0xff : 0, leaf_states);
                if constexpr (has_values) {
                    auto* const to = reinterpret_cast<Value*>(data + values) + n * leaf_voxels;
                    if (leaf) std::copy_n(leaf->buffer().data(), leaf_voxels, to);
                    else std::fill_n(to, leaf_voxels, accessor.getValue(origin));
                }
            }
        });
        if constexpr (has_values) {
            out["kind"] = std::is_same_v<Value, float> ? "float" : "vector";
            out["background"] = json_of(typed.background());
            out["tiles"] = tiles_of(typed);
        } else {
            out["kind"] = "mask";
        }
    });
    return out;
}

FloatGrid::Ptr SharedGrids::numbers(Worker& worker) const {
    const auto* const data = reinterpret_cast<const float*>(worker.answered.seen(leaves_.size() * leaf_voxels * sizeof(float)));
    const auto out = FloatGrid::create(std::make_shared<openvdb::FloatTree>(*voxels_, 0.0f, openvdb::TopologyCopy()));
    // Leaves come in the order of the tree's topology.
    openvdb::tree::LeafManager<openvdb::FloatTree>(out->tree()).foreach ([&](openvdb::FloatTree::LeafNodeType& leaf, std::size_t n) {
        const auto* const values = data + n * leaf_voxels;
        if (leaf.isValueMaskOn()) {
            std::copy_n(values, leaf_voxels, leaf.buffer().data());
            return;
        }
        for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) voxel.setValue(values[voxel.pos()]);
    });
    out->setTransform(grids_.front().second->transform().copy());
    return out;
}

MaskGrid::Ptr SharedGrids::states(Worker& worker, std::uint64_t leaves) const {
    const auto origins = leaves * leaf_states;
    const auto* const data = worker.answered.seen(origins + leaves * sizeof(std::array<std::int32_t, 3>));
    const auto out = MaskGrid::create();
    for (std::uint64_t n = 0; n < leaves; ++n) {
        std::array<std::int32_t, 3> origin{};
        std::memcpy(&origin, data + origins + n * sizeof origin, sizeof origin);
        MaskLeaf::NodeMaskType mask;
        for (openvdb::Index word = 0; word < leaf_states / sizeof(std::uint64_t); ++word)
            std::memcpy(&mask.getWord<std::uint64_t>(word), data + n * leaf_states + word * sizeof(std::uint64_t), sizeof(std::uint64_t));
        out->tree().touchLeaf(Coord(origin[0], origin[1], origin[2]))->setValueMask(mask);
    }
    out->setTransform(grids_.front().second->transform().copy());
    return out;
}

}  // namespace fluidcarve
