#include "tests/bench/look_picture.h"

#include "nodes/preview/canvas.h"

#include <algorithm>
#include <cmath>

using namespace fluidcarve;

namespace {

constexpr double largest = 300, least_width = 90, margin = 16, title_height = 26,
                 caption_height = 18;  ///< pixels
constexpr Colour paper{255, 255, 255}, ink{30, 30, 30};

std::uint8_t byte(double value) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

/// A single layer as it is.
Picture layer(const Samples& samples, double white, std::size_t height) {
    Picture out{static_cast<int>(samples.shape[0]), static_cast<int>(height), {}};
    for (std::size_t y = height; y-- > 0;)
        for (std::size_t i = 0; i < samples.shape[0]; ++i) {
            const auto grey = byte(samples.row(y)[i] / white);
            out.pixels.push_back({grey, grey, grey});
        }
    return out;
}

/// A volume seen along v in light that falls along w from above: both are dimmed by what they have
/// passed.
Picture lit(const Samples& samples, double dense) {
    constexpr double dimming = 0.25, shadow = 0.25, ambient = 0.15, sky = 0.12;
    const auto [width, depth, height] = samples.shape;
    Picture out{static_cast<int>(width), static_cast<int>(height), {}};
    std::vector<double> light(width * depth, 1.0);
    for (std::size_t k = height; k-- > 0;)
        for (std::size_t i = 0; i < width; ++i) {
            double through = 1, seen = 0;
            for (std::size_t j = 0; j < depth; ++j) {
                const double there = std::max(0.0f, samples.row(j + depth * k)[i]) / dense,
                             passed = through * std::exp(-dimming * there);
                auto& from_above = light[j * width + i];
                seen += (through - passed) * (ambient + (1 - ambient) * from_above);
                from_above *= std::exp(-shadow * there);
                through = passed;
            }
            const auto grey = byte(std::sqrt(seen + through * sky * sky));
            out.pixels.push_back({grey, grey, grey});
        }
    return out;
}

Picture picture_of(const Samples& samples, double dense) {
    const auto [width, laterals, slices] = samples.shape;
    return std::min(laterals, slices) == 1 ? layer(samples, dense, std::max(laterals, slices))
                                           : lit(samples, dense);
}

struct DrawnRow {
    std::vector<Picture> pictures;
    double scale = 1, width = margin, height = 0;  ///< pixels

    double step(const Picture& picture) const {
        return std::max(least_width, scale * picture.width) + margin;
    }
};

DrawnRow drawn(const LookRow& row) {
    DrawnRow out;
    const double dense = visible_from(row.samples.front()) / 0.02;
    for (const auto& samples : row.samples) out.pictures.push_back(picture_of(samples, dense));
    const auto& widest = std::ranges::max(out.pictures, {}, &Picture::width);
    out.scale = largest / std::max(widest.width, widest.height);
    for (const auto& picture : out.pictures) out.width += out.step(picture);
    out.height = title_height + out.scale * widest.height + caption_height + margin;
    return out;
}

}  // namespace

Samples frame_of(const Samples& samples, std::size_t t) {
    Samples out(1, samples.shape, samples.closed, samples.around);
    const auto size = out.values.size();
    std::copy_n(samples.values.begin() + static_cast<std::ptrdiff_t>(size * t), size,
                out.values.begin());
    return out;
}

void draw_looks(const std::vector<LookRow>& rows, const std::string& path) {
    std::vector<DrawnRow> all;
    double width = 0, height = margin;
    for (const auto& row : rows) {
        all.push_back(drawn(row));
        width = std::max(width, all.back().width);
        height += all.back().height;
    }
    Canvas canvas(static_cast<int>(width), static_cast<int>(height), paper);
    double y = margin;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        double x = margin;
        canvas.text(x, y + 12, rows[r].title, {14, true, ink});
        for (std::size_t n = 0; n < all[r].pictures.size(); ++n) {
            const auto& picture = all[r].pictures[n];
            const Canvas::Rect place{x, y + title_height, all[r].scale * picture.width,
                                     all[r].scale * picture.height};
            canvas.picture(place, picture);
            canvas.text(x, place.y + place.height + 14, rows[r].names[n], {12, false, ink});
            x += all[r].step(picture);
        }
        y += all[r].height;
    }
    canvas.write_png(path);
}
