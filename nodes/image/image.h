#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

/// A picture as its file holds it. Plain data: all that passes between the core and the module that knows image files.
struct Image {
    /// What a file says beside its pixels: colour space, camera, texts.
    struct Attribute {
        std::string name;
        std::string type;   ///< as OpenImageIO calls it: "string", "int", "matrix", "uint8[540]"
        std::string value;  ///< the text, or the bytes of the numbers; of "string[2]" texts that each end in a 0
    };
    struct Channel {
        std::string name;   ///< "R", "diffuse.G"
        std::string depth;  ///< "uint8", "uint16", "half", "float" and OpenImageIO's others
    };
    /// Pixels, x to the right and y down as in files, the first included and the end not.
    struct Window {
        int x = 0, y = 0, width = 0, height = 0;
        bool operator==(const Window&) const = default;
    };

    std::string format;  ///< OpenImageIO's name: "png", "jpeg", "tiff", "openexr"
    Window data;         ///< the pixels that there are
    Window display;      ///< the picture; only EXR and TIFF tell the two apart
    std::vector<Channel> channels;
    int alpha = -1;  ///< index of the channel that is opacity, or -1
    std::vector<Attribute> attributes;
    int more = 0;  ///< further pictures in the file, which are not read
    /// Row by row of `data`, the channels of a pixel beside each other; whole numbers divided by the largest of their depth.
    std::vector<float> pixels;
};

/// The functions of the module `images`.
struct ImageModule {
    /// All but the pixels.
    /// @throws Failure (input) naming the file and what is wrong
    Image (*header)(const std::string& path, const std::string& format);
    /// The same with pixels. Opacity is not multiplied in or out, colours are not converted.
    Image (*read)(const std::string& path, const std::string& format);
    /// Writes the pixels as they are, each in its channel's depth; values beyond a whole number's range are cut off.
    /// @param quality  of JPEG, 1 to 100
    /// @throws Failure without the path
    void (*write)(const std::string& path, const Image& image, int quality);
};

/// A kind of file that is read and written.
struct ImageFormat {
    std::string name;                  ///< OpenImageIO's
    std::string shown;                 ///< "PNG"
    std::vector<std::string> endings;  ///< of files' names
    std::vector<std::string> starts;   ///< of their bytes
    std::vector<std::string> depths;   ///< that it holds, from the least
};

/// By the ending of a path, whatever its case; null if it is none.
const ImageFormat* format_of_name(const std::string& path);

/// By how the file starts.
/// @throws Failure (input) if the file is missing, can't be read, or is of no kind that is known
const ImageFormat& format_of_file(const std::string& path);

/// ".png, .exr, ...", for messages.
std::string image_endings();

/// Whether a channel of this name is opacity: A or alpha, also of a layer.
bool is_opacity(const std::string& channel);

/// Whether every number of depth `from` comes back from depth `to`.
bool depth_holds(const std::string& to, const std::string& from);

}  // namespace fluidcarve
