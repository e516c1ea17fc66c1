#include "tests/fuzz/vdb_places.h"

#include "tests/fuzz/damage.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <optional>
#include <stdexcept>

namespace fuzz {
namespace {

/// Doubles of OpenVDB's maps.
const std::map<std::string, int> map_numbers{
    {"UniformScaleMap", 15},   {"ScaleMap", 15},      {"UniformScaleTranslateMap", 18},
    {"ScaleTranslateMap", 18}, {"TranslationMap", 3}, {"AffineMap", 16},
    {"UnitaryMap", 16}};

struct Values {
    std::size_t bytes, half_bytes;  ///< of a value in memory and in the file, of one as half floats
};
const std::map<std::string, Values> trees{
    {"Tree_float_5_4_3", {4, 2}}, {"Tree_double_5_4_3", {8, 2}},     {"Tree_vec3s_5_4_3", {12, 6}},
    {"Tree_bool_5_4_3", {1, 1}},  {"Tree_mask_5_4_3", {1, 1}},       {"Tree_int32_5_4_3", {4, 4}},
    {"Tree_int64_5_4_3", {8, 8}}, {"Tree_ptdataidx32_5_4_3", {4, 4}}};
constexpr auto points = "Tree_ptdataidx32_5_4_3";
constexpr std::string_view half_suffix = "_HalfFloat";
constexpr std::size_t blosc_header = 16;

class Walk {
public:
    explicit Walk(const std::string& file) : file_(file) {
        constexpr std::size_t magic = 8, versions_of_library = 8, has_positions = 1,
                              identifier = 36;
        at_ = magic;
        number<std::uint32_t>(Part::version);
        skip(versions_of_library + has_positions + identifier);
        metadata();
        for (auto left = number<std::uint32_t>(Part::grid_count); left > 0; --left) grid();
        chunks();
    }

    std::vector<Place> places;

private:
    void need(std::size_t size) const {
        if (at_ > file_.size() || size > file_.size() - at_)
            throw std::out_of_range("a VDB file that is not sound");
    }
    void skip(std::size_t size) {
        need(size);
        at_ += size;
    }
    void place(Part part, std::size_t size) {
        need(size);
        places.push_back({part, at_, size});
        at_ += size;
    }
    template <class T>
    T number(std::optional<Part> part = {}) {
        need(sizeof(T));
        const auto out = number_at<T>(file_, at_);
        if (part) place(*part, sizeof(T));
        else skip(sizeof(T));
        return out;
    }
    std::string text(std::optional<Part> part = {}, std::optional<Part> length = {}) {
        const auto size = number<std::uint32_t>(length);
        need(size);
        const auto out = file_.substr(at_, size);
        if (part) place(*part, size);
        else skip(size);
        return out;
    }

    void metadata() {
        for (auto left = number<std::uint32_t>(Part::metadata_count); left > 0; --left) {
            text({}, Part::metadata_length);
            const auto type = text({}, Part::metadata_length);
            text(type == "string" ? std::optional(Part::metadata_text) : std::nullopt,
                 Part::metadata_length);
        }
    }

    void grid() {
        text();
        auto type = text(Part::type_name);
        const bool half = type.ends_with(half_suffix);
        if (half) type.resize(type.size() - half_suffix.size());
        const bool instance = !text(Part::parent_name).empty();
        const auto position = number<std::int64_t>(Part::grid_position);
        number<std::int64_t>(Part::grid_position);
        const auto end = number<std::int64_t>(Part::grid_position);
        at_ = static_cast<std::size_t>(position);
        codec_ = number<std::uint32_t>(Part::codec);
        metadata();
        const auto doubles = map_numbers.at(text(Part::map_name));
        for (int n = 0; n < doubles; ++n) place(Part::map_number, sizeof(double));
        if (const auto tree = trees.find(type); tree != trees.end() && !instance) {
            values_ = tree->second;
            half_ = half;
            topology();
            if (type == points && leaves_ > 0) point_attributes();
        }
        at_ = static_cast<std::size_t>(end);
    }

    void topology() {
        leaves_ = 0;
        skip(sizeof(std::int32_t));  // number of buffers
        place(Part::value, values_.bytes);
        const auto tiles = number<std::uint32_t>(Part::tile_count),
                   children = number<std::uint32_t>(Part::child_count);
        const auto coordinates = [&] {
            for (int axis = 0; axis < 3; ++axis) place(Part::coordinate, sizeof(std::int32_t));
        };
        for (std::uint32_t n = 0; n < tiles; ++n) {
            coordinates();
            place(Part::value, values_.bytes);
            place(Part::tile_state, 1);
        }
        for (std::uint32_t n = 0; n < children; ++n) {
            coordinates();
            node(2);
        }
    }

    void node(int level) {
        constexpr std::array<std::size_t, 3> slots{512, 4096, 32768};
        const auto size = slots[static_cast<std::size_t>(level)];
        if (level == 0) {
            ++leaves_;
            return place(Part::mask, size / 8);
        }
        const auto children = count_on(size), on = count_on(size);
        chunk(size, on);
        for (std::size_t n = 0; n < children; ++n) node(level - 1);
    }

    std::size_t count_on(std::size_t bits) {
        need(bits / 8);
        std::size_t out = 0;
        for (std::size_t n = 0; n < bits / 8; ++n)
            out +=
                static_cast<std::size_t>(std::popcount(static_cast<unsigned char>(file_[at_ + n])));
        place(Part::mask, bits / 8);
        return out;
    }

    /// The values of an internal node. @param on  number of active ones
    void chunk(std::size_t slots, std::size_t on) {
        // OpenVDB's kinds: with one or two inactive values, with a mask, all values.
        constexpr std::array<std::size_t, 7> inactive{0, 0, 1, 0, 1, 2, 0};
        constexpr std::uint32_t zip = 1, active_only = 2, blosc = 4;
        const auto kind = number<std::uint8_t>(Part::node_kind);
        skip(inactive.at(kind) * values_.bytes);
        if (kind >= 3 && kind <= 5) place(Part::mask, slots / 8);
        const auto count = (codec_ & active_only) && kind != 6 ? on : slots;
        if (half_ && values_.half_bytes < values_.bytes && count == 0) return;
        const auto bytes = count * (half_ ? values_.half_bytes : values_.bytes);
        if (!(codec_ & (zip | blosc))) return skip(bytes);
        const auto length =
            number<std::int64_t>(codec_ & blosc ? std::nullopt : std::optional(Part::chunk_length));
        skip(length > 0 ? static_cast<std::size_t>(length) : bytes);
    }

    /// The attributes of the first leaf of points.
    void point_attributes() {
        number<std::uint16_t>(Part::point_number);  // passes
        for (std::size_t n = 0; n < leaves_; ++n) number<std::uint16_t>(Part::point_number);
        number<std::uint8_t>(Part::point_number);
        const auto count = number<std::uint64_t>(Part::point_number);
        for (std::uint64_t n = 0; n < 2 * count; ++n) text(Part::point_text);
        for (std::uint64_t n = 0; n < count; ++n) {
            text(Part::point_text);
            number<std::uint64_t>(Part::point_number);
        }
        for (auto groups = number<std::uint64_t>(Part::point_number); groups > 0; --groups) {
            text(Part::point_text);
            number<std::uint64_t>(Part::point_number);
        }
        metadata();
        constexpr std::uint8_t strided = 1;
        for (std::uint64_t n = 0; n < count; ++n) {
            number<std::uint64_t>(Part::point_number);
            number<std::uint8_t>(Part::point_number);
            const auto stored = number<std::uint8_t>(Part::point_number);
            number<std::uint32_t>(Part::point_number);
            if (stored & strided) number<std::uint32_t>(Part::point_number);
        }
    }

    /// Chunks of blosc, wherever they are: a length, and behind it blosc's header, which repeats
    /// it.
    void chunks() {
        constexpr std::size_t length_in_header = 12;
        constexpr char version_of_format = 2;
        for (std::size_t at = 0; at + sizeof(std::int64_t) + blosc_header <= file_.size(); ++at) {
            const auto length = number_at<std::int64_t>(file_, at);
            const auto header = at + sizeof(std::int64_t);
            if (length < static_cast<std::int64_t>(blosc_header) ||
                file_[header] != version_of_format ||
                length != number_at<std::uint32_t>(file_, header + length_in_header))
                continue;
            places.push_back({Part::chunk_length, at, sizeof(std::int64_t)});
            places.push_back({Part::chunk_header, header, blosc_header});
        }
    }

    const std::string& file_;
    std::size_t at_ = 0, leaves_ = 0;
    std::uint32_t codec_ = 0;
    Values values_{};
    bool half_ = false;
};

}  // namespace

std::vector<Place> vdb_places(const std::string& file) { return Walk(file).places; }

std::string spliced(std::string file, const std::vector<Place>& places, std::size_t at,
                    std::size_t size, const std::string& bytes) {
    const auto by = static_cast<std::int64_t>(bytes.size()) - static_cast<std::int64_t>(size);
    for (const auto& place : places) {
        if (place.part != Part::grid_position) continue;
        const auto position = number_at<std::int64_t>(file, place.at);
        if (position > static_cast<std::int64_t>(at)) set_number(file, place.at, position + by);
    }
    return file.replace(at, size, bytes);
}

}  // namespace fuzz
