#include "formats/seam_file/seam_metadata.h"

#include "carve/base/frame_set.h"
#include "carve/base/one_line.h"

#include <fmt/format.h>
#include <openvdb/Metadata.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>

namespace fluidcarve {

namespace {

constexpr const char* factor_name = "fluidcarve_warp_factor";
constexpr int most_entries = std::numeric_limits<std::uint16_t>::max();

/// `count` whole numbers, separated by commas; nothing if the text is anything else.
template <std::size_t count>
std::optional<std::array<int, count>> numbers(std::string_view text) {
    std::array<int, count> out{};
    for (std::size_t n = 0; n < count; ++n) {
        if (n > 0) {
            if (!text.starts_with(',')) return std::nullopt;
            text.remove_prefix(1);
        }
        text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
        const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), out[n]);
        if (error != std::errc()) return std::nullopt;
        text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
    }
    return text.empty() ? std::optional(out) : std::nullopt;
}

std::string of_file(const openvdb::MetaMap& metadata, const char* name) {
    return seam_text(metadata, name, "the file");
}

/// I, J, K and the number of frames.
std::array<int, 4> read_shape(const std::string& text) {
    const auto out = numbers<4>(text);
    if (!out || std::ranges::any_of(*out, [](int n) { return n < 1 || n > most_entries; }))
        throw wrong_seams(
            fmt::format("'fluidcarve_shape' must be four numbers from 1 to {}, I,J,K,T, not '{}'",
                        most_entries, cut_short(text)));
    return *out;
}

/// @param count  number of frames that the shape states
std::vector<int> read_frames(const std::string& text, int count) {
    // Checked before ranges are expanded: they name at most three times the frames that they leave,
    // as `1-3y2`.
    constexpr int most_named = 3;
    std::string fault;
    const auto set = FrameSet::parse(text, fault, std::int64_t{most_named} * count);
    if (!set) throw wrong_seams("'fluidcarve_frames' " + fault);
    if (static_cast<int>(set->frames().size()) != count)
        throw wrong_seams(
            fmt::format("'fluidcarve_frames' lists {} frames, but 'fluidcarve_shape' {}",
                        set->frames().size(), count));
    return set->frames();
}

/// False if the file does not state it.
bool read_bool(const openvdb::MetaMap& metadata, const char* name) {
    if (!metadata[name]) return false;
    const auto text = of_file(metadata, name);
    if (text != "true" && text != "false")
        throw wrong_seams(
            fmt::format("'{}' must be true or false, not '{}'", name, cut_short(text)));
    return text == "true";
}

/// The two ends of a window; nothing if the file states none.
std::optional<Window> read_window(const openvdb::MetaMap& metadata, const char* name,
                                  const Window& whole) {
    if (!metadata[name]) return std::nullopt;
    const auto text = of_file(metadata, name);
    const auto ends = numbers<2>(text).value_or(std::array{-1, -1});
    const Window out{ends[0], ends[1]};
    if (out.first < whole.first || out.last < out.first || out.last > whole.last)
        throw wrong_seams(
            fmt::format("'{}' must be two vertices from {} to {}, first,last, not '{}'", name,
                        whole.first, whole.last, cut_short(text)));
    return out;
}

Anchor read_anchor(const openvdb::MetaMap& metadata, int size) {
    const auto* const name = "fluidcarve_anchor";
    if (!metadata[name]) return {};
    const auto text = of_file(metadata, name);
    for (const auto at : {Anchor::At::low, Anchor::At::middle, Anchor::At::high})
        if (text == to_text(Anchor{at, 0})) return {at, 0};
    const int vertex = numbers<1>(text).value_or(std::array{-1})[0];
    if (vertex < 0 || vertex >= size)
        throw wrong_seams(
            fmt::format("'{}' must be low, middle, high or a vertex from 0 to {}, not '{}'", name,
                        size - 1, cut_short(text)));
    return {Anchor::At::vertex, vertex};
}

/// @param size  vertices along the carved axis
int read_thickness(const openvdb::MetaMap& metadata, int size) {
    const auto* const name = "fluidcarve_thickness";
    if (!metadata[name]) return 1;
    const auto text = of_file(metadata, name);
    const int thickness = numbers<1>(text).value_or(std::array{0})[0];
    if (thickness < 1 || thickness > size)
        throw wrong_seams(fmt::format("'{}' must be a number of vertices from 1 to {}, not '{}'",
                                      name, size, cut_short(text)));
    return thickness;
}

}  // namespace

bool fits_grids(std::uint64_t count, std::size_t grids, std::size_t bytes_each,
                std::uint64_t held) {
    constexpr std::uint64_t most_per_byte = 8, always_allowed = std::uint64_t{64} << 20;  // bytes
    return grids == 0 || count <= (always_allowed + most_per_byte * held) / (grids * bytes_each);
}

Failure wrong_seams(const std::string& message) { return Failure(message, Failure::Kind::input); }

std::string seam_text(const openvdb::MetaMap& metadata, const std::string& name,
                      const std::string& owner) {
    const auto found = metadata.getMetadata<openvdb::StringMetadata>(name);
    if (!found)
        throw wrong_seams(
            fmt::format("{} has no text '{}' in its metadata, so it is no seam file", owner, name));
    return found->value();
}

std::vector<std::pair<std::string, std::string>> seam_texts(const Seams& seams) {
    const auto text = [](const Window& window) {
        return fmt::format("{},{}", window.first, window.last);
    };
    std::vector<std::pair<std::string, std::string>> out{
        {"fluidcarve_axis", to_text(seams.axis)},
        {"fluidcarve_shape", fmt::format("{},{},{},{}", seams.shape[0], seams.shape[1],
                                         seams.shape[2], seams.frames.size())},
        {"fluidcarve_frames", FrameSet(seams.frames).text()},
        {"fluidcarve_lattice", seams.lattice},
        {"fluidcarve_lattice_hash", seams.lattice_hash}};
    if (seams.closed) out.emplace_back("fluidcarve_closed", "true");
    if (seams.around) out.emplace_back("fluidcarve_around", "true");
    if (seams.window) out.emplace_back("fluidcarve_window", text(*seams.window));
    if (seams.pair_window) out.emplace_back("fluidcarve_pair_window", text(*seams.pair_window));
    if (seams.pair_below) out.emplace_back("fluidcarve_pair_below", text(*seams.pair_below));
    if (seams.anchor != Anchor{}) out.emplace_back("fluidcarve_anchor", to_text(seams.anchor));
    if (seams.thick()) out.emplace_back("fluidcarve_thickness", std::to_string(seams.thickness));
    if (seams.warp) out.emplace_back(factor_name, std::to_string(seams.warp->factor()));
    return out;
}

std::optional<int> warp_factor(const openvdb::MetaMap& metadata) {
    if (!metadata[factor_name]) return std::nullopt;
    const auto text = of_file(metadata, factor_name);
    const auto factor = numbers<1>(text).value_or(std::array{0})[0];
    if (factor != 1 && factor != 2 && factor != 4)
        throw wrong_seams(
            fmt::format("'{}' must be 1, 2 or 4, not '{}'", factor_name, cut_short(text)));
    return factor;
}

Seams seams_of_texts(const openvdb::MetaMap& metadata) {
    Seams out;
    const auto axis = of_file(metadata, "fluidcarve_axis");
    const auto known = {Axis::u, Axis::v, Axis::w, Axis::t};
    const auto* const found = std::ranges::find(known, axis, [](Axis of) { return to_text(of); });
    if (found == known.end())
        throw wrong_seams(
            fmt::format("'fluidcarve_axis' must be u, v, w or t, not '{}'", cut_short(axis)));
    out.axis = *found;
    const auto shape = read_shape(of_file(metadata, "fluidcarve_shape"));
    out.shape = {shape[0], shape[1], shape[2]};
    out.frames = read_frames(of_file(metadata, "fluidcarve_frames"), shape[3]);
    out.lattice = of_file(metadata, "fluidcarve_lattice");
    out.lattice_hash = of_file(metadata, "fluidcarve_lattice_hash");
    out.closed = read_bool(metadata, "fluidcarve_closed");
    out.around = read_bool(metadata, "fluidcarve_around");
    out.window = read_window(metadata, "fluidcarve_window", out.whole_window());
    out.pair_window = read_window(metadata, "fluidcarve_pair_window", out.whole_window());
    out.pair_below = read_window(metadata, "fluidcarve_pair_below", out.whole_window());
    out.anchor = read_anchor(metadata, out.before());
    out.thickness = read_thickness(metadata, out.before());
    if (out.around && ((out.axis != Axis::u && !out.in_time()) || out.anchor != Anchor{}))
        throw wrong_seams(
            "'fluidcarve_around' is true, but seams around a rig are carved along u, and the rig "
            "stays in place");
    if (out.in_time() && (out.anchor != Anchor{} || warp_factor(metadata)))
        throw wrong_seams("'fluidcarve_axis' is t, but there are no warps and anchors in time");
    return out;
}

}  // namespace fluidcarve
