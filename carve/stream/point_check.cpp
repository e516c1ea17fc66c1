#include "carve/stream/point_check.h"

#include <fmt/format.h>
#include <openvdb/points/AttributeArray.h>
#include <openvdb/points/AttributeGroup.h>
#include <openvdb/points/PointDataGrid.h>
#include <openvdb/points/StreamCompression.h>

#include <cstddef>
#include <limits>
#include <optional>
#include <set>
#include <sstream>
#include <string>

namespace fluidcarve {
namespace {

using openvdb::points::AttributeArray;

/// OpenVDB's bits in the metadata of an attribute.
constexpr std::uint8_t constant_stride = 0x8;  // of flags
constexpr std::uint8_t write_strided = 0x1, write_uniform = 0x2, write_mem_compress = 0x4,
                       write_paged = 0x8;  // of serialization flags

/// Bytes that blosc states for this many bytes of points: OpenVDB fills up short buffers before it
/// compresses them.
std::uint64_t stated_bytes(std::uint64_t bytes) {
    using namespace openvdb::compression;
    return bytes > BLOSC_MINIMUM_BYTES && bytes < BLOSC_PAD_BYTES ? BLOSC_PAD_BYTES : bytes;
}

/// An attribute's values in one leaf.
struct Array {
    std::uint64_t stored = 0;  ///< bytes in the file; of paged arrays, bytes in memory
    std::uint64_t bytes = 0;   ///< bytes in memory
    bool uniform = false, paged = false;
};

/// Follows the pages of one attribute, which hold the arrays of many leaves.
class Pages {
public:
    /// An array's place in the pages.
    /// @param in  at the header of the next page, if a page begins here
    void place(std::uint64_t bytes, TreeBytes& in) {
        if (used_ == size_) {
            const auto stored = in.number<std::int32_t>();
            const auto size = stored > 0 ? in.number<std::int32_t>()
                              : stored == std::numeric_limits<std::int32_t>::min() ? 0
                                                                                   : -stored;
            in.require(size > 0, "a page of points is empty");
            pages_.push_back({stored, static_cast<std::uint64_t>(size)});
            size_ = pages_.back().size;
            used_ = 0;
        }
        in.require(bytes > 0 && bytes <= size_ - used_, "an attribute does not fit its page");
        used_ += bytes;
    }
    bool full() const { return used_ == size_; }
    bool empty() const { return pages_.empty(); }
    /// The pages themselves.
    void read(TreeBytes& in) const {
        for (const auto& page : pages_) {
            const auto data =
                in.take(static_cast<std::uint64_t>(page.stored > 0 ? page.stored : -page.stored));
            if (page.stored > 0) in.check_blosc(data, stated_bytes(page.size));
        }
    }

private:
    struct Page {
        std::int32_t stored;  ///< bytes in the file; negative: not compressed
        std::uint64_t size;   ///< bytes in memory
    };
    std::vector<Page> pages_;
    std::uint64_t used_ = 0, size_ = 0;
};

void check_metadata(TreeBytes& in) {
    for (auto left = in.number<std::uint32_t>(); left > 0; --left) {
        const auto name = in.text(), type = in.text(), value = in.text();
        if (!openvdb::Metadata::isRegisteredType(type)) continue;
        const auto metadata = openvdb::Metadata::createMetadata(type);
        const auto size = static_cast<std::uint32_t>(value.size());
        std::istringstream bytes(std::string(reinterpret_cast<const char*>(&size), sizeof size) +
                                 value);
        metadata->read(bytes);
        in.require(metadata->size() == size,
                   fmt::format("metadata '{}' is not as long as its type", name));
    }
}

/// Names and types of the attributes of a leaf, or of all leaves. @return bytes of a value of each
std::vector<std::uint64_t> descriptor(TreeBytes& in) {
    const auto count = in.number<std::uint64_t>();
    in.require(count <= in.left() / (2 * sizeof(std::uint32_t)),
               "it has more attributes than bytes");
    std::vector<std::uint64_t> out;
    std::size_t groups = 0;
    for (std::uint64_t n = 0; n < count; ++n) {
        const auto value = in.text(), codec = in.text();
        const openvdb::NamePair type(value, codec);
        in.require(AttributeArray::isRegistered(type),
                   fmt::format("an attribute is of the unknown type {} {}", value, codec));
        out.push_back(AttributeArray::create(type, 1, 1)->storageTypeSize());
        if (type == openvdb::points::GroupAttributeArray::attributeType()) ++groups;
    }
    std::set<std::string> names;
    std::vector<bool> named(count);
    for (std::uint64_t n = 0; n < count; ++n) {
        const bool fresh = names.emplace(in.text()).second;
        const auto at = in.number<std::uint64_t>();
        in.require(at < count, "an attribute's name leads to no attribute");
        in.require(fresh && !named[at],
                   "two attributes have one name, or two names lead to one attribute");
        named[at] = true;
    }
    constexpr std::uint64_t groups_in_attribute = 8 * sizeof(openvdb::points::GroupType);
    for (auto left = in.number<std::uint64_t>(); left > 0; --left) {
        in.text();
        in.require(in.number<std::uint64_t>() < groups * groups_in_attribute,
                   "a group of points has no attribute");
    }
    check_metadata(in);
    return out;
}

/// Lengths of an attribute in one leaf. @param value_bytes  bytes of a value
Array array_of(TreeBytes& in, std::uint64_t value_bytes) {
    constexpr std::uint64_t counted_with_data = sizeof(std::int16_t) + sizeof(openvdb::Index);
    const auto length = in.number<std::uint64_t>();
    const auto flags = in.number<std::uint8_t>(), serialization = in.number<std::uint8_t>();
    const auto count = in.number<openvdb::Index>();
    const auto stride = serialization & write_strided ? in.number<openvdb::Index>() : 1;
    in.require(length >= counted_with_data && serialization <= (write_strided | write_uniform |
                                                                write_mem_compress | write_paged),
               "an attribute is stored in an unknown way");
    Array out;
    out.stored = length - counted_with_data;
    out.uniform = serialization & write_uniform;
    out.paged = serialization & write_paged;
    // A stride that varies stands for the total number of values.
    const auto values = out.uniform                 ? 1
                        : (flags & constant_stride) ? std::uint64_t{count} * stride
                                                    : std::uint64_t{stride};
    in.require(out.uniform || (values >= count && count > 0),
               "an attribute has fewer values than points");
    out.bytes = values * value_bytes;
    in.require(out.paged ? out.stored == out.bytes : out.stored <= in.left(),
               "an attribute has a wrong length");
    return out;
}

/// Lengths of all attributes, `[leaf][attribute]`.
/// @param attributes  of each leaf
std::vector<std::vector<Array>> arrays_of(TreeBytes& in, std::size_t leaves,
                                          std::size_t attributes) {
    std::vector<std::vector<Array>> out;
    std::optional<std::vector<std::uint64_t>> of_all;
    for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
        std::vector<std::uint64_t> of_leaf;
        if (!of_all) {
            constexpr std::uint8_t for_all = 1, has_more = 2;
            const auto header = in.number<std::uint8_t>();
            in.require(header <= (for_all | has_more),
                       "its attributes are stored in an unknown way");
            of_leaf = descriptor(in);
            if (header & for_all) of_all = of_leaf;
            if (header & has_more) in.skip(in.number<std::uint64_t>());
        }
        auto& here = out.emplace_back();
        for (const auto value_bytes : of_all ? *of_all : of_leaf)
            here.push_back(array_of(in, value_bytes));
        in.require(here.size() == attributes,
                   "a leaf has another number of attributes than the tree");
    }
    return out;
}

/// The values of an attribute that is not paged.
void read_array(TreeBytes& in, const Array& array) {
    const bool compressed = !array.uniform && in.number<std::uint8_t>() == 1;
    const auto data = in.take(array.stored);
    if (compressed) in.check_blosc(data, stated_bytes(array.bytes));
    else in.require(data.size() >= array.bytes, "an attribute has a wrong length");
}

/// The offsets of the points in a leaf's voxels.
void read_offsets(TreeBytes& in, std::span<const char> mask) {
    constexpr std::uint64_t bytes = 512 * sizeof(std::uint32_t);
    in.skip(mask.size());
    const auto stored = in.number<std::uint16_t>();
    if (stored == std::numeric_limits<std::uint16_t>::max()) in.skip(bytes);
    else in.check_blosc(in.take(stored), bytes);
}

}  // namespace

void check_points(TreeBytes& in, const std::vector<std::span<const char>>& leaves) {
    const auto passes = in.number<std::uint16_t>();
    if (leaves.empty()) return;
    constexpr std::uint16_t passes_besides = 4;
    in.require(passes >= passes_besides && passes % 2 == 0,
               "its points are stored in an unknown number of passes");
    const std::size_t attributes = (passes - passes_besides) / 2U;
    in.skip(leaves.size() * sizeof(std::uint16_t));

    const auto arrays = arrays_of(in, leaves.size(), attributes);
    std::vector<Pages> pages(attributes);
    for (std::size_t n = 0; n < attributes; ++n) {
        for (const auto& leaf : arrays)
            if (leaf[n].paged) pages[n].place(leaf[n].bytes, in);
        in.require(pages[n].full(), "a page of points is longer than its attributes");
    }
    for (const auto& mask : leaves) read_offsets(in, mask);
    for (std::size_t n = 0; n < attributes; ++n) {
        bool all_paged = true;
        for (const auto& leaf : arrays) {
            all_paged = all_paged && leaf[n].paged;
            if (!leaf[n].paged) read_array(in, leaf[n]);
        }
        in.require(all_paged || pages[n].empty(), "an attribute is paged in some leaves only");
        pages[n].read(in);
    }
}

void check_offsets(const openvdb::GridBase& grid) {
    if (!grid.isType<openvdb::points::PointDataGrid>()) return;
    for (auto leaf = static_cast<const openvdb::points::PointDataGrid&>(grid).tree().cbeginLeaf();
         leaf; ++leaf)
        leaf->validateOffsets();
}

}  // namespace fluidcarve
