#include "carve/volume/stored_form.h"

#include "carve/base/failure.h"
#include "carve/volume/cubes.h"

#include <fmt/format.h>

#include <string>
#include <utility>

namespace fluidcarve {
namespace {

constexpr auto key = "fluidcarve_stored_form";

/// Metadata that holds a StoredForm. It exists only in memory: it writes and reads nothing.
class StoredFormMetadata : public openvdb::Metadata {
public:
    explicit StoredFormMetadata(std::shared_ptr<const StoredForm> stored)
        : stored(std::move(stored)) {}
    openvdb::Name typeName() const override { return key; }
    openvdb::Metadata::Ptr copy() const override {
        return std::make_shared<StoredFormMetadata>(stored);
    }
    void copy(const openvdb::Metadata& other) override {
        stored = dynamic_cast<const StoredFormMetadata&>(other).stored;
    }
    std::string str() const override { return key; }
    bool asBool() const override { return true; }
    openvdb::Index32 size() const override { return 0; }

    std::shared_ptr<const StoredForm> stored;

protected:
    void readValue(std::istream&, openvdb::Index32) override {}
    void writeValue(std::ostream&) const override {}
};

/// @throws Failure if OpenVDB takes no voxels of the new size
void scale(openvdb::math::Transform& transform, double factor) {
    try {
        transform.postScale(factor);
    } catch (const openvdb::ArithmeticError&) {
        throw Failure(
            fmt::format("with a scale of {:g}, voxels of {:g} world units get smaller than {:g}, "
                        "the least; choose another 'scale'",
                        factor, transform.voxelSize()[0], least_voxel));
    }
}

openvdb::math::Transform::Ptr inverse(const openvdb::math::Transform& in_world,
                                      const Placement& placement) {
    auto out = in_world.copy();
    out->postTranslate(-placement.translate);
    scale(*out, 1 / placement.scale);
    if (!placement.offset.isZero()) out->preTranslate(-placement.offset);
    return out;
}

}  // namespace

openvdb::math::Transform::Ptr placed(const openvdb::math::Transform& in_file,
                                     const Placement& placement) {
    auto out = in_file.copy();
    if (!placement.offset.isZero()) out->preTranslate(placement.offset);
    scale(*out, placement.scale);
    out->postTranslate(placement.translate);
    return out;
}

void set_stored_form(openvdb::GridBase& grid, StoredForm stored) {
    grid.removeMeta(key);
    grid.insertMeta(key, StoredFormMetadata(std::make_shared<const StoredForm>(std::move(stored))));
}

std::shared_ptr<const StoredForm> stored_form_of(const openvdb::GridBase& grid) {
    const auto found = std::dynamic_pointer_cast<const StoredFormMetadata>(grid[key]);
    return found ? found->stored : nullptr;
}

openvdb::GridBase::ConstPtr placed(const openvdb::GridBase::ConstPtr& grid,
                                   const Placement& placement) {
    if (placement == Placement{}) return grid;
    const auto known = stored_form_of(*grid);
    StoredForm stored = known ? *known : StoredForm{};
    stored.placement = placement;
    stored.in_file = grid->transformPtr();
    openvdb::MetaMap metadata(*grid);
    metadata.removeMeta(key);
    metadata.insertMeta(key,
                        StoredFormMetadata(std::make_shared<const StoredForm>(std::move(stored))));
    return grid->copyGridReplacingMetadataAndTransform(metadata,
                                                       placed(grid->transform(), placement));
}

openvdb::GridBase::ConstPtr unplaced(const openvdb::GridBase::ConstPtr& grid,
                                     const Placement* placement) {
    const auto stored = stored_form_of(*grid);
    if (!stored && !placement) return grid;
    auto by = placement ? *placement : stored->placement;
    if (stored) by.offset = stored->placement.offset;
    // An inverted transform differs from the file's in the last bits: use the stored one if
    // possible.
    const bool as_it_came =
        stored && by == stored->placement &&
        (stored->in_file ? *placed(*stored->in_file, by) == grid->transform() : by == Placement{});
    // Share the transform: a copy of a map computes its inverse again.
    const auto kept = stored && stored->in_file ? stored->in_file : grid->transformPtr();
    const auto transform = as_it_came ? std::const_pointer_cast<openvdb::math::Transform>(kept)
                                      : inverse(grid->transform(), by);
    openvdb::MetaMap metadata(*grid);
    metadata.removeMeta(key);
    if (stored && stored->made_staggered) {
        metadata.removeMeta(openvdb::GridBase::META_GRID_CLASS);
        if (stored->class_in_file)
            metadata.insertMeta(openvdb::GridBase::META_GRID_CLASS,
                                openvdb::StringMetadata(
                                    openvdb::GridBase::gridClassToString(openvdb::GRID_UNKNOWN)));
    }
    return grid->copyGridReplacingMetadataAndTransform(metadata, transform);
}

}  // namespace fluidcarve
