#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace fluidcarve {

struct Colour {
    std::uint8_t red = 0;
    std::uint8_t green = 0;
    std::uint8_t blue = 0;
    bool operator==(const Colour&) const = default;
};

/// A dark to bright colour for 0 to 1: black, violet, red, orange, pale yellow, lightness rising evenly, so that equal
/// steps look equal, in grey too. Values outside are clamped.
Colour heat(double fraction);

/// Rows of pixels from the top down.
struct Picture {
    int width = 0;
    int height = 0;
    std::vector<Colour> pixels;
};

/// A page to draw on, kept in memory, written as PNG. Lengths in pixels, y down from the top left.
class Canvas {
public:
    struct Rect {
        double x = 0;
        double y = 0;
        double width = 0;
        double height = 0;
    };
    enum class Align { left, centre, right };
    struct Type {
        double size = 12;
        bool bold = false;
        Colour colour;
    };

    /// @param width, height  1 to 32767
    Canvas(int width, int height, Colour background);
    Canvas(Canvas&&) noexcept;
    ~Canvas();

    int width() const;
    int height() const;
    Colour at(int x, int y) const;

    void fill(const Rect& rect, Colour colour);
    /// A line one pixel wide just inside the rectangle.
    void outline(const Rect& rect, Colour colour, bool dashed);
    /// Enlarges by whole steps pixel by pixel, otherwise smoothly.
    void picture(const Rect& rect, const Picture& picture);
    /// @param y  of the baseline
    void text(double x, double y, const std::string& text, const Type& type, Align align = Align::left);
    double text_width(const std::string& text, const Type& type);

    /// @throws Failure
    void write_png(const std::string& path) const;

private:
    struct Page;
    std::unique_ptr<Page> page_;
};

}  // namespace fluidcarve
