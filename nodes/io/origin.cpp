#include "nodes/io/origin.h"

namespace fluidcarve {
namespace {

constexpr auto key = "fluidcarve_origin";

/// Metadata that holds an Origin. It exists only in memory: it writes and reads nothing.
class OriginMetadata : public openvdb::Metadata {
public:
    explicit OriginMetadata(std::shared_ptr<const Origin> origin) : origin(std::move(origin)) {}
    openvdb::Name typeName() const override { return key; }
    openvdb::Metadata::Ptr copy() const override { return std::make_shared<OriginMetadata>(origin); }
    void copy(const openvdb::Metadata& other) override { origin = dynamic_cast<const OriginMetadata&>(other).origin; }
    std::string str() const override { return key; }
    bool asBool() const override { return true; }
    openvdb::Index32 size() const override { return 0; }

    std::shared_ptr<const Origin> origin;

protected:
    void readValue(std::istream&, openvdb::Index32) override {}
    void writeValue(std::ostream&) const override {}
};

openvdb::math::Transform::Ptr inverse(const openvdb::math::Transform& in_world, const Placement& placement) {
    auto out = in_world.copy();
    out->postTranslate(-placement.translate);
    out->postScale(1 / placement.scale);
    if (!placement.offset.isZero()) out->preTranslate(-placement.offset);
    return out;
}

}  // namespace

openvdb::math::Transform::Ptr placed(const openvdb::math::Transform& in_file, const Placement& placement) {
    auto out = in_file.copy();
    if (!placement.offset.isZero()) out->preTranslate(placement.offset);
    out->postScale(placement.scale);
    out->postTranslate(placement.translate);
    return out;
}

void set_origin(openvdb::GridBase& grid, Origin origin) {
    grid.removeMeta(key);
    grid.insertMeta(key, OriginMetadata(std::make_shared<const Origin>(std::move(origin))));
}

std::shared_ptr<const Origin> origin_of(const openvdb::GridBase& grid) {
    const auto found = std::dynamic_pointer_cast<const OriginMetadata>(grid[key]);
    return found ? found->origin : nullptr;
}

openvdb::GridBase::ConstPtr placed(const openvdb::GridBase::ConstPtr& grid, const Placement& placement) {
    if (placement == Placement{}) return grid;
    const auto known = origin_of(*grid);
    Origin origin = known ? *known : Origin{};
    origin.placement = placement;
    origin.in_file = grid->transformPtr();
    openvdb::MetaMap metadata(*grid);
    metadata.removeMeta(key);
    metadata.insertMeta(key, OriginMetadata(std::make_shared<const Origin>(std::move(origin))));
    return grid->copyGridReplacingMetadataAndTransform(metadata, placed(grid->transform(), placement));
}

openvdb::GridBase::ConstPtr unplaced(const openvdb::GridBase::ConstPtr& grid, const Placement* placement) {
    const auto origin = origin_of(*grid);
    if (!origin && !placement) return grid;
    auto by = placement ? *placement : origin->placement;
    if (origin) by.offset = origin->placement.offset;
    // An inverted transform differs from the file's in the last bits: use the stored one if possible.
    const bool as_it_came = origin && by == origin->placement && (!origin->in_file || *placed(*origin->in_file, by) == grid->transform());
    // Share the transform: a copy of a map computes its inverse again.
    const auto kept = origin && origin->in_file ? origin->in_file : grid->transformPtr();
    const auto transform = as_it_came ? std::const_pointer_cast<openvdb::math::Transform>(kept) : inverse(grid->transform(), by);
    openvdb::MetaMap metadata(*grid);
    metadata.removeMeta(key);
    if (origin && origin->made_staggered) {
        metadata.removeMeta(openvdb::GridBase::META_GRID_CLASS);
        if (origin->class_in_file)
            metadata.insertMeta(openvdb::GridBase::META_GRID_CLASS, openvdb::StringMetadata(openvdb::GridBase::gridClassToString(openvdb::GRID_UNKNOWN)));
    }
    return grid->copyGridReplacingMetadataAndTransform(metadata, transform);
}

}  // namespace fluidcarve
