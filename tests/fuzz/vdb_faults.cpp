#include "tests/fuzz/vdb_faults.h"

#include <algorithm>
#include <limits>
#include <set>

namespace fuzz {
namespace {

constexpr std::int32_t edge_of_tile = 4096;

/// A whole number near or far from what it was.
template <class T>
T harmful(T was, Random& random) {
    const auto near = static_cast<std::uint64_t>(was);
    const std::array<std::uint64_t, 16> numbers{0,
                                                1,
                                                ~std::uint64_t{0},
                                                near + 1,
                                                near - 1,
                                                0 - near,
                                                2 * near,
                                                0x7FFFFFFF,
                                                ~std::uint64_t{0x7FFFFFFF},
                                                0xFFFFFFFF,
                                                0x10000,
                                                std::uint64_t{1} << 63,
                                                ~std::uint64_t{0} >> 1,
                                                std::uint64_t{1} << 40,
                                                std::uint64_t{1} << 28,
                                                random()};
    return static_cast<T>(any_of(numbers, random));
}

template <class T>
void harm(std::string& file, std::size_t at, Random& random) {
    set_number(file, at, harmful(number_at<T>(file, at), random));
}

void harm_sized(std::string& file, const Place& place, Random& random) {
    switch (place.size) {
        case 1: return harm<std::int8_t>(file, place.at, random);
        case 2: return harm<std::int16_t>(file, place.at, random);
        case 4: return harm<std::int32_t>(file, place.at, random);
        default: return harm<std::int64_t>(file, place.at, random);
    }
}

/// Exchanges a number with another of the same part.
void exchange(std::string& file, const std::vector<Place>& same, const Place& place,
              Random& random) {
    const auto& other = any_of(same, random);
    if (other.size != place.size) return;
    const auto here = file.substr(place.at, place.size);
    file.replace(place.at, place.size, file.substr(other.at, other.size));
    file.replace(other.at, other.size, here);
}

void harm_coordinate(std::string& file, const Place& place, Random& random) {
    constexpr std::array<std::int32_t, 6> ends{
        std::numeric_limits<std::int32_t>::min(),
        std::numeric_limits<std::int32_t>::max() - edge_of_tile + 1,
        1 << 30,
        -(1 << 30),
        1 << 20,
        edge_of_tile};
    if (random() % 4) set_number(file, place.at, any_of(ends, random));
    else harm<std::int32_t>(file, place.at, random);
}

void harm_mask(std::string& file, const Place& place, Random& random) {
    const auto at = place.at + below(random, place.size);
    switch (random() % 4) {
        case 0: file.replace(place.at, place.size, place.size, '\xff'); break;
        case 1: file.replace(place.at, place.size, place.size, '\0'); break;
        case 2: file[at] = static_cast<char>(file[at] ^ (1 << below(random, 8))); break;
        default: file[at] = static_cast<char>(random()); break;
    }
}

void harm_float(std::string& file, const Place& place, Random& random) {
    constexpr std::array numbers{std::numeric_limits<float>::quiet_NaN(),
                                 std::numeric_limits<float>::infinity(),
                                 3e38f,
                                 -3e38f,
                                 0.0f,
                                 1e-45f};
    if (place.size >= sizeof(float)) set_number(file, place.at, any_of(numbers, random));
    else file[place.at] = static_cast<char>(random());
}

void harm_header(std::string& file, const Place& place, Random& random) {
    // Four bytes, then bytes of the values, of a block and of the chunk.
    if (random() % 3 == 0) file[place.at + below(random, 4)] = static_cast<char>(random());
    else harm<std::int32_t>(file, place.at + 4 * (1 + below(random, 3)), random);
}

const std::vector<std::string> types{"Tree_float_5_4_3",
                                     "Tree_float_5_4_3_HalfFloat",
                                     "Tree_vec3s_5_4_3",
                                     "Tree_vec3s_5_4_3_HalfFloat",
                                     "Tree_bool_5_4_3",
                                     "Tree_mask_5_4_3",
                                     "Tree_double_5_4_3",
                                     "Tree_ptdataidx32_5_4_3",
                                     "Tree_ptdataidx32_5_4_3_HalfFloat",
                                     "Tree_string_5_4_3",
                                     "_HalfFloat",
                                     ""};
const std::vector<std::string> maps{
    "UniformScaleMap", "ScaleTranslateMap",   "AffineMap", "UnitaryMap",
    "TranslationMap",  "NonlinearFrustumMap", ""};
const std::vector<std::string> point_words{"P",
                                           "id",
                                           "vec3s",
                                           "float",
                                           "null",
                                           "trnc",
                                           "ufxpt8",
                                           "grp",
                                           "int32",
                                           "str",
                                           "vec3f",
                                           "",
                                           std::string(300, 'x')};
const std::vector<std::string> words{"",
                                     "0",
                                     "1",
                                     "-1",
                                     "65535",
                                     "65536",
                                     "2147483648",
                                     "99999999999999999999",
                                     "1-2147483647",
                                     "-2147483648-2147483647",
                                     "1-1000000",
                                     "1-1000000x-1",
                                     "u",
                                     "v",
                                     "w",
                                     "low",
                                     "insert",
                                     "remove",
                                     "nan",
                                     "true",
                                     "false",
                                     "0,0",
                                     "0,65534",
                                     "5,1",
                                     "2147483647",
                                     "0,0,0,0",
                                     "1,1,1,1",
                                     "65535,65535,65535,65535",
                                     "2,65535,65535,1",
                                     "-1,11,11,1",
                                     "16,11,11,1",
                                     "16,11,11,2",
                                     "16,11,11,1,1",
                                     "level set",
                                     "staggered",
                                     "fog volume",
                                     "Blender",
                                     "%s%n",
                                     "1,1,1,1e9",
                                     std::string(5000, '9'),
                                     std::string("1\0", 2)};

}  // namespace

std::string retold_at(const std::string& file, const std::vector<Place>& places, const Place& place,
                      const std::string& text) {
    auto out = file;
    set_number(out, place.at - sizeof(std::uint32_t), static_cast<std::uint32_t>(text.size()));
    return spliced(std::move(out), places, place.at, place.size, text);
}

std::string with_tile(const std::string& file, const std::vector<Place>& places,
                      const Place& tile_count, std::int32_t x, std::int32_t y, std::int32_t z) {
    const auto background = std::ranges::find_if(places, [&](const auto& each) {
        return each.part == Part::value && each.at + each.size == tile_count.at;
    });
    std::string tile(3 * sizeof(std::int32_t), '\0');
    std::size_t at = 0;
    for (const auto coordinate : {x, y, z}) set_number(tile, sizeof coordinate * at++, coordinate);
    tile += file.substr(background->at, background->size) + '\1';
    auto out = file;
    set_number(out, tile_count.at, number_at<std::uint32_t>(file, tile_count.at) + 1);
    return spliced(std::move(out), places, tile_count.at + 2 * sizeof(std::uint32_t), 0, tile);
}

std::string faulty_vdb(const std::string& file, const std::vector<Place>& places, Random& random) {
    std::set<Part> parts;
    for (const auto& place : places) parts.insert(place.part);
    const auto part =
        *std::next(parts.begin(), static_cast<std::ptrdiff_t>(below(random, parts.size())));
    std::vector<Place> same;
    std::ranges::copy_if(places, std::back_inserter(same),
                         [&](const auto& each) { return each.part == part; });
    const auto& place = any_of(same, random);
    auto out = file;
    switch (part) {
        case Part::version:
            set_number(out, place.at, static_cast<std::uint32_t>(212 + below(random, 16)));
            break;
        case Part::type_name: return retold_at(file, places, place, any_of(types, random));
        case Part::map_name: return retold_at(file, places, place, any_of(maps, random));
        case Part::point_text: return retold_at(file, places, place, any_of(point_words, random));
        case Part::parent_name:
            return retold_at(file, places, place, std::string(1 + below(random, 3), '\x1e'));
        case Part::metadata_text: return retold_at(file, places, place, any_of(words, random));
        case Part::map_number: {
            constexpr std::array numbers{std::numeric_limits<double>::quiet_NaN(),
                                         std::numeric_limits<double>::infinity(),
                                         0.0,
                                         -0.0,
                                         1e300,
                                         -1e300,
                                         1e-300,
                                         -1.0,
                                         1e18,
                                         1e9};
            set_number(out, place.at, any_of(numbers, random));
            break;
        }
        case Part::tile_count: {
            if (random() % 3 == 0) {
                harm<std::int32_t>(out, place.at, random);
                break;
            }
            const auto anywhere = [&] {
                const auto n = static_cast<std::int32_t>(random() % 4 ? below(random, 9)
                                                                      : below(random, 1 << 20));
                return (random() % 2 ? n : -n - 1) % (1 << 19) * edge_of_tile;
            };
            return with_tile(file, places, place, anywhere(), anywhere(), anywhere());
        }
        case Part::coordinate: harm_coordinate(out, place, random); break;
        case Part::tile_state:
            out[place.at] = static_cast<char>(random() % 2 ? 1 : random());
            break;
        case Part::value: harm_float(out, place, random); break;
        case Part::mask: harm_mask(out, place, random); break;
        case Part::node_kind:
            out[place.at] = static_cast<char>(random() % 4 ? below(random, 8) : random());
            break;
        case Part::chunk_header: harm_header(out, place, random); break;
        case Part::grid_position:
        case Part::chunk_length:
            if (random() % 4 == 0) exchange(out, same, place, random);
            else harm_sized(out, place, random);
            break;
        case Part::codec:
            set_number(out, place.at,
                       static_cast<std::uint32_t>(random() % 4 ? below(random, 8) : random()));
            break;
        case Part::grid_count:
        case Part::metadata_count:
        case Part::metadata_length:
        case Part::child_count:
        case Part::point_number: harm_sized(out, place, random); break;
    }
    return out;
}

std::string faulty_seams(const std::string& file, const std::vector<Place>& places,
                         Random& random) {
    std::vector<Place> texts;
    std::ranges::copy_if(places, std::back_inserter(texts),
                         [](const auto& each) { return each.part == Part::metadata_text; });
    return retold_at(file, places, any_of(texts, random), any_of(words, random));
}

}  // namespace fuzz
