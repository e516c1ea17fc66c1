#pragma once

#include "formats/file/input_file.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A picture as stored in a file. Plain data, exchanged between the core and the module that reads
/// and writes image files.
struct Image {
    /// One entry of a file's metadata: colour space, camera, texts.
    struct Attribute {
        std::string name;
        std::string type;   ///< OpenImageIO's name: "string", "int", "matrix", "uint8[540]"
        std::string value;  ///< the text, or the bytes of the numbers; for "string[2]" two texts,
                            ///< each ended by a 0
    };
    struct Channel {
        std::string name;   ///< "R", "diffuse.G"
        std::string depth;  ///< "uint8", "uint16", "half", "float" or another type of OpenImageIO
    };
    /// A rectangle of pixels, x to the right, y down as in files. `x` and `y` are the first pixel.
    struct Window {
        int x = 0, y = 0, width = 0, height = 0;
        bool operator==(const Window&) const = default;
    };

    std::string format;  ///< OpenImageIO's name: "png", "jpeg", "tiff", "openexr"
    Window data;         ///< the stored pixels
    Window display;      ///< the visible picture; differs from `data` in EXR and TIFF only
    std::vector<Channel> channels;
    int alpha = -1;  ///< index of the opacity channel, or -1
    std::vector<Attribute> attributes;
    int more = 0;          ///< number of further pictures in the file, which are not read
    bool smaller = false;  ///< whether the file holds smaller copies of the picture (mipmaps),
                           ///< which are not read
    /// Values of the data window: `[y][x][channel]`. Integers are divided by the largest value of
    /// their depth; 32-bit integers are stored as their bits.
    std::vector<float> pixels;
};

/// The functions of the module `images`.
struct ImageModule {
    static constexpr auto package = "libopenimageio-dev";
    /// Reads an image without its pixels. @param format  ImageFormat::name
    /// @throws Failure (input) naming the file and the fault
    Image (*header)(const std::string& path, const std::string& format);
    /// Reads an image with its pixels. Colours are neither converted nor multiplied or divided by
    /// opacity.
    /// @throws Failure as `header`
    Image (*read)(const std::string& path, const std::string& format);
    /// Checks that all pixels can be read. Returns the same as `header`.
    /// @throws Failure as `header`
    Image (*checked)(const std::string& path, const std::string& format);
    /// Writes the pixels unchanged, each channel in its depth. Values outside the range of an
    /// integer depth are clamped.
    /// @param quality  JPEG quality, 1 to 100
    /// @throws Failure, without the path in its message
    void (*write)(const std::string& path, const Image& image, int quality);
};

/// How image files are opened.
inline constexpr FileUse image_use{.what = "an image", .folder = "is not a file"};

/// A supported image format.
struct ImageFormat {
    std::string name;                  ///< OpenImageIO's name
    std::string shown;                 ///< name in messages: "PNG"
    std::vector<std::string> endings;  ///< file extensions
    std::vector<std::string> starts;   ///< alternatives for the first bytes of a file
    std::vector<std::string> depths;   ///< supported depths, the smallest first
};

/// The format of a path's extension, upper or lower case; null if unknown.
const ImageFormat* format_of_name(const std::string& path);

/// The format of a file, by its first bytes.
/// @throws Failure (input) if the file is missing, can't be read, has an unknown format, or the
///   extension of another one
const ImageFormat& format_of_file(const std::string& path);

/// The extensions of all formats: ".png", ".exr", ...
std::vector<std::string> all_image_endings();

/// The same for messages: ".png, .exr, ...".
std::string image_endings();

/// "there is no channel 'Q'; there are R, G, B". @param there  names of all channels, as `R, G, B`
std::string no_channel(const std::string& channel, const std::string& there);
/// Checks by name that channels exist.
/// @param wanted  nothing: checks nothing
/// @throws Failure with the message of no_channel()
void require_channels(const std::optional<std::vector<std::string>>& wanted,
                      const std::vector<std::string>& there);

/// Whether a channel is opacity by its name: A or alpha, also with a layer's name before it.
bool is_opacity(const std::string& channel);

/// Whether the values of a channel are identifiers, which must never be averaged: whole numbers of
/// 32 bits, layers of Cryptomatte with their coverages, and passes such as IndexOB and objectId.
bool is_identity(const Image::Channel& channel, const std::vector<Image::Attribute>& attributes);

/// The three channels of the picture that people look at: R, G and B, else those of a layer, such
/// as ViewLayer.Combined. Empty: there are none.
std::vector<std::string> colours_of(const std::vector<std::string>& channels);

/// Whether a channel, by its name, holds distances from the camera.
bool is_depth(const std::string& channel);

/// Whether depth `to` holds every number of depth `from` without loss.
bool depth_holds(const std::string& to, const std::string& from);

}  // namespace fluidcarve
