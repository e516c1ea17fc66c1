#pragma once

#include "carve/volume/volume.h"
#include "formats/file/module.h"
#include "formats/image/image_volume.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/image.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <cmath>
#include <random>

using namespace fluidcarve;
using test::failure_of;
using test::NodeBench;

inline const ImageModule& images() { return load_module<ImageModule>("images"); }

template <class T>
Image::Attribute attribute(const std::string& name, const std::string& type,
                           const std::vector<T>& values) {
    return {name, type,
            std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T))};
}

inline std::vector<Image::Channel> channels(const std::vector<std::string>& names,
                                            const std::string& depth) {
    std::vector<Image::Channel> out;
    for (const auto& name : names) out.push_back({name, depth});
    return out;
}

inline float random_value(std::mt19937& random, const std::string& depth) {
    if (depth == "uint8") return static_cast<float>(random() % 256) / 255;
    if (depth == "uint16") return static_cast<float>(random() % 65536) / 65535;
    if (depth == "half")
        return std::ldexp(static_cast<float>(static_cast<int>(random() % 2048) - 1024),
                          static_cast<int>(random() % 20) - 15);
    return std::ldexp(static_cast<float>(random()), static_cast<int>(random() % 60) - 50);
}

inline Image random_image(const std::string& format, const std::vector<Image::Channel>& channels,
                          int width, int height, unsigned seed = 1) {
    Image out;
    out.format = format;
    out.data = out.display = {0, 0, width, height};
    out.channels = channels;
    std::mt19937 random(seed);
    for (int n = 0; n < width * height; ++n)
        for (std::size_t c = 0; c < channels.size(); ++c) {
            if (channels[c].name == "A") out.alpha = static_cast<int>(c);
            out.pixels.push_back(n % 7 == 0 ? 0.0f : random_value(random, channels[c].depth));
        }
    // PNG and TIFF say so where opacity is not multiplied in.
    if (out.alpha >= 0 && format != "openexr")
        out.attributes.push_back(attribute<int>("oiio:UnassociatedAlpha", "int", {1}));
    return out;
}

inline std::vector<std::string> names(const Image& image) {
    std::vector<std::string> out;
    for (const auto& channel : image.channels) out.push_back(channel.name + " " + channel.depth);
    return out;
}

inline Ref<Volume> read(const std::string& path) {
    return NodeBench(image_read(), "{path: \"" + path + "\"}").run({}).at("volume").as<Volume>();
}

inline float at(const Volume& volume, const std::string& channel, int x, int y) {
    return openvdb::gridConstPtrCast<FloatGrid>(volume.find(channel))->tree().getValue({x, y, 0});
}
