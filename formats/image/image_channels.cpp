#include "formats/image/image_channels.h"

#include "carve/base/failure.h"
#include "formats/image/image.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>

namespace fluidcarve {

bool is_identity(const openvdb::GridBase& grid) {
    return grid.isType<openvdb::Int32Grid>() && grid[depth_key] != nullptr;
}

std::string names_of(const Channels& channels) {
    std::string out;
    for (const auto& channel : channels) out += (out.empty() ? "" : ", ") + channel.name();
    return out;
}

namespace {

/// Sorts channels: R, G, B, opacity, others. Most formats need this order.
void sort_colours(Channels& channels) {
    const auto has = [&](const char* name) {
        return std::ranges::any_of(channels, [&](const auto& each) { return each.name() == name; });
    };
    const bool colours = has("R") && has("G") && has("B");
    const auto rank = [&](const VolumeGrid& channel) {
        const auto name = channel.name();
        if (colours)
            return name == "R" ? 0 : name == "G" ? 1 : name == "B" ? 2 : is_opacity(name) ? 3 : 4;
        return channels.size() == 2 && is_opacity(name) ? 1 : 0;
    };
    auto sorted = channels;
    std::ranges::stable_sort(sorted,
                             [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
    channels = std::move(sorted);
}

}  // namespace

Channels channels_of(const Volume& volume, const ImageRequest& request) {
    Channels out;
    const auto take = [&](const VolumeGrid& channel) {
        const auto* const grid = &channel.header();
        if (!grid->isType<FloatGrid>() && !is_identity(*grid))
            throw Failure(
                fmt::format("grid '{}' is of type {}, but a channel of an image is a float grid; "
                            "name those to write: `channels: [R, G, B]`",
                            grid->getName(), grid->type()));
        out.push_back(channel);
    };
    if (request.channels) {
        for (const auto& name : *request.channels) {
            const auto place = volume.place(name);
            if (!place) throw Failure(no_channel(name, volume.names()));
            take(volume.grids[*place]);
        }
    } else {
        for (const auto& grid : volume.grids) take(grid);
        sort_colours(out);
    }
    if (out.empty()) throw Failure("the volume has no grids: nothing to write");
    return out;
}

void require_layout(const Channels& channels, const ImageFormat& format) {
    const bool png = format.name == "png";
    if (!png && format.name != "jpeg") return;
    const auto alphas =
        std::ranges::count_if(channels, [](const auto& each) { return is_opacity(each.name()); });
    const auto colours = channels.size() - static_cast<std::size_t>(alphas);
    const bool alpha_last = alphas == 0 || (alphas == 1 && is_opacity(channels.back().name()));
    if ((colours == 1 || colours == 3) && alpha_last && (png || alphas == 0)) return;
    if (!png && alphas > 0 && (colours == 1 || colours == 3)) {
        auto opaque = channels;
        std::erase_if(opaque, [](const auto& each) { return is_opacity(each.name()); });
        throw Failure(fmt::format(
            "JPEG holds no opacity: leave it out (`channels: [{}]`), or write PNG, TIFF or EXR",
            names_of(opaque)));
    }
    throw Failure(
        fmt::format("{} holds grey or three colours{}, not {}; name the channels to write "
                    "(`channels: [R, G, B]`), or write EXR or TIFF",
                    format.shown, png ? ", each with opacity or without" : "", names_of(channels)));
}

std::vector<std::string> depths_of(const Channels& channels, const ImageRequest& request) {
    const auto& format = *request.format;
    std::vector<std::string> read;
    for (const auto& channel : channels) {
        const auto fallback = channel.header().saveFloatAsHalf() ? "half"
                              : format.depths.back() == "double" ? "float"
                                                                 : format.depths.back();
        read.push_back(meta(channel.header(), depth_key, fallback));
        // 32-bit integers are stored as bits, which no other depth can hold.
        const bool bits = read.back() == "uint" || read.back() == "int";
        if (bits && (format.name != "openexr" || read.back() == "int"))
            throw Failure(
                fmt::format("channel '{}' holds whole numbers of 32 bits, which {} can't keep; "
                            "name the channels to write, or write EXR",
                            channel.name(), read.back() == "int" ? "no format" : format.shown));
        if (request.depth && !bits) read.back() = *request.depth;
    }
    if (request.depth) return read;
    const auto holds_all = [](const std::string& depth, std::span<const std::string> all) {
        return std::ranges::all_of(all, [&](const auto& each) { return depth_holds(depth, each); });
    };
    const auto fitting = [&](std::span<const std::string> all, const std::string& what) {
        for (const auto& depth : format.depths)
            if (holds_all(depth, all)) return depth;
        throw Failure(fmt::format(
            "{} holds {}, but {} {}; state `depth: {}` to round {}{}", format.shown,
            fmt::join(format.depths, " or "), what, fmt::join(all, ", "), format.depths.back(),
            all.size() == 1 ? "it" : "them",
            format.name == "png" || format.name == "jpeg" ? ", or write EXR or TIFF" : ""));
    };
    if (format.name == "openexr") {
        for (std::size_t n = 0; n < read.size(); ++n)
            if (read[n] != "uint")
                read[n] =
                    fitting({&read[n], 1}, fmt::format("channel '{}' is", channels[n].name()));
        return read;
    }
    return std::vector<std::string>(channels.size(), fitting(read, "the channels are"));
}

}  // namespace fluidcarve
