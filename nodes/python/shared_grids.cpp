#include "nodes/python/shared_grids.h"

#include "carve/base/each_in_parallel.h"
#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/field/collocate.h"
#include "carve/field/dense.h"
#include "carve/field/same_transform.h"

#include <fmt/format.h>
#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <type_traits>

namespace fluidcarve {
namespace {

using Json = nlohmann::json;
using openvdb::Coord;
using MaskLeaf = openvdb::MaskTree::LeafNodeType;

constexpr std::uint64_t leaf_voxels = MaskLeaf::SIZE, leaf_states = leaf_voxels / 8;
constexpr std::uint64_t alignment = 64;
constexpr int block_edge = 64;  ///< voxels along a part with a halo

/// Reserves `bytes` bytes behind the earlier ones.
std::uint64_t reserved(std::uint64_t& at, std::uint64_t bytes) {
    const auto out = at;
    at += (bytes + alignment - 1) / alignment * alignment;
    return out;
}

openvdb::GridBase::ConstPtr shareable(const std::string& name,
                                      const openvdb::GridBase::ConstPtr& grid,
                                      std::uint64_t budget) {
    if (const auto vectors = openvdb::gridConstPtrCast<VectorGrid>(grid)) {
        require_collocation_fits(*vectors, budget);
        return collocated(vectors);
    }
    if (!grid->isType<FloatGrid>() && !grid->isType<MaskGrid>())
        throw Failure(
            fmt::format("input '{}' is the grid '{}' of type {}; scripts take numbers (float), "
                        "vectors (vec3s) and masks",
                        name, grid->getName(), grid->valueType()));
    return grid;
}

/// Calls `with` with a grid in its own type.
template <class With>
auto as_its_type(const openvdb::GridBase& grid, const With& with) {
    if (grid.isType<FloatGrid>()) return with(static_cast<const FloatGrid&>(grid));
    if (grid.isType<VectorGrid>()) return with(static_cast<const VectorGrid&>(grid));
    return with(static_cast<const MaskGrid&>(grid));
}

Coord block_of(const Coord& at) { return at & ~(block_edge - 1); }

/// Calls `visit` with the origin of each block that a box overlaps.
void each_block(const openvdb::CoordBBox& box, const auto& visit) {
    const auto low = block_of(box.min()), high = block_of(box.max());
    for (int x = low.x(); x <= high.x(); x += block_edge)
        for (int y = low.y(); y <= high.y(); y += block_edge)
            for (int z = low.z(); z <= high.z(); z += block_edge) visit(Coord(x, y, z));
}

/// Bytes of the values in a leaf; a mask has only states.
std::uint64_t value_bytes(const openvdb::GridBase& grid) {
    return grid.isType<FloatGrid>()    ? leaf_voxels * sizeof(float)
           : grid.isType<VectorGrid>() ? leaf_voxels * sizeof(openvdb::Vec3s)
                                       : 0;
}

Json json_of(const Coord& at) { return {at.x(), at.y(), at.z()}; }
Json json_of(float value) { return value; }
Json json_of(const openvdb::Vec3s& value) { return {value[0], value[1], value[2]}; }

/// Tiles that are inactive and not background, such as the inside of a level set: [x, y, z, edge,
/// value] each.
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

/// World = matrix * (index, 1), rows of 4; null if the transform is not linear.
Json matrix_of(const openvdb::math::Transform& transform) {
    if (!transform.isLinear()) return nullptr;
    const auto matrix = transform.baseMap()->getAffineMap()->getMat4();
    auto out = Json::array();
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) out.push_back(matrix(column, row));
    return out;
}

using StateWord = std::uint64_t;
constexpr openvdb::Index leaf_words = leaf_states / sizeof(StateWord);

void copy_states(const MaskLeaf::NodeMaskType& mask, std::byte* to) {
    for (openvdb::Index n = 0; n < leaf_words; ++n) {
        const auto word = mask.getWord<StateWord>(n);
        std::memcpy(to + n * sizeof word, &word, sizeof word);
    }
}

MaskLeaf::NodeMaskType states_at(const std::byte* from) {
    MaskLeaf::NodeMaskType out;
    for (openvdb::Index n = 0; n < leaf_words; ++n)
        std::memcpy(&out.getWord<StateWord>(n), from + n * sizeof(StateWord), sizeof(StateWord));
    return out;
}

}  // namespace

SharedGrids::SharedGrids(const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs,
                         std::uint64_t budget)
    : budget_(budget) {
    for (const auto& [name, any] : inputs) {
        auto grid = shareable(name, any->grid, budget);
        if (!grids_.empty())
            require_same_transform(fmt::format("inputs '{}' and '{}'", grids_.front().first, name),
                                   *grids_.front().second, *grid);
        require_dense_fits(*grid, static_cast<double>(sizeof(float)), budget);
        as_its_type(*grid, [&](const auto& typed) {
            if (voxels_) voxels_->topologyUnion(typed.tree());
            else
                voxels_ = std::make_shared<openvdb::MaskTree>(typed.tree(), false, true,
                                                              openvdb::TopologyCopy());
        });
        grids_.emplace_back(name, std::move(grid));
    }
    voxels_->voxelizeActiveTiles();
    for (auto leaf = voxels_->cbeginLeaf(); leaf; ++leaf) leaves_.push_back(leaf.getLeaf());
    if (!voxels_->evalActiveVoxelBoundingBox(box_)) box_ = {Coord(0), Coord(-1)};
}

bool SharedGrids::Part::wants(const Coord& origin) const {
    return !block || block_of(origin) == *block;
}

std::vector<SharedGrids::Part> SharedGrids::parts(std::optional<int> halo) const {
    if (!halo) {
        std::vector<std::size_t> all(leaves_.size());
        std::iota(all.begin(), all.end(), std::size_t{0});
        return {{std::move(all), box_, std::nullopt}};
    }
    std::map<Coord, openvdb::CoordBBox> blocks;
    for (const auto* const leaf : leaves_)
        if (!leaf->isValueMaskOff())
            blocks[block_of(leaf->origin())].expand(leaf->getNodeBoundingBox());
    // Which leaves are near a block: those of the blocks around it, as far as the halo reaches.
    std::map<Coord, std::vector<std::size_t>> leaves;
    for (std::size_t n = 0; n < leaves_.size(); ++n)
        leaves[block_of(leaves_[n]->origin())].push_back(n);
    std::vector<Part> out;
    for (const auto& [origin, core] : blocks) {
        auto box = core;
        box.expand(*halo);
        box.intersect(box_);
        Part part{{}, box, origin};
        each_block(box, [&](const Coord& block) {
            const auto found = leaves.find(block);
            if (found == leaves.end()) return;
            for (const auto n : found->second)
                if (leaves_[n]->getNodeBoundingBox().hasOverlap(box)) part.leaves.push_back(n);
        });
        std::ranges::sort(part.leaves);
        out.push_back(std::move(part));
    }
    return out;
}

std::uint64_t SharedGrids::bytes(std::size_t leaves) const {
    auto out = leaves * (sizeof(std::array<std::int32_t, 3>) + leaf_states) +
               alignment * (2 + 2 * grids_.size());
    for (const auto& [name, grid] : grids_) out += leaves * (value_bytes(*grid) + leaf_states);
    return out;
}

Json SharedGrids::write(Worker& worker, const Part& part) const {
    const auto count = part.leaves.size();
    if (!grid_fits(static_cast<double>(bytes(count)), budget_))
        throw Failure(fmt::format("the inputs take {} as arrays, but --memory allows {}: state a "
                                  "`halo`, crop the grids, or raise --memory",
                                  size_text(bytes(count)), size_text(budget_)),
                      Failure::Kind::input);
    auto* const data = worker.given.grown(bytes(count));
    std::uint64_t at = 0, voxels = 0;
    const auto origins = reserved(at, count * sizeof(std::array<std::int32_t, 3>)),
               states = reserved(at, count * leaf_states);
    for (std::size_t n = 0; n < count; ++n) {
        const auto& leaf = *leaves_[part.leaves[n]];
        const std::array<std::int32_t, 3> place{leaf.origin().x(), leaf.origin().y(),
                                                leaf.origin().z()};
        std::memcpy(data + origins + n * sizeof place, &place, sizeof place);
        copy_states(leaf.valueMask(), data + states + n * leaf_states);
        voxels += leaf.onVoxelCount();
    }
    auto grids = Json::object();
    for (const auto& [name, grid] : grids_) grids[name] = write_grid(*grid, part, data, at);
    return {{"bytes", worker.given.size()},
            {"leaves", count},
            {"voxels", voxels},
            {"origins", origins},
            {"states", states},
            {"box", {json_of(part.box.min()), json_of(part.box.max())}},
            {"matrix", matrix_of(transform())},
            {"grids", std::move(grids)}};
}

Json SharedGrids::write_grid(const openvdb::GridBase& grid, const Part& part, std::byte* data,
                             std::uint64_t& at) const {
    const auto count = part.leaves.size();
    const auto values = reserved(at, count * value_bytes(grid)),
               states = reserved(at, count * leaf_states);
    Json out{{"name", grid.getName()},
             {"values", values},
             {"states", states},
             {"class", openvdb::GridBase::gridClassToString(grid.getGridClass())}};
    as_its_type(grid, [&](const auto& typed) {
        using Grid = std::decay_t<decltype(typed)>;
        using Value = typename Grid::ValueType;
        constexpr bool has_values = !std::is_same_v<Value, bool>;
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count), [&](const auto& range) {
            const auto accessor = typed.getConstUnsafeAccessor();
            for (auto n = range.begin(); n != range.end(); ++n) {
                const auto& origin = leaves_[part.leaves[n]]->origin();
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

SharedGrids::Numbers::Numbers(const SharedGrids& grids, float least)
    : grid(FloatGrid::create()), grids_(grids), least_(least) {
    grid->setTransform(grids.transform().copy());
}

void SharedGrids::Numbers::take(Worker& worker, const Part& part) {
    using FloatLeaf = openvdb::FloatTree::LeafNodeType;
    constexpr auto most = std::numeric_limits<float>::max();
    const auto from = std::max(least_, -most);
    const auto count = part.leaves.size();
    const auto* const data =
        reinterpret_cast<const float*>(worker.answered.seen(count * leaf_voxels * sizeof(float)));
    // Leaves are filled before they join the tree: a copy of the topology would fill them with its
    // background first.
    std::vector<std::unique_ptr<FloatLeaf>> made(count);
    each_in_parallel(count, 1, [&](std::size_t n) {
        const auto& like = *grids_.leaves_[part.leaves[n]];
        if (!part.wants(like.origin())) return;
        const auto& mask = like.valueMask();
        made[n] = std::make_unique<FloatLeaf>(openvdb::PartialCreate(), like.origin(), 0.0f, false);
        made[n]->allocate();
        made[n]->setValueMask(mask);
        auto* const to = made[n]->buffer().data();
        std::copy_n(data + n * leaf_voxels, leaf_voxels, to);
        for (auto off = mask.beginOff(); off; ++off) to[off.pos()] = 0;
        bool wrong = false;
        if (mask.isOn()) {
            for (std::size_t voxel = 0; voxel < leaf_voxels; ++voxel)
                wrong |= !(to[voxel] >= from && to[voxel] <= most);
        } else {
            for (auto on = mask.beginOn(); on; ++on)
                wrong |= !(to[on.pos()] >= from && to[on.pos()] <= most);
        }
        if (wrong) good = false;
    });
    for (auto& leaf : made)
        if (leaf) grid->tree().addLeaf(leaf.release());
}

void SharedGrids::add_states(MaskGrid& mask, Worker& worker, std::uint64_t leaves,
                             const Part& part) const {
    const auto origins = leaves * leaf_states;
    const auto* const data =
        worker.answered.seen(origins + leaves * sizeof(std::array<std::int32_t, 3>));
    for (std::uint64_t n = 0; n < leaves; ++n) {
        std::array<std::int32_t, 3> place{};
        std::memcpy(&place, data + origins + n * sizeof place, sizeof place);
        const Coord origin(place[0], place[1], place[2]);
        if (!part.wants(origin)) continue;
        mask.tree().touchLeaf(origin)->setValueMask(states_at(data + n * leaf_states));
    }
}

}  // namespace fluidcarve
