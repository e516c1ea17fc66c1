// The module `images`: all code that uses OpenImageIO. Loading OpenImageIO, with hundreds of
// libraries, takes half a second.

#include "carve/base/failure.h"
#include "formats/file/module.h"
#include "formats/image/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <zlib.h>

#include <half.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <type_traits>

namespace fluidcarve {

namespace {

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// Rows of pixels that are converted at once, so that a file's own form of them takes little
/// memory. EXR compresses at most 256 together.
constexpr int rows_at_once = 256;

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
    auto text = reason;
    std::ranges::replace(text, '\n', ' ');
    throw Failure(fmt::format("cannot read {}: {}", path, text), Failure::Kind::input);
}

/// Throws the Failure of a file that OpenImageIO can't read. @param reason  OpenImageIO's message
[[noreturn]] void refuse_damaged(const std::string& path, const std::string& reason) {
    refuse(path, (reason.empty() ? "it is damaged" : reason) + "; copy or write it again");
}

std::uint64_t big_endian(const unsigned char* at) {
    return std::uint64_t{at[0]} << 24 | std::uint64_t{at[1]} << 16 | std::uint64_t{at[2]} << 8 |
           at[3];
}

/// Checks that a PNG is complete, by the lengths of its chunks. The PNG library finds a missing end
/// late, and prints to the terminal.
/// @param sums  whether to check the chunks' bytes, too, by their checksums
void require_whole_png(const InputFile& file, bool sums) {
    constexpr std::uint64_t signature = 8, length_bytes = 4, type_bytes = 4, sum_bytes = 4;
    std::vector<unsigned char> chunk;
    for (std::uint64_t at = signature; at + length_bytes + type_bytes + sum_bytes <= file.size();) {
        std::array<unsigned char, length_bytes + type_bytes> head{};
        file.read(at, reinterpret_cast<char*>(head.data()), head.size());
        const auto body = type_bytes + big_endian(head.data()), first = at + length_bytes;
        at = first + body + sum_bytes;
        if (at > file.size()) break;
        if (sums) {
            chunk.resize(body + sum_bytes);
            file.read(first, reinterpret_cast<char*>(chunk.data()), chunk.size());
            if (crc32_z(0, chunk.data(), body) != big_endian(chunk.data() + body))
                refuse_damaged(file.path(), fmt::format("it is damaged at byte {}", first));
        }
        if (std::memcmp(head.data() + length_bytes, "IEND", type_bytes) == 0) return;
    }
    refuse_damaged(file.path(), fmt::format("it is cut off at byte {}", file.size()));
}

/// Calls `call` with a value of a depth's C++ type.
/// @return false if the depth is not a numeric type
template <class Call>
bool with_depth(TypeDesc type, const Call& call) {
    switch (type.basetype) {
        case TypeDesc::UINT8: return call(std::uint8_t{}), true;
        case TypeDesc::INT8: return call(std::int8_t{}), true;
        case TypeDesc::UINT16: return call(std::uint16_t{}), true;
        case TypeDesc::INT16: return call(std::int16_t{}), true;
        case TypeDesc::UINT32: return call(std::uint32_t{}), true;
        case TypeDesc::INT32: return call(std::int32_t{}), true;
        case TypeDesc::HALF: return call(half{}), true;
        case TypeDesc::FLOAT: return call(float{}), true;
        case TypeDesc::DOUBLE: return call(double{}), true;
        default: return false;
    }
}

template <class T>
float to_float(T value) {
    if constexpr (std::is_integral_v<T> && sizeof(T) == sizeof(float))
        return std::bit_cast<float>(value);
    else if constexpr (std::is_integral_v<T>)
        return static_cast<float>(static_cast<double>(value) /
                                  static_cast<double>(std::numeric_limits<T>::max()));
    else return static_cast<float>(value);
}

template <class T>
T from_float(float value) {
    if constexpr (std::is_integral_v<T> && sizeof(T) == sizeof(float)) {
        return std::bit_cast<T>(value);
    } else if constexpr (std::is_integral_v<T>) {
        constexpr auto least = static_cast<double>(std::numeric_limits<T>::min()),
                       most = static_cast<double>(std::numeric_limits<T>::max());
        // Rounds by a conversion, since a call of std::round() takes longer than all other work
        // here. NaN becomes 0.
        const double scaled = static_cast<double>(value) * most,
                     clamped = scaled > least      ? std::min(scaled, most)
                               : std::isnan(value) ? 0.0
                                                   : least;
        return static_cast<T>(static_cast<std::int64_t>(clamped + (clamped < 0 ? -0.5 : 0.5)));
    } else {
        // Infinities stay; finite values are clamped to the range of half.
        if constexpr (std::is_same_v<T, half>)
            if (std::isfinite(value)) value = std::clamp(value, -65504.0f, 65504.0f);
        return static_cast<T>(value);
    }
}

std::vector<Image::Attribute> attributes_of(const ImageSpec& spec) {
    std::vector<Image::Attribute> out;
    for (const auto& each : spec.extra_attribs) {
        Image::Attribute attribute{each.name().string(), each.type().c_str(), {}};
        if (each.type() == TypeDesc::STRING) attribute.value = each.get_ustring().string();
        else if (each.type().basetype == TypeDesc::PTR) continue;
        else if (each.type().basetype == TypeDesc::STRING)
            for (std::size_t n = 0; n < each.type().basevalues(); ++n)
                attribute.value +=
                    static_cast<const OIIO::ustring*>(each.data())[n].string() + '\0';
        else
            attribute.value.assign(static_cast<const char*>(each.data()),
                                   static_cast<std::size_t>(each.datasize()));
        out.push_back(std::move(attribute));
    }
    return out;
}

void set_attributes(ImageSpec& spec, const std::vector<Image::Attribute>& attributes) {
    for (const auto& each : attributes) {
        // OpenImageIO writes this type name but can't parse it.
        const auto type =
            each.type == OIIO::TypeRational.c_str() ? OIIO::TypeRational : TypeDesc(each.type);
        if (type == TypeDesc::STRING) {
            spec.attribute(each.name, each.value);
        } else if (type.basetype == TypeDesc::STRING) {
            std::vector<OIIO::ustring> texts;
            for (std::size_t begin = 0, end = 0;
                 (end = each.value.find('\0', begin)) != std::string::npos; begin = end + 1)
                texts.emplace_back(each.value.substr(begin, end - begin));
            if (texts.size() == type.basevalues()) spec.attribute(each.name, type, texts.data());
        } else if (type.size() == each.value.size())
            spec.attribute(each.name, type, each.value.data());
    }
}

/// An open image file. All errors name the file.
class Input {
public:
    /// @param sums  whether to check all bytes of a PNG by its checksums
    Input(const std::string& path, const std::string& format, bool sums = false)
        : path_(path), opened_(path, image_use), file_(ImageInput::create(format)) {
        if (!file_) refuse(path_, OIIO::geterror());
        if (format == "png") require_whole_png(opened_, sums);
        ImageSpec request;
        request.attribute("oiio:UnassociatedAlpha", 1);
        request.attribute("oiio:RawColor", 1);
        if (!file_->open(opened_.path_to_open(), spec_, request))
            refuse_damaged(path_, file_->geterror());
        if (spec_.deep) refuse(path_, "it holds deep pixels; flatten it first");
        if (spec_.depth > 1) refuse(path_, "it holds a volume; an image has one layer of pixels");
        if (spec_.width < 1 || spec_.height < 1 || spec_.nchannels < 1)
            refuse(path_, "it has no pixels");
        for (const int number : {spec_.x, spec_.y, spec_.full_x, spec_.full_y, spec_.width,
                                 spec_.height, spec_.full_width, spec_.full_height})
            if (number > furthest || number < -furthest)
                refuse(path_,
                       fmt::format(
                           "its data or display window reaches more than {} pixels from the origin",
                           furthest));
        for (int channel = 0; channel < spec_.nchannels; ++channel)
            if (!with_depth(spec_.channelformat(channel), [](auto) {}))
                refuse(path_, fmt::format("channel '{}' is of type {}, which is not supported",
                                          spec_.channel_name(channel),
                                          spec_.channelformat(channel).c_str()));
    }

    Image header(const std::string& format) {
        Image out;
        out.format = format;
        out.data = {spec_.x, spec_.y, spec_.width, spec_.height};
        out.display =
            spec_.full_width > 0 && spec_.full_height > 0
                ? Image::Window{spec_.full_x, spec_.full_y, spec_.full_width, spec_.full_height}
                : out.data;
        for (int channel = 0; channel < spec_.nchannels; ++channel)
            out.channels.push_back(
                {spec_.channel_name(channel), spec_.channelformat(channel).c_str()});
        out.alpha = spec_.alpha_channel;
        out.attributes = attributes_of(spec_);
        out.smaller = file_->seek_subimage(0, 1);
        while (file_->seek_subimage(out.more + 1, 0) && out.more < most_pictures) ++out.more;
        // The search for a further picture ends with an error: clear it.
        file_->geterror();
        return out;
    }

    /// Decodes all pixels, some rows at a time; those of tiled files at once.
    /// @param take  called with the pixels as they are stored, the index of the first, and their
    ///   number
    template <class Take>
    void decode(const Take& take) {
        if (!file_->seek_subimage(0, 0)) refuse_damaged(path_, file_->geterror());
        const bool tiled = spec_.tile_width > 0;
        const auto width = static_cast<std::size_t>(spec_.width);
        const int step = tiled ? spec_.height : std::min(spec_.height, rows_at_once);
        std::unique_ptr<char[]> bytes(
            new char[width * static_cast<std::size_t>(step) * spec_.pixel_bytes(true)]);
        for (int y = 0; y < spec_.height; y += step) {
            const int rows = std::min(step, spec_.height - y), first = spec_.y + y;
            const bool done =
                tiled ? file_->read_image(0, 0, 0, spec_.nchannels, TypeDesc::UNKNOWN, bytes.get())
                      : file_->read_scanlines(0, 0, first, first + rows, 0, 0, spec_.nchannels,
                                              TypeDesc::UNKNOWN, bytes.get());
            if (!done || file_->has_error()) refuse_damaged(path_, file_->geterror());
            take(bytes.get(), width * static_cast<std::size_t>(y),
                 width * static_cast<std::size_t>(rows));
        }
    }

    void read(Image& out) {
        out.pixels.resize(static_cast<std::size_t>(spec_.width) *
                          static_cast<std::size_t>(spec_.height) * out.channels.size());
        decode([&](const char* bytes, std::size_t first, std::size_t pixels) {
            convert(bytes, first, pixels, out);
        });
    }

private:
    void convert(const char* bytes, std::size_t first, std::size_t pixels, Image& out) const {
        const auto stride = spec_.pixel_bytes(true), count = out.channels.size();
        auto* const to = out.pixels.data() + first * count;
        std::size_t offset = 0;
        for (std::size_t c = 0; c < count; ++c) {
            const auto type = spec_.channelformat(static_cast<int>(c));
            with_depth(type, [&](auto zero) {
                auto value = zero;
                const auto convert = [&](const auto& floating) {
                    for (std::size_t n = 0; n < pixels; ++n) {
                        std::memcpy(&value, bytes + n * stride + offset, sizeof value);
                        to[n * count + c] = floating(value);
                    }
                };
                if constexpr (std::is_same_v<decltype(zero), std::uint8_t>) {
                    // A table, since divisions are slow.
                    std::array<float, 256> floats{};
                    for (std::size_t n = 0; n < floats.size(); ++n)
                        floats[n] = to_float(static_cast<std::uint8_t>(n));
                    convert([&](std::uint8_t number) { return floats[number]; });
                } else {
                    convert(to_float<decltype(zero)>);
                }
            });
            offset += type.size();
        }
    }

    static constexpr int most_pictures = 1000;
    static constexpr int furthest =
        1
        << 24;  ///< maximum coordinate of a pixel, so that sums of coordinates fit 32-bit integers
    std::string path_;
    InputFile opened_;
    std::unique_ptr<ImageInput> file_;
    ImageSpec spec_;
};

/// Turns exceptions of the library into a Failure that names the file.
template <class Call>
auto guarded(const std::string& path, const Call& call) {
    try {
        return call();
    } catch (const Failure&) {
        throw;
    } catch (const std::exception& error) {
        refuse_damaged(path, error.what());
    }
}

Image header(const std::string& path, const std::string& format) {
    return guarded(path, [&] { return Input(path, format).header(format); });
}

Image read(const std::string& path, const std::string& format) {
    return guarded(path, [&] {
        Input file(path, format);
        auto out = file.header(format);
        file.read(out);
        return out;
    });
}

Image checked(const std::string& path, const std::string& format) {
    return guarded(path, [&] {
        Input file(path, format, true);
        auto out = file.header(format);
        // A PNG's checksums have shown it, in a tenth of the time.
        if (format != "png") file.decode([](const char*, std::size_t, std::size_t) {});
        return out;
    });
}

/// Some rows of an image's pixels, each channel in its depth.
std::vector<char> stored(const Image& image, const ImageSpec& spec, int first, int rows) {
    const auto width = static_cast<std::size_t>(spec.width),
               pixels = width * static_cast<std::size_t>(rows), stride = spec.pixel_bytes(true),
               count = image.channels.size();
    const auto* const from = image.pixels.data() + width * static_cast<std::size_t>(first) * count;
    std::vector<char> out(pixels * stride);
    std::size_t offset = 0;
    for (std::size_t c = 0; c < count; ++c) {
        const auto type = spec.channelformat(static_cast<int>(c));
        with_depth(type, [&](auto zero) {
            for (std::size_t n = 0; n < pixels; ++n) {
                const auto value = from_float<decltype(zero)>(from[n * count + c]);
                std::memcpy(out.data() + n * stride + offset, &value, sizeof value);
            }
        });
        offset += type.size();
    }
    return out;
}

/// What an image's file holds, and how.
ImageSpec spec_of(const Image& image, int quality) {
    ImageSpec out(image.data.width, image.data.height, static_cast<int>(image.channels.size()),
                  TypeDesc(image.channels.front().depth));
    out.x = image.data.x;
    out.y = image.data.y;
    out.full_x = image.display.x;
    out.full_y = image.display.y;
    out.full_width = image.display.width;
    out.full_height = image.display.height;
    out.channelnames.clear();
    out.channelformats.clear();
    bool mixed = false;
    for (const auto& channel : image.channels) {
        out.channelnames.push_back(channel.name);
        out.channelformats.emplace_back(channel.depth);
        mixed = mixed || channel.depth != image.channels.front().depth;
    }
    if (!mixed) out.channelformats.clear();
    out.alpha_channel = image.alpha;
    set_attributes(out, image.attributes);
    // OpenImageIO would set the time of writing; equal images would then give different files.
    if (!out.find_attribute("DateTime")) out.attribute("DateTime", "");
    if (image.format == "jpeg") out.attribute("CompressionQuality", quality);
    // A third of the time of zlib's default level, and files are 6 % larger.
    if (image.format == "png") out.attribute("png:compressionLevel", 4);
    // Writing EXIF to TIFF fails, with an error for a valid file.
    if (image.format == "tiff") out.attribute("tiff:write_exif", 0);
    return out;
}

void write(const std::string& path, const Image& image, int quality) {
    const auto file = ImageOutput::create(image.format);
    if (!file) throw Failure(OIIO::geterror());
    const auto spec = spec_of(image, quality);
    // Writes into memory: not all of OpenImageIO's writers notice errors of the system.
    OIIO::Filesystem::IOVecOutput encoded;
    file->set_ioproxy(&encoded);
    bool done = file->open(path, spec);
    // OpenImageIO 2.5 complains of windows below 0, but writes them (its pull request 4779).
    if (done) file->geterror();
    // OpenImageIO 2.5 takes automatic strides of natively stored pixels for 0.
    const auto stride = static_cast<OIIO::stride_t>(spec.pixel_bytes(true));
    for (int y = 0; done && y < spec.height; y += rows_at_once) {
        const int rows = std::min(rows_at_once, spec.height - y), first = spec.y + y;
        done =
            file->write_scanlines(first, first + rows, 0, TypeDesc::UNKNOWN,
                                  stored(image, spec, y, rows).data(), stride, stride * spec.width);
    }
    if (!(file->close() && done) || file->has_error()) throw Failure(file->geterror());
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(encoded.buffer().data()),
              static_cast<std::streamsize>(encoded.buffer().size()));
    out.close();
    if (!out) throw Failure("the file did not come out whole; is the disk full?");
}

const ImageModule* images() {
    // The run already reads frames in parallel on all its threads.
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
    // No debug messages: image.write finds attributes that a format does not hold by reading the
    // file back.
    OIIO::attribute("debug", 0);
    static const ImageModule functions{header, read, checked, write};
    return &functions;
}

}  // namespace

extern "C" {
extern const Module fluidcarve_module;
const Module fluidcarve_module{FLUIDCARVE_VERSION, images()};
}

}  // namespace fluidcarve
