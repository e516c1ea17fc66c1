#include "carve/volume/triplet.h"

#include "carve/base/failure.h"
#include "carve/volume/stored_form.h"

#include <fmt/format.h>

#include <cstddef>
#include <memory>
#include <utility>

namespace fluidcarve {
namespace {

using openvdb::Vec3d;

/// The transform of voxels, from that of their lower faces along an axis.
openvdb::math::Transform::Ptr off_faces(const openvdb::math::Transform& faces, int axis) {
    auto out = faces.copy();
    Vec3d half(0);
    half[axis] = 0.5;
    out->preTranslate(half);
    return out;
}

/// Whether transforms are equal up to rounding (0.001 voxels over 256 voxels): numbers may have
/// been stored as text or float.
bool nearly(const openvdb::math::Transform& a, const openvdb::math::Transform& b) {
    if (a == b) return true;
    if (!a.isLinear() || !b.isLinear()) return false;
    const double size = a.voxelSize().length();
    for (const auto& corner :
         {Vec3d(0, 0, 0), Vec3d(256, 0, 0), Vec3d(0, 256, 0), Vec3d(0, 0, 256)})
        if ((a.indexToWorld(corner) - b.indexToWorld(corner)).length() > 1e-3 * size) return false;
    return true;
}

std::optional<Triplet> fitting(const std::string& name,
                               const std::array<FloatGrid::ConstPtr, 3>& components) {
    const auto& first = components[0]->transform();
    if (nearly(first, components[1]->transform()) && nearly(first, components[2]->transform()))
        return Triplet{name, components, false, first.copy()};
    const auto cells = off_faces(first, 0);
    for (const int axis : {1, 2})
        if (!nearly(*cells,
                    *off_faces(components[static_cast<std::size_t>(axis)]->transform(), axis)))
            return std::nullopt;
    return Triplet{name, components, true, cells};
}

/// Reads the three components at a voxel.
struct Look {
    FloatGrid::ConstAccessor x, y, z;
    explicit Look(const Triplet& triplet)
        : x(triplet.components[0]->getConstAccessor()),
          y(triplet.components[1]->getConstAccessor()),
          z(triplet.components[2]->getConstAccessor()) {}
    openvdb::Vec3s operator()(const openvdb::Coord& at) const {
        return {x.getValue(at), y.getValue(at), z.getValue(at)};
    }
};

}  // namespace

std::array<std::string, 3> triplet_names(const std::string& name) {
    return {name + ".x", name + ".y", name + ".z"};
}

Triplet make_triplet(const std::string& name,
                     const std::array<FloatGrid::ConstPtr, 3>& components) {
    auto out = fitting(name, components);
    if (!out)
        throw Failure(fmt::format("grids '{0}.x', '{0}.y' and '{0}.z' are no vector: their "
                                  "transforms are neither the same nor half a voxel apart, each "
                                  "along its axis; read them as three float grids",
                                  name),
                      Failure::Kind::input);
    return *out;
}

std::optional<Triplet> triplet_of(const Volume& volume, const openvdb::GridBase& grid) {
    const auto own = grid.getName();
    if (own.size() < 3 || own[own.size() - 2] != '.') return std::nullopt;
    const auto name = own.substr(0, own.size() - 2);
    std::array<FloatGrid::ConstPtr, 3> components;
    const auto names = triplet_names(name);
    for (std::size_t c = 0; c < 3; ++c) {
        const auto found = volume.find(names[c]);
        if (!found || !found->isType<FloatGrid>()) return std::nullopt;
        components[c] = openvdb::GridBase::grid<FloatGrid>(found);
    }
    return fitting(name, components);
}

VectorGrid::ConstPtr merged(const Triplet& triplet) {
    using Tree = openvdb::Vec3STree;
    const auto& [x, y, z] = triplet.components;
    const auto tree = std::make_shared<Tree>(
        x->tree(), openvdb::Vec3s(x->background(), y->background(), z->background()),
        openvdb::TopologyCopy());
    tree->topologyUnion(y->tree());
    tree->topologyUnion(z->tree());
    openvdb::tree::LeafManager<Tree>(*tree).foreach ([&](Tree::LeafNodeType& leaf, std::size_t) {
        const Look look(triplet);
        for (openvdb::Index n = 0; n < Tree::LeafNodeType::SIZE; ++n)
            leaf.setValueOnly(n, look(leaf.offsetToGlobalCoord(n)));
    });
    // Only active tiles need values: inactive ones have the background.
    const Look look(triplet);
    auto tile = tree->beginValueOn();
    tile.setMaxDepth(Tree::ValueOnIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) tile.setValue(look(tile.getCoord()));

    const auto out = VectorGrid::create(tree);
    out->setTransform(triplet.cells->copy());
    out->setName(triplet.name);
    if (triplet.staggered) out->setGridClass(openvdb::GRID_STAGGERED);
    out->setSaveFloatAsHalf(x->saveFloatAsHalf());
    StoredForm stored;
    stored.components.assign(triplet.components.begin(), triplet.components.end());
    stored.merged = out->constBaseTreePtr();
    set_stored_form(*out, std::move(stored));
    return out;
}

std::vector<openvdb::GridBase::ConstPtr> split(const openvdb::GridBase::ConstPtr& grid) {
    const auto stored = stored_form_of(*grid);
    if (!stored || stored->components.empty() || !grid->isType<VectorGrid>()) return {grid};
    const auto& vectors = openvdb::GridBase::grid<VectorGrid>(grid)->tree();
    const bool untouched = stored->merged.lock() == grid->constBaseTreePtr();

    std::vector<openvdb::GridBase::ConstPtr> out;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto& from = stored->components[axis];
        if (untouched) {
            out.push_back(placed(from, stored->placement));
            continue;
        }
        using Tree = openvdb::FloatTree;
        const auto c = static_cast<int>(axis);
        const auto tree =
            std::make_shared<Tree>(vectors, vectors.background()[c], openvdb::TopologyCopy());
        openvdb::tree::LeafManager<Tree>(*tree).foreach (
            [&](Tree::LeafNodeType& leaf, std::size_t) {
                const auto* const values = vectors.probeConstLeaf(leaf.origin());
                const auto x = stored->components[0]->getConstAccessor(),
                           y = stored->components[1]->getConstAccessor(),
                           z = stored->components[2]->getConstAccessor();
                const auto own = from->getConstAccessor();
                for (openvdb::Index n = 0; n < Tree::LeafNodeType::SIZE; ++n) {
                    const float value = values->getValue(n)[c];
                    leaf.setValueOnly(n, value);
                    const auto at = leaf.offsetToGlobalCoord(n);
                    const bool was_on = x.isValueOn(at) || y.isValueOn(at) || z.isValueOn(at);
                    // An unchanged voxel keeps the component's own state: it may be active in fewer
                    // voxels than the others.
                    if (values->isValueOn(n) == was_on && value == own.getValue(at))
                        leaf.setActiveState(n, own.isValueOn(at));
                }
            });
        auto tile = tree->beginValueOn();
        tile.setMaxDepth(Tree::ValueOnIter::LEAF_DEPTH - 1);
        for (; tile; ++tile) tile.setValue(vectors.getValue(tile.getCoord())[c]);
        const auto part = FloatGrid::create(tree);
        part->insertMeta(*from);
        part->setTransform(from->transform().copy());
        out.push_back(placed(part, stored->placement));
    }
    return out;
}

}  // namespace fluidcarve
