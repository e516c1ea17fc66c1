#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <memory>
#include <string>

namespace fluidcarve {

/// A grid of a type that OpenVDB does not know. It keeps the bytes of its tree, so that a writer
/// can write them back. Name, metadata and transform are read as usual. It has no accessible voxels
/// and can't be carved.
class RawGrid : public openvdb::GridBase {
public:
    /// The tree's bytes in the file. Instances share them.
    struct Bytes : openvdb::BoolTree {
        std::string topology, buffers;
        std::uint32_t compression = 0;  ///< OpenVDB's compression flags of the bytes; a file with
                                        ///< these bytes must use the same
    };

    /// @param type       OpenVDB's type name
    /// @param blocks_at  offset of the buffers in the file, bytes
    /// @param ends_at    offset of the end of the buffers, bytes
    RawGrid(openvdb::Name type, std::int64_t blocks_at, std::int64_t ends_at);

    /// The grid as a RawGrid; null if it is another grid.
    static const RawGrid* of(const openvdb::GridBase& grid) {
        return dynamic_cast<const RawGrid*>(&grid);
    }
    std::uint32_t compression() const { return bytes_->compression; }
    /// Bytes.
    std::uint64_t size() const { return bytes_->topology.size() + bytes_->buffers.size(); }

    openvdb::Name type() const override { return type_; }
    openvdb::Name valueType() const override { return "unknown"; }

    openvdb::GridBase::Ptr copyGrid() override { return std::make_shared<RawGrid>(*this); }
    openvdb::GridBase::ConstPtr copyGrid() const override {
        return std::make_shared<RawGrid>(*this);
    }
    openvdb::GridBase::Ptr copyGridWithNewTree() const override;
    openvdb::GridBase::ConstPtr copyGridReplacingMetadata(
        const openvdb::MetaMap& metadata) const override;
    openvdb::GridBase::ConstPtr copyGridReplacingTransform(
        openvdb::math::Transform::Ptr transform) const override;
    openvdb::GridBase::ConstPtr copyGridReplacingMetadataAndTransform(
        const openvdb::MetaMap& metadata, openvdb::math::Transform::Ptr transform) const override;
    openvdb::GridBase::Ptr deepCopyGrid() const override;

    openvdb::TreeBase::ConstPtr constBaseTreePtr() const override { return bytes_; }
    bool isTreeUnique() const override { return bytes_.use_count() == 1; }
    /// @param tree  must be that of another RawGrid
    void setTree(openvdb::TreeBase::Ptr tree) override {
        bytes_ = std::static_pointer_cast<Bytes>(tree);
    }
    void newTree() override { bytes_ = std::make_shared<Bytes>(); }
    bool empty() const override { return size() == 0; }
    void clear() override { newTree(); }
    void pruneGrid(float) override {}
    void clip(const openvdb::CoordBBox&) override {}

    openvdb::Index64 activeVoxelCount() const override { return 0; }
    openvdb::CoordBBox evalActiveVoxelBoundingBox() const override { return {}; }
    openvdb::Coord evalActiveVoxelDim() const override { return {}; }
    openvdb::Index64 memUsage() const override { return size(); }

    void readTopology(std::istream& in) override;
    void writeTopology(std::ostream& out) const override;
    void readBuffers(std::istream& in) override;
    void readBuffers(std::istream& in, const openvdb::CoordBBox&) override { readBuffers(in); }
    void readNonresidentBuffers() const override {}
    void writeBuffers(std::ostream& out) const override;
    void print(std::ostream& out, int) const override { out << type_; }

private:
    openvdb::Name type_;
    std::int64_t blocks_at_, ends_at_;
    std::shared_ptr<Bytes> bytes_ = std::make_shared<Bytes>();
};

}  // namespace fluidcarve
