#include "formats/vdb/vdb_file.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/field/dense.h"
#include "carve/grid/named_grids.h"
#include "carve/stream/openvdb_types.h"
#include "carve/stream/point_check.h"
#include "carve/stream/raw_grid.h"
#include "carve/stream/tree_check.h"
#include "formats/file/input_file.h"
#include "formats/vdb/vdb_parts.h"

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/math/Maps.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <span>
#include <sstream>

namespace fluidcarve {

namespace {

using openvdb::io::GridDescriptor;

[[noreturn]] void refuse(const std::string& message) {
    throw Failure(message, Failure::Kind::input);
}

std::string codec_of(std::uint32_t flags) {
    return flags & openvdb::io::COMPRESS_BLOSC ? "blosc"
           : flags & openvdb::io::COMPRESS_ZIP ? "zip"
                                               : "none";
}

}  // namespace

/// The file's stream and the places of its grids. It does not use OpenVDB's header reader, which
/// trusts lengths in the file, stops at unknown grid types, and sorts the grids by name.
class VdbFile::Stream : private openvdb::io::Archive {
public:
    Stream(const std::string& path, std::uint64_t budget) : path_(path), budget_(budget) {
        register_openvdb_types();
        open();
        try {
            walk();
        } catch (const std::ios_base::failure&) {
            refuse(fmt::format(
                "{} is cut off: it ends within its header, at byte {}; copy or write it again",
                path_, size_));
        } catch (const Failure&) {
            throw;
        } catch (const std::exception& error) {
            refuse(fmt::format("{} is damaged: {}", path_, error.what()));
        }
    }

    const std::string& path() const { return path_; }
    const std::vector<GridDescriptor>& grids() const { return grids_; }
    const openvdb::MetaMap& metadata() const { return metadata_; }
    std::uint32_t codecs_seen() const { return codecs_seen_; }

    /// Reads a grid. An instance does not get the tree of its parent.
    openvdb::GridBase::Ptr read(const GridDescriptor& from) {
        const auto grid = empty_grid(from);
        const auto tree_at = tree_place(from);
        try {
            auto bytes = part(from.getGridPos(), from.getEndPos());
            if (is_known_tree(from.gridType()) && !from.isInstance())
                require_fits(from, bytes, tree_at);
            PartBuffer buffer(bytes, from.getGridPos());
            std::istream in(&buffer);
            in.exceptions(std::ios_base::failbit | std::ios_base::badbit | std::ios_base::eofbit);
            adopt(in);
            grid->setSaveFloatAsHalf(from.saveFloatAsHalf());
            readGrid(grid, from, in);
            codecs_seen_ |= openvdb::io::getDataCompression(in);
            check_offsets(*grid);
            check_own_metadata(*grid);
        } catch (const Failure&) {
            throw;
        } catch (const std::exception& error) {
            refuse(fmt::format("{}: cannot read grid '{}': {}; write or copy the file again", path_,
                               shown(from), error.what()));
        }
        // The half flag may be missing in the metadata, but is part of the type's name.
        if (from.saveFloatAsHalf() && !grid->saveFloatAsHalf()) grid->setSaveFloatAsHalf(true);
        return grid;
    }

    /// Memory of a grid. An instance takes none of its own.
    std::optional<GridMemory> memory(const GridDescriptor& of) {
        constexpr std::int64_t most_counted =
            256 << 10;  // a survey looks at every frame, and must stay quick
        if (of.isInstance() || !is_known_tree(of.gridType())) return std::nullopt;
        const auto tree_at = tree_place(of);
        // Any number may stand there: the difference is taken only if it can't overflow.
        if (of.getBlockPos() < tree_at || of.getBlockPos() - tree_at > most_counted)
            return std::nullopt;
        try {
            const auto format = format_of(of);
            const auto counted = size_of_tree(format, part(tree_at, of.getBlockPos()));
            return GridMemory{counted.bytes, counted.active_voxels * format.value_bytes};
        } catch (const std::exception&) {
            return std::nullopt;  // reading the grid reports the fault
        }
    }

    const GridDescriptor& parent_of(const GridDescriptor& grid) const {
        const auto found = by_name_.find(grid.instanceParentName());
        if (found == by_name_.end() || grids_[found->second].isInstance())
            refuse(fmt::format("{}: grid '{}' shares the tree of '{}', which is not there", path_,
                               shown(grid),
                               GridDescriptor::nameAsString(grid.instanceParentName())));
        const auto& out = grids_[found->second];
        if (out.gridType() != grid.gridType())
            refuse(fmt::format(
                "{} is damaged: grid '{}' shares the tree of '{}', which is of another type", path_,
                shown(grid), shown(out)));
        return out;
    }

    unsigned version() const { return version_; }

    /// Reads metadata and transform of a grid, without its tree.
    void describe(const GridDescriptor& grid, VdbHeader::Entry& out) {
        try {
            grid.seekToGrid(stream_);
            if (fileVersion() >= openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION)
                out.codec = codec_of(number<std::uint32_t>());
            read_metadata(out.metadata);
            if (fileVersion() < openvdb::OPENVDB_FILE_VERSION_GRID_INSTANCING) return;
            check_map();
            const auto transform = openvdb::math::Transform::createLinearTransform();
            transform->read(stream_);
            for (const auto& place :
                 {transform->indexToWorld(openvdb::Vec3d(0)),
                  transform->indexToWorld(openvdb::Vec3d(1)), transform->voxelSize()})
                if (!openvdb::math::isFinite(place))
                    refuse(fmt::format("{} is damaged: the transform of grid '{}' is not finite",
                                       path_, shown(grid)));
            if (!agrees_with_itself(*transform))
                refuse(
                    fmt::format("{} is damaged: the numbers of the transform of grid '{}' "
                                "contradict each other; write or copy the file again",
                                path_, shown(grid)));
            out.transform = transform;
        } catch (const Failure&) {
            throw;
        } catch (const std::exception& error) {
            refuse(fmt::format("{} is damaged: grid '{}': {}", path_, shown(grid), error.what()));
        }
    }

    static std::string shown(const GridDescriptor& grid) {
        return GridDescriptor::nameAsString(grid.uniqueName());
    }

private:
    void open() {
        const InputFile file(path_, {.what = "a volume", .folder = "is not a file"});
        size_ = file.size();
        stream_.open(file.path_to_open(), std::ios_base::binary);
        if (!stream_) refuse(fmt::format("cannot open {}: {}", path_, std::strerror(errno)));
        // OpenVDB never checks for short reads.
        stream_.exceptions(std::ios_base::failbit | std::ios_base::badbit | std::ios_base::eofbit);
    }

    void walk() {
        // readHeader checks both too, but logs to stdout, which is for results.
        if (const auto magic = number<std::int64_t>(); magic != openvdb::OPENVDB_MAGIC)
            refuse(std::string_view(reinterpret_cast<const char*>(&magic), 4) == "Nano"
                       ? fmt::format("{} is a NanoVDB file, which can't be read: convert it with "
                                     "nanovdb_convert, or write it as OpenVDB",
                                     path_)
                       : fmt::format("{} is not a VDB file", path_));
        // Version of OpenVDB 13. Grids have the layout of 224, except half-typed ones, which
        // read() refuses.
        constexpr std::uint32_t newest = 225;
        static_assert(openvdb::OPENVDB_FILE_VERSION <= newest);
        version_ = number<std::uint32_t>();
        if (version_ > newest)
            refuse(
                fmt::format("{} has file version {}, and {} is the newest that can be read: write "
                            "it with an older OpenVDB",
                            path_, version_, newest));
        read_header();
        tags_->setSeekable(true);
        adopt(stream_);
        read_metadata(metadata_);
        const auto count = number<std::int32_t>();
        if (count < 0)
            refuse(fmt::format("{} is damaged: its header states {} grids", path_, count));
        const auto first = stream_.tellg();
        const bool places = inputHasGridOffsets();
        const auto whole = places ? std::string() : part(0, static_cast<std::int64_t>(size_));
        if (!places) stream_.seekg(first);
        for (std::int32_t n = 0; n < count; ++n) {
            grids_.push_back(descriptor());
            if (places) check_places(grids_.back());
            else find_end(grids_.back(), whole);
            by_name_.emplace(grids_.back().uniqueName(), grids_.size() - 1);
            stream_.seekg(grids_.back().getEndPos());
        }
    }

    /// Lets OpenVDB read the header. For a newer file, OpenVDB gets a copy with the library's own
    /// version, since it would print a warning.
    void read_header() {
        constexpr std::int64_t longest = 64;
        std::istringstream head(
            part(0, std::min<std::int64_t>(longest, static_cast<std::int64_t>(size_))));
        if (version_ > openvdb::OPENVDB_FILE_VERSION) {
            auto text = head.str();
            const std::uint32_t known = openvdb::OPENVDB_FILE_VERSION;
            text.replace(sizeof(std::int64_t), sizeof known, reinterpret_cast<const char*>(&known),
                         sizeof known);
            head.str(text);
        }
        head.exceptions(std::ios_base::failbit | std::ios_base::badbit | std::ios_base::eofbit);
        readHeader(head);
        stream_.seekg(head.tellg());
    }

    openvdb::GridBase::Ptr empty_grid(const GridDescriptor& of) const {
        if (is_known_tree(of.gridType())) return openvdb::GridBase::createGrid(of.gridType());
        if (version_ != openvdb::OPENVDB_FILE_VERSION)
            refuse(fmt::format(
                "{}: grid '{}' is of type {}, which OpenVDB {} does not know; it can be copied "
                "unchanged only from a file of version {}, but this one has {}: "
                "write the file without this grid",
                path_, shown(of), of.gridType(), openvdb::getLibraryVersionString(),
                static_cast<unsigned>(openvdb::OPENVDB_FILE_VERSION), version_));
        return std::make_shared<RawGrid>(of.gridType(), of.getBlockPos(), of.getEndPos());
    }

    /// The place in the file at which a grid's tree begins.
    std::int64_t tree_place(const GridDescriptor& of) {
        VdbHeader::Entry ignored;
        describe(of, ignored);
        return stream_.tellg();
    }

    /// Checks a grid's tree, and that memory has room for it.
    /// @param all  the grid's bytes
    void require_fits(const GridDescriptor& of, std::span<const char> all, std::int64_t tree_at) {
        if (of.getBlockPos() < tree_at) throw std::runtime_error("its parts overlap");
        const auto tree = static_cast<std::size_t>(tree_at - of.getGridPos()),
                   blocks = static_cast<std::size_t>(of.getBlockPos() - of.getGridPos());
        const auto size =
            check_tree(format_of(of), all.subspan(tree, blocks - tree), all.subspan(blocks));
        if (!grid_fits(static_cast<double>(size.bytes), budget_))
            refuse(
                fmt::format("{}: grid '{}' takes {} of memory, but --memory allows {}: "
                            "crop the grid, or raise --memory",
                            path_, shown(of), size_text(size.bytes), size_text(budget_)));
    }

    /// Finds the places of a grid in a file that OpenVDB's io::Stream wrote: there grids follow
    /// each other, and nothing says where they end.
    /// @param grid   its data begins at the stream's position
    /// @param whole  the file's bytes
    void find_end(GridDescriptor& grid, std::span<const char> whole) {
        grid.setGridPos(stream_.tellg());
        if (!is_known_tree(grid.gridType()))
            refuse(fmt::format(
                "{} was written as a stream, where only the tree of a grid says where it ends, and "
                "grid '{}' is of type {}, which OpenVDB {} does not know: write the file with "
                "openvdb::io::File",
                path_, shown(grid), grid.gridType(), openvdb::getLibraryVersionString()));
        const auto tree_at = tree_place(grid);
        grid.setBlockPos(tree_at);
        grid.setEndPos(tree_at);
        if (grid.isInstance()) return;
        const auto format = format_of(grid);
        try {
            const auto length =
                length_of_tree(format, whole.subspan(static_cast<std::size_t>(tree_at)));
            grid.setBlockPos(tree_at + length.topology);
            grid.setEndPos(grid.getBlockPos() + length.buffers);
        } catch (const std::exception& error) {
            refuse(fmt::format("{} is cut off or damaged: grid '{}': {}; copy or write it again",
                               path_, shown(grid), error.what()));
        }
    }

    /// Tells OpenVDB's readers about the file that a stream belongs to.
    void adopt(std::istream& in) {
        openvdb::io::setStreamMetadataPtr(in, tags_, false);
        setFormatVersion(in);
        setLibraryVersion(in);
        setDataCompression(in);
    }

    std::string part(std::int64_t begin, std::int64_t end) {
        std::string out(static_cast<std::size_t>(end - begin), '\0');
        stream_.seekg(begin);
        stream_.read(out.data(), end - begin);
        return out;
    }

    /// @throws std::runtime_error if its trees can't be checked
    TreeFormat format_of(const GridDescriptor& grid) {
        if (fileVersion() < oldest_file_version)
            throw std::runtime_error(
                fmt::format("the file's version is {}, older than {}; read and write it with an "
                            "application of today",
                            fileVersion(), oldest_file_version));
        stream_.seekg(grid.getGridPos());
        const bool own = fileVersion() >= openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION;
        const auto flags = own ? number<std::uint32_t>() : openvdb::io::getDataCompression(stream_);
        return tree_format(grid.gridType(), grid.saveFloatAsHalf(), fileVersion(), flags);
    }

    /// Reads metadata entry by entry, each from a text of known length: OpenVDB trusts lengths, and
    /// some of its types read another number of bytes.
    void read_metadata(openvdb::MetaMap& out) {
        const auto count = number<std::uint32_t>();
        for (std::uint32_t n = 0; n < count; ++n) {
            const auto name = text(), type = text(), value = text();
            // Sizes of compressed leaves are only needed for delayed loading.
            if (type == openvdb::io::DelayedLoadMetadata::staticTypeName()) continue;
            const auto metadata = metadata_of(type, value);
            if (!metadata)
                throw std::runtime_error(
                    fmt::format("metadata '{}' has another length than its type", name));
            out.insertMeta(name, *metadata);
        }
    }

    /// Checks the lengths of names in a transform before OpenVDB allocates memory for them.
    void check_map() {
        const auto begin = stream_.tellg();
        const auto frustum = openvdb::math::NonlinearFrustumMap::mapType();
        if (text() == frustum) {
            const bool whole_numbers =
                fileVersion() < openvdb::OPENVDB_FILE_VERSION_FLOAT_FRUSTUM_BBOX;
            constexpr auto taper_and_depth = 2 * sizeof(double);
            stream_.seekg(static_cast<std::streamoff>((whole_numbers ? sizeof(openvdb::CoordBBox)
                                                                     : sizeof(openvdb::BBoxd)) +
                                                      taper_and_depth),
                          std::ios_base::cur);
            if (text() == frustum) throw std::runtime_error("a frustum within a frustum");
        }
        stream_.seekg(begin);
    }

    GridDescriptor descriptor() {
        constexpr std::string_view half_suffix = "_HalfFloat";
        const auto name = text();
        auto type = text();
        const bool half = type.ends_with(half_suffix);
        if (half) type.resize(type.size() - half_suffix.size());
        GridDescriptor out(name, type, half);
        if (fileVersion() >= openvdb::OPENVDB_FILE_VERSION_GRID_INSTANCING)
            out.setInstanceParentName(text());
        out.setGridPos(number<std::int64_t>());
        out.setBlockPos(number<std::int64_t>());
        out.setEndPos(number<std::int64_t>());
        return out;
    }

    /// @param grid  the stream is behind its descriptor
    void check_places(const GridDescriptor& grid) {
        // Writers set these offsets when the grid is complete. An instance has no blocks.
        if (grid.getGridPos() < stream_.tellg() ||
            grid.getEndPos() < std::max(grid.getGridPos(), grid.getBlockPos()))
            refuse(
                fmt::format("{} is unfinished or damaged: it does not say where grid '{}' ends; "
                            "wait for its writer, or write it again",
                            path_, shown(grid)));
        if (static_cast<std::uint64_t>(grid.getEndPos()) > size_)
            refuse(fmt::format(
                "{} is cut off: grid '{}' ends at byte {}, the file at {}; copy or write it again",
                path_, shown(grid), grid.getEndPos(), size_));
    }

    template <class T>
    T number() {
        T out{};
        stream_.read(reinterpret_cast<char*>(&out), sizeof out);
        return out;
    }

    std::string text() {
        const auto length = number<std::uint32_t>();
        if (length > size_ - static_cast<std::uint64_t>(stream_.tellg()))
            throw std::ios_base::failure("length");
        std::string out(length, '\0');
        stream_.read(out.data(), length);
        return out;
    }

    std::string path_;
    std::uint64_t budget_;
    std::uint64_t size_ = 0;
    std::uint32_t version_ = 0;  ///< of the file, which may be newer than fileVersion()
    std::shared_ptr<openvdb::io::StreamMetadata> tags_ =
        std::make_shared<openvdb::io::StreamMetadata>();  ///< the stream refers to it
    std::ifstream stream_;
    std::vector<GridDescriptor> grids_;
    /// Unique names and places in `grids_`; of several, the first.
    std::map<std::string, std::size_t> by_name_;
    openvdb::MetaMap metadata_;
    std::uint32_t codecs_seen_ = 0;
};

VdbFile::VdbFile(const std::string& path, std::uint64_t budget)
    : stream_(std::make_unique<Stream>(path, budget)) {}

VdbFile::~VdbFile() = default;

const VdbHeader& VdbFile::header() {
    if (header_) return *header_;
    VdbHeader out;
    out.path = stream_->path();
    out.version = stream_->version();
    out.metadata = stream_->metadata();
    for (const auto& grid : stream_->grids()) {
        out.grids.push_back(
            {Stream::shown(grid), grid.gridName(), grid.gridType(), nullptr, {}, {}});
        stream_->describe(grid, out.grids.back());
    }
    return header_.emplace(std::move(out));
}

Volume VdbFile::read() {
    const auto& all = stream_->grids();
    std::vector<openvdb::GridBase::Ptr> grids;
    for (const auto& grid : all) grids.push_back(stream_->read(grid));
    for (std::size_t n = 0; n < grids.size(); ++n)
        if (const auto& grid = all[n]; grid.isInstance())
            grids[n]->setTree(
                grids[static_cast<std::size_t>(&stream_->parent_of(grid) - all.data())]
                    ->baseTreePtr());
    Volume out;
    out.grids.assign(grids.begin(), grids.end());
    out.metadata = stream_->metadata();
    out.codec = codec_of(stream_->codecs_seen());
    return out;
}

openvdb::GridBase::Ptr VdbFile::read(std::size_t place) {
    const auto& from = stream_->grids()[place];
    auto grid = stream_->read(from);
    if (from.isInstance()) grid->setTree(stream_->read(stream_->parent_of(from))->baseTreePtr());
    return grid;
}

std::optional<GridMemory> VdbFile::memory(std::size_t place) {
    return stream_->memory(stream_->grids()[place]);
}

std::optional<std::size_t> VdbHeader::find(const std::string& name) const {
    for (const auto key : {&Entry::name, &Entry::unique_name})
        for (std::size_t n = 0; n < grids.size(); ++n)
            if (grids[n].*key == name) return n;
    return std::nullopt;
}

std::size_t VdbHeader::place(const std::string& name) const {
    if (const auto found = find(name)) return *found;
    refuse(fmt::format("{} {}", path, lacks_grid(name, names())));
}

std::vector<std::string> VdbHeader::names() const {
    std::vector<std::string> out;
    for (const auto& grid : grids) out.push_back(grid.unique_name);
    return out;
}

VdbHeader read_vdb_header(const std::string& path) { return VdbFile(path).header(); }

Volume read_vdb(const std::string& path) { return VdbFile(path).read(); }

}  // namespace fluidcarve
