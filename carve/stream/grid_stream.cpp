#include "carve/stream/grid_stream.h"

#include "carve/base/failure.h"
#include "carve/stream/openvdb_types.h"
#include "carve/stream/point_check.h"
#include "carve/stream/raw_grid.h"
#include "carve/stream/transform_bytes.h"
#include "carve/stream/tree_check.h"

#include <fmt/format.h>
#include <openvdb/io/Compression.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/io/io.h>

#include <cstddef>
#include <cstring>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>

namespace fluidcarve {
namespace {

// No compression: it takes longer than writing, and OpenVDB's decompression trusts the bytes.
// COMPRESS_ACTIVE_MASK is not exact either: it compares inactive values, and -0 equals 0.
constexpr std::uint32_t codec = openvdb::io::COMPRESS_NONE;

/// Maximum nesting of components in stored forms: a stream with more is damaged.
constexpr int deepest = 8;

/// Attaches OpenVDB's stream metadata to a stream during its lifetime.
class Tags {
public:
    explicit Tags(std::ios_base& stream) : stream_(stream) {
        openvdb::io::setStreamMetadataPtr(stream, tags_, false);
    }
    ~Tags() { openvdb::io::clearStreamMetadataPtr(stream_); }
    Tags(const Tags&) = delete;
    Tags& operator=(const Tags&) = delete;

private:
    std::ios_base& stream_;
    std::shared_ptr<openvdb::io::StreamMetadata> tags_ =
        std::make_shared<openvdb::io::StreamMetadata>();
};

/// Turns exceptions of OpenVDB into Failure.
template <class Read>
auto sound(Read read) {
    try {
        return read();
    } catch (const Failure&) {
        throw;
    } catch (const std::exception& error) {
        throw Failure(fmt::format("kept data is damaged or cut off: {}", error.what()));
    }
}

/// Checks a tree of points before OpenVDB reads it. Of other trees OpenVDB trusts no length where
/// values are not compressed.
/// @param in  at the tree, where it stays
void require_sound_points(std::istream& in, const std::string& type) {
    const auto format = tree_format(type, false, openvdb::OPENVDB_FILE_VERSION, codec);
    if (format.leaves != TreeFormat::Leaves::point_data) return;
    const auto begin = in.tellg();
    in.seekg(0, std::ios_base::end);
    std::string bytes(static_cast<std::size_t>(in.tellg() - begin), '\0');
    in.seekg(begin);
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    in.seekg(begin);
    check_tree(format, bytes);
}

/// Whether metadata can be written: it can be restored from its type name and bytes.
bool has_bytes(const openvdb::Metadata& metadata) {
    const auto type = metadata.typeName();
    if (type == openvdb::io::DelayedLoadMetadata::staticTypeName())
        return false;  // sizes of leaves in a file
    return openvdb::Metadata::isRegisteredType(type) ||
           dynamic_cast<const openvdb::UnknownMetadata*>(&metadata);
}

/// Metadata from its type and what its `write` wrote.
openvdb::Metadata::Ptr written_metadata(const std::string& type, std::string_view bytes) {
    BinaryReader::require(type != openvdb::io::DelayedLoadMetadata::staticTypeName());
    std::uint32_t size = 0;
    BinaryReader::require(bytes.size() >= sizeof size);
    std::memcpy(&size, bytes.data(), sizeof size);
    BinaryReader::require(size == bytes.size() - sizeof size);
    const auto out = metadata_of(type, bytes.substr(sizeof size));
    BinaryReader::require(out != nullptr);
    return out;
}

}  // namespace

GridWriter::GridWriter(std::ostream& to) : to_(to), out_(to.rdbuf()), binary_(out_) {}

void GridWriter::write(const openvdb::GridBase& grid) {
    binary_.value(RawGrid::of(grid) != nullptr);
    binary_.text(grid.type());
    write_tree(grid);
    write_metadata(grid, binary_);
    write_transform(grid.transform(), binary_);
    const auto stored = stored_form_of(grid);
    binary_.value(stored != nullptr);
    if (stored) write(*stored, grid.constBaseTree());
    if (!out_) to_.setstate(std::ios_base::badbit);
}

void GridWriter::write(const StoredForm& stored, const openvdb::TreeBase& tree) {
    binary_.value(stored.placement);
    binary_.value(stored.in_file != nullptr);
    if (stored.in_file) write_transform(*stored.in_file, binary_);
    binary_.value(std::uint64_t{stored.components.size()});
    for (const auto& component : stored.components) write(*component);
    binary_.value(stored.merged.lock().get() == &tree);
    binary_.value(stored.made_staggered);
    binary_.value(stored.class_in_file);
}

void GridWriter::write_tree(const openvdb::GridBase& grid) {
    const auto [number, is_new] = trees_.try_emplace(&grid.constBaseTree(), trees_.size());
    binary_.value(number->second);
    if (!is_new) return;
    if (RawGrid::of(grid)) {
        const auto& bytes = dynamic_cast<const RawGrid::Bytes&>(grid.constBaseTree());
        binary_.value(bytes.compression);
        binary_.text(bytes.topology);
        binary_.text(bytes.buffers);
        return;
    }
    // Without metadata the grid is not marked as half floats.
    const auto plain = grid.copyGridReplacingMetadata({});
    const Tags tags(out_);
    openvdb::io::setDataCompression(out_, codec);
    plain->writeTopology(out_);
    plain->writeBuffers(out_);
}

GridReader::GridReader(std::istream& from) : in_(from.rdbuf()), binary_(in_) {
    register_openvdb_types();
    // OpenVDB never checks for short reads.
    in_.exceptions(std::ios_base::failbit | std::ios_base::badbit | std::ios_base::eofbit);
    openvdb::io::setCurrentVersion(in_);
}

openvdb::GridBase::Ptr GridReader::read() {
    return sound([&] { return read_grid(0); });
}

openvdb::GridBase::Ptr GridReader::read_grid(int depth) {
    BinaryReader::require(depth < deepest);
    const bool raw = binary_.value<bool>();
    const auto type = binary_.text();
    BinaryReader::require(raw || is_known_tree(type));
    const auto out =
        raw ? std::make_shared<RawGrid>(type, 0, 0) : openvdb::GridBase::createGrid(type);
    read_tree(*out);
    out->insertMeta(read_metadata(binary_));
    out->setTransform(read_transform(binary_));
    if (binary_.value<bool>())
        set_stored_form(*out, read_stored_form(out->constBaseTreePtr(), depth));
    return out;
}

StoredForm GridReader::read_stored_form(const openvdb::TreeBase::ConstPtr& tree, int depth) {
    StoredForm out;
    out.placement = binary_.value<Placement>();
    if (binary_.value<bool>()) out.in_file = read_transform(binary_);
    for (auto left = binary_.value<std::uint64_t>(); left > 0; --left) {
        out.components.push_back(openvdb::gridPtrCast<FloatGrid>(read_grid(depth + 1)));
        BinaryReader::require(out.components.back() != nullptr);
    }
    if (binary_.value<bool>()) out.merged = tree;
    out.made_staggered = binary_.value<bool>();
    out.class_in_file = binary_.value<bool>();
    return out;
}

void GridReader::read_tree(openvdb::GridBase& grid) {
    const auto number = binary_.value<std::uint64_t>();
    BinaryReader::require(number <= trees_.size());
    const bool raw = RawGrid::of(grid) != nullptr;
    if (number < trees_.size()) {
        BinaryReader::require(
            raw == (dynamic_cast<const RawGrid::Bytes*>(trees_[number].get()) != nullptr));
        grid.setTree(trees_[number]);
        return;
    }
    if (raw) {
        const auto bytes = std::make_shared<RawGrid::Bytes>();
        bytes->compression = binary_.value<std::uint32_t>();
        bytes->topology = binary_.text();
        bytes->buffers = binary_.text();
        grid.setTree(bytes);
    } else {
        require_sound_points(in_, grid.type());
        const Tags tags(in_);
        openvdb::io::setDataCompression(in_, codec);
        grid.readTopology(in_);
        grid.readBuffers(in_);
        check_offsets(grid);
    }
    trees_.push_back(grid.baseTreePtr());
}

void write_metadata(const openvdb::MetaMap& metadata, BinaryWriter& out) {
    register_openvdb_types();
    for (auto each = metadata.beginMeta(); each != metadata.endMeta(); ++each) {
        if (!has_bytes(*each->second)) continue;
        std::ostringstream bytes;
        each->second->write(bytes);
        out.value(true);
        out.text(each->first);
        out.text(each->second->typeName());
        out.text(bytes.str());
    }
    out.value(false);
}

openvdb::MetaMap read_metadata(BinaryReader& in) {
    register_openvdb_types();
    return sound([&] {
        openvdb::MetaMap out;
        while (in.value<bool>()) {
            const auto name = in.text(), type = in.text();
            out.insertMeta(name, *written_metadata(type, in.text()));
        }
        return out;
    });
}

}  // namespace fluidcarve
