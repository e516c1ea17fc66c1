#pragma once

#include "formats/file/provenance.h"
#include "nodes/preview/colours.h"

#include <memory>
#include <string>
#include <vector>

namespace fluidcarve {

/// A picture of coloured pixels.
struct Picture {
    int width = 0;
    int height = 0;
    std::vector<Colour> pixels;  ///< `[y][x]`, y down
};

/// Why this build can't draw, with the remedy; empty: it can.
std::string drawing_fault();

/// Reads a PNG file, opacity left out. @throws Failure (input) if it can't be read
Picture read_png(const std::string& path);

/// A page in memory to draw on, which can be written as PNG. Lengths in pixels, y down from the top
/// left.
class Canvas {
public:
    struct Rect {
        double x = 0;
        double y = 0;
        double width = 0;
        double height = 0;
    };
    enum class Align { left, centre, right };
    struct TextStyle {
        double size = 12;
        bool bold = false;
        Colour colour;
    };

    /// @param width, height  pixels, 1 to 32767
    Canvas(int width, int height, Colour background);
    Canvas(Canvas&&) noexcept;
    ~Canvas();

    int width() const;
    int height() const;
    Colour at(int x, int y) const;

    void fill(const Rect& rect, Colour colour);
    /// Draws a border one pixel wide, just inside the rectangle.
    void outline(const Rect& rect, Colour colour, bool dashed);
    struct Line {
        double x0 = 0;
        double y0 = 0;
        double x1 = 0;
        double y1 = 0;
    };
    /// Draws straight lines with round ends, clipped to `within`.
    void lines(const Rect& within, const std::vector<Line>& lines, double width, Colour colour);
    enum class Enlarge { pixels, smoothly };
    /// Draws a picture scaled to a rectangle.
    /// @param enlarge  `pixels` keeps sharp pixels at integer scales; other scales are smooth
    void picture(const Rect& rect, const Picture& picture, Enlarge enlarge = Enlarge::pixels);
    /// Draws a line of text.
    /// @param x  of its left end, centre or right end, as `align` says
    /// @param y  of its baseline
    void text(double x, double y, const std::string& text, const TextStyle& type,
              Align align = Align::left);
    double text_width(const std::string& text, const TextStyle& type);
    /// A text, cut so that it fits a width.
    std::string fitting(std::string text, const TextStyle& type, double width) {
        if (text_width(text, type) <= width) return text;
        // Not in the middle of a letter of several bytes.
        while (!text.empty() && text_width(text + "...", type) > width) {
            while (text.size() > 1 && (static_cast<unsigned char>(text.back()) & 0xc0) == 0x80)
                text.pop_back();
            text.pop_back();
        }
        return text + "...";
    }

    /// The file appears whole or not at all.
    /// @param provenance  the provenance that the file states
    /// @throws Failure if it can't be written
    void write_png(const std::string& path, const Provenance& provenance = {}) const;

private:
    struct Page;
    std::unique_ptr<Page> page_;
};

}  // namespace fluidcarve
