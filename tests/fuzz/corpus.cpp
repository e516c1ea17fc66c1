#include "tests/fuzz/corpus.h"

#include "tests/fuzz/vdb_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>

namespace fuzz {
namespace {

constexpr auto lowest = std::numeric_limits<std::int32_t>::min(),
               last_tile = std::numeric_limits<std::int32_t>::max() - 4095;
constexpr std::uint32_t billions = 0xFFFFFFFF;

/// A sound VDB file, and mutants of it with one fault.
class Vdb {
public:
    explicit Vdb(const Source& source) : source_(source) {}

    /// The nth place of a part.
    const Place& at(Part part, std::size_t nth = 0) const {
        for (const auto& place : source_.places)
            if (place.part == part && nth-- == 0) return place;
        throw std::runtime_error("the corpus aims at a part that its source does not have");
    }
    template <class T>
    T number(const Place& place) const {
        return number_at<T>(source_.bytes, place.at);
    }
    template <class T>
    std::string with(const Place& place, T number) const {
        auto out = source_.bytes;
        set_number(out, place.at, number);
        return out;
    }
    std::string exchanged(const Place& one, const Place& other) const {
        auto out = with(one, number<std::int64_t>(other));
        set_number(out, other.at, number<std::int64_t>(one));
        return out;
    }
    std::string retold(const Place& place, const std::string& text) const {
        return retold_at(source_.bytes, source_.places, place, text);
    }
    std::string with_tile_at(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return with_tile(source_.bytes, source_.places, at(Part::tile_count), x, y, z);
    }
    /// The place of a text of the file's metadata.
    const Place& to_text(const std::string& name) const {
        const auto named = source_.bytes.find(name);
        const auto found = std::ranges::find_if(source_.places, [&](const auto& each) {
            return each.part == Part::metadata_text && each.at > named;
        });
        if (named == std::string::npos || found == source_.places.end())
            throw std::runtime_error("there is no metadata " + name);
        return *found;
    }

private:
    const Source& source_;
};

/// A PNG file that states another width, with the checksum that goes with it.
std::string widened(std::string png, std::uint32_t width) {
    constexpr std::size_t header_at = 12, width_at = 16, checksum_at = 29;
    const auto set = [&](std::size_t at, std::uint32_t number) {
        for (std::size_t n = 0; n < 4; ++n) png[at + n] = static_cast<char>(number >> (24 - 8 * n));
    };
    set(width_at, width);
    std::uint32_t checksum = billions;
    for (auto at = header_at; at < checksum_at; ++at) {
        checksum ^= static_cast<unsigned char>(png[at]);
        for (int bit = 0; bit < 8; ++bit)
            checksum = checksum >> 1 ^ (checksum & 1 ? 0xEDB88320 : 0);
    }
    set(checksum_at, ~checksum);
    return png;
}

/// Ten levels of aliases, each ten times the one before.
std::string aliases() {
    std::string out =
        "fluidcarve: 1\nnodes: {in: {type: vdb.read, path: a.vdb}}\nparams:\n  a0: &a0 [x, x, x, "
        "x, x, x, x, x, x, x]\n";
    for (int n = 1; n < 10; ++n)
        out += fmt::format(
            "  a{0}: &a{0} [*a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}, "
            "*a{1}]\n",
            n, n - 1);
    return out;
}

}  // namespace

void write_corpus(const std::string& folder, const Sources& sources) {
    const auto write = [&](const std::string& name, const std::string& bytes) {
        constexpr std::size_t most_bytes = 20000;
        if (bytes.size() > most_bytes)
            throw std::runtime_error(
                fmt::format("{} has {} bytes; a file of the corpus has {} at most", name,
                            bytes.size(), most_bytes));
        if (!(std::ofstream(folder + "/" + name, std::ios::binary) << bytes).flush())
            throw std::runtime_error(fmt::format("cannot write {}/{}", folder, name));
    };
    std::filesystem::create_directories(folder);

    const Vdb volume(sources.volumes.front());
    const auto& chunk = volume.at(Part::chunk_length, 1);
    const auto length = volume.number<std::int64_t>(chunk);
    write("volume-chunk_negative.vdb", volume.with(chunk, -length));
    write("volume-chunk_lowest.vdb", volume.with(chunk, std::numeric_limits<std::int64_t>::min()));
    write("volume-chunk_huge.vdb", volume.with(chunk, std::int64_t{1} << 60));
    write("volume-chunks_exchanged.vdb", volume.exchanged(chunk, volume.at(Part::chunk_length, 2)));
    write("volume-blosc_larger.vdb",
          volume.with({Part::chunk_header, volume.at(Part::chunk_header, 1).at + 4, 4}, 1 << 30));
    write("volume-tile_huge.vdb", volume.with_tile_at(8192, 0, 0));
    write("volume-tile_lowest.vdb", volume.with_tile_at(lowest, lowest, lowest));
    write("volume-voxels_lowest.vdb", volume.with(volume.at(Part::coordinate), lowest));
    write("volume-voxels_highest.vdb", volume.with(volume.at(Part::coordinate), last_tile));
    write("volume-children_billions.vdb", volume.with(volume.at(Part::child_count), billions));
    write("volume-grids_billions.vdb", volume.with(volume.at(Part::grid_count), 0x7FFFFFFF));
    write("volume-metadata_billions.vdb",
          volume.with(volume.at(Part::metadata_count, 1), billions));
    write("volume-metadata_long.vdb", volume.with(volume.at(Part::metadata_length, 2), billions));
    write("volume-position_negative.vdb",
          volume.with(volume.at(Part::grid_position), std::int64_t{-1}));
    write("volume-positions_exchanged.vdb",
          volume.exchanged(volume.at(Part::grid_position), volume.at(Part::grid_position, 1)));
    write("volume-half.vdb",
          volume.retold(volume.at(Part::type_name), "Tree_float_5_4_3_HalfFloat"));
    write("volume-vectors.vdb", volume.retold(volume.at(Part::type_name), "Tree_vec3s_5_4_3"));
    write("volume-node_kind.vdb", volume.with(volume.at(Part::node_kind), std::uint8_t{127}));
    // A translation, three scales, their voxel, their inverses.
    write("volume-map_nan.vdb",
          volume.with(volume.at(Part::map_number), std::numeric_limits<double>::quiet_NaN()));
    write("volume-map_zero.vdb", volume.with(volume.at(Part::map_number, 3), 0.0));
    write("volume-map_contradicts.vdb", volume.with(volume.at(Part::map_number, 11), 1e9));

    const Vdb points(sources.points.front());
    write("points-passes.vdb", points.with(points.at(Part::point_number), std::uint16_t{7}));
    write("points-attributes_billions.vdb",
          points.with(
              {Part::point_number, points.at(Part::point_text).at - 3 * sizeof(std::uint32_t), 8},
              std::uint64_t{1} << 60));
    // A value's type, its codec and its name are a text each; a name's place follows it.
    const auto attributes = points.number<std::uint64_t>(
        {Part::point_number, points.at(Part::point_text).at - 3 * sizeof(std::uint32_t), 8});
    const auto& last_name = points.at(Part::point_text, 3 * attributes - 1);
    write("points-names_of_one.vdb",
          points.with({Part::point_number, last_name.at + last_name.size, 8}, std::uint64_t{0}));
    write("points-type.vdb", points.retold(points.at(Part::point_text), "double"));

    const Vdb seams(sources.seams.front());
    write("seams-shape_huge.vdb",
          seams.retold(seams.to_text("fluidcarve_shape"), "65535,65535,65535,65535"));
    write("seams-frames_millions.vdb",
          seams.retold(seams.to_text("fluidcarve_frames"), "-2147483648-2147483647"));

    write("mesh-faces_billions.ply",
          "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float "
          "x\nproperty float y\nproperty float z\nelement face 4000000000\n"
          "property list uint int vertex_indices\nend_header\nxxxxyyyyzzzz");
    write("mesh-index_lowest.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -2147483648\n");
    write("image-wide.png", widened(sources.images.front().bytes, 0x7FFFFFFF));
    write("pipeline-aliases.yaml", aliases());
}

}  // namespace fuzz
