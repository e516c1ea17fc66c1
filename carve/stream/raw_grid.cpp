#include "carve/stream/raw_grid.h"

#include <openvdb/io/io.h>

#include <cstddef>
#include <utility>

namespace fluidcarve {
namespace {

std::string bytes_until(std::istream& in, std::int64_t end) {
    const auto begin = static_cast<std::int64_t>(in.tellg());
    if (end < begin) OPENVDB_THROW(openvdb::IoError, "its parts overlap");
    std::string out(static_cast<std::size_t>(end - begin), '\0');
    in.read(out.data(), end - begin);
    return out;
}

}  // namespace

RawGrid::RawGrid(openvdb::Name type, std::int64_t blocks_at, std::int64_t ends_at)
    : type_(std::move(type)), blocks_at_(blocks_at), ends_at_(ends_at) {}

openvdb::GridBase::Ptr RawGrid::copyGridWithNewTree() const {
    const auto out = std::make_shared<RawGrid>(*this);
    out->newTree();
    return out;
}

openvdb::GridBase::ConstPtr RawGrid::copyGridReplacingMetadata(
    const openvdb::MetaMap& metadata) const {
    return copyGridReplacingMetadataAndTransform(metadata, constTransform().copy());
}

openvdb::GridBase::ConstPtr RawGrid::copyGridReplacingTransform(
    openvdb::math::Transform::Ptr transform) const {
    return copyGridReplacingMetadataAndTransform(*this, transform);
}

openvdb::GridBase::ConstPtr RawGrid::copyGridReplacingMetadataAndTransform(
    const openvdb::MetaMap& metadata, openvdb::math::Transform::Ptr transform) const {
    const auto out = std::make_shared<RawGrid>(*this);
    out->clearMetadata();
    out->insertMeta(metadata);
    out->setTransform(std::move(transform));
    return out;
}

openvdb::GridBase::Ptr RawGrid::deepCopyGrid() const {
    const auto out = std::make_shared<RawGrid>(*this);
    out->bytes_ = std::make_shared<Bytes>(*bytes_);
    return out;
}

void RawGrid::readTopology(std::istream& in) {
    bytes_->compression = openvdb::io::getDataCompression(in);
    bytes_->topology = bytes_until(in, blocks_at_);
}

void RawGrid::writeTopology(std::ostream& out) const {
    out.write(bytes_->topology.data(), static_cast<std::streamsize>(bytes_->topology.size()));
}

void RawGrid::readBuffers(std::istream& in) { bytes_->buffers = bytes_until(in, ends_at_); }

void RawGrid::writeBuffers(std::ostream& out) const {
    out.write(bytes_->buffers.data(), static_cast<std::streamsize>(bytes_->buffers.size()));
}

}  // namespace fluidcarve
