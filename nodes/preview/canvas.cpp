#include "nodes/preview/canvas.h"

#include "carve/base/failure.h"
#include "formats/file/module.h"
#include "formats/file/output_file.h"
#include "formats/image/image_provenance.h"

#include <cairo.h>
#include <fmt/format.h>

#include <cairo-ft.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <optional>
#include <utility>

namespace fluidcarve {
namespace {

struct Destroy {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
};
/// A font that is installed with fluidcarve, open until the program ends; null: there is none.
cairo_font_face_t* own_font(const char* file) {
    static FT_Library library = nullptr;
    FT_Face face = nullptr;
    if (!library && FT_Init_FreeType(&library) != 0) return nullptr;
    if (FT_New_Face(library, (library_folder() / "fonts" / file).c_str(), 0, &face) != 0)
        return nullptr;
    return cairo_ft_font_face_create_for_ft_face(face, 0);
}

/// Takes fluidcarve's own font, in an archive that holds one, else the machine's.
void take_font(cairo_t* context, bool bold) {
    static const std::array own{own_font("DejaVuSans.ttf"), own_font("DejaVuSans-Bold.ttf")};
    if (auto* const font = own[bold ? 1 : 0]) cairo_set_font_face(context, font);
    else
        cairo_select_font_face(context, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                               bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
}

using Surface = std::unique_ptr<cairo_surface_t, Destroy>;

/// The part of a line in a rectangle (Liang and Barsky 1984); nothing: none of it.
std::optional<Canvas::Line> cut(const Canvas::Line& line, const Canvas::Rect& within) {
    const auto& [x0, y0, x1, y1] = line;
    double first = 0, last = 1;
    for (const auto& [step, room] :
         {std::pair(x0 - x1, x0 - within.x), std::pair(x1 - x0, within.x + within.width - x0),
          std::pair(y0 - y1, y0 - within.y), std::pair(y1 - y0, within.y + within.height - y0)}) {
        if (step == 0 && room < 0) return std::nullopt;
        if (step < 0) first = std::max(first, room / step);
        if (step > 0) last = std::min(last, room / step);
    }
    if (first > last) return std::nullopt;
    return Canvas::Line{x0 + first * (x1 - x0), y0 + first * (y1 - y0), x0 + last * (x1 - x0),
                        y0 + last * (y1 - y0)};
}

/// Writes bytes for cairo. @param to  std::ofstream
cairo_status_t put_bytes(void* to, const unsigned char* bytes, unsigned count) {
    auto& out = *static_cast<std::ofstream*>(to);
    return out.write(reinterpret_cast<const char*>(bytes), count) ? CAIRO_STATUS_SUCCESS
                                                                  : CAIRO_STATUS_WRITE_ERROR;
}

}  // namespace

std::string drawing_fault() { return {}; }

Picture read_png(const std::string& path) {
    const Surface image(cairo_image_surface_create_from_png(path.c_str()));
    if (const auto status = cairo_surface_status(image.get()))
        throw Failure(
            fmt::format("cannot read the picture {}: {}", path, cairo_status_to_string(status)),
            Failure::Kind::input);
    Picture out{cairo_image_surface_get_width(image.get()),
                cairo_image_surface_get_height(image.get()),
                {}};
    out.pixels.reserve(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
    const auto* row = cairo_image_surface_get_data(image.get());
    for (int y = 0; y < out.height; ++y, row += cairo_image_surface_get_stride(image.get()))
        for (int x = 0; x < out.width; ++x) {
            const auto pixel = reinterpret_cast<const std::uint32_t*>(row)[x];
            out.pixels.push_back({static_cast<std::uint8_t>(pixel >> 16),
                                  static_cast<std::uint8_t>(pixel >> 8),
                                  static_cast<std::uint8_t>(pixel)});
        }
    return out;
}

struct Canvas::Page {
    Surface surface;
    std::unique_ptr<cairo_t, Destroy> context;

    cairo_t* ink(Colour colour) const {
        cairo_set_source_rgb(context.get(), colour.red / 255.0, colour.green / 255.0,
                             colour.blue / 255.0);
        return context.get();
    }
    cairo_t* pen(const TextStyle& type) const {
        take_font(context.get(), type.bold);
        cairo_set_font_size(context.get(), type.size);
        return ink(type.colour);
    }
};

Canvas::Canvas(int width, int height, Colour background) : page_(std::make_unique<Page>()) {
    page_->surface.reset(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
    page_->context.reset(cairo_create(page_->surface.get()));
    if (const auto status = cairo_status(page_->context.get()))
        throw Failure(fmt::format("cannot make a picture of {} x {} pixels: {}", width, height,
                                  cairo_status_to_string(status)));
    cairo_paint(page_->ink(background));
}

Canvas::Canvas(Canvas&&) noexcept = default;
Canvas::~Canvas() = default;

int Canvas::width() const { return cairo_image_surface_get_width(page_->surface.get()); }
int Canvas::height() const { return cairo_image_surface_get_height(page_->surface.get()); }

Colour Canvas::at(int x, int y) const {
    cairo_surface_flush(page_->surface.get());
    const auto* const row =
        cairo_image_surface_get_data(page_->surface.get()) +
        static_cast<std::ptrdiff_t>(y) * cairo_image_surface_get_stride(page_->surface.get());
    const auto pixel = reinterpret_cast<const std::uint32_t*>(row)[x];
    return {static_cast<std::uint8_t>(pixel >> 16), static_cast<std::uint8_t>(pixel >> 8),
            static_cast<std::uint8_t>(pixel)};
}

void Canvas::fill(const Rect& rect, Colour colour) {
    auto* const context = page_->ink(colour);
    cairo_rectangle(context, rect.x, rect.y, rect.width, rect.height);
    cairo_fill(context);
}

void Canvas::outline(const Rect& rect, Colour colour, bool dashed) {
    auto* const context = page_->ink(colour);
    const double dashes[] = {4, 4};
    cairo_set_dash(context, dashes, dashed ? 2 : 0, 0);
    cairo_set_line_width(context, 1);
    cairo_rectangle(context, rect.x + 0.5, rect.y + 0.5, std::max(rect.width - 1, 0.0),
                    std::max(rect.height - 1, 0.0));
    cairo_stroke(context);
}

void Canvas::lines(const Rect& within, const std::vector<Line>& lines, double width,
                   Colour colour) {
    auto* const context = page_->ink(colour);
    cairo_save(context);
    cairo_rectangle(context, within.x, within.y, within.width, within.height);
    cairo_clip(context);
    cairo_set_dash(context, nullptr, 0, 0);
    cairo_set_line_width(context, width);
    cairo_set_line_cap(context, CAIRO_LINE_CAP_ROUND);
    // Cairo has 24 bits before the point: lines that end far beyond the page would wrap into it.
    const Rect around{within.x - width, within.y - width, within.width + 2 * width,
                      within.height + 2 * width};
    for (const auto& each : lines) {
        const auto line = cut(each, around);
        if (!line) continue;
        cairo_move_to(context, line->x0, line->y0);
        cairo_line_to(context, line->x1, line->y1);
    }
    cairo_stroke(context);
    cairo_restore(context);
}

void Canvas::picture(const Rect& rect, const Picture& picture, Enlarge enlarge) {
    const Surface image(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, picture.width, picture.height));
    if (const auto status = cairo_surface_status(image.get()))
        throw Failure(fmt::format("cannot draw a picture: {}", cairo_status_to_string(status)));
    cairo_surface_flush(image.get());
    const int stride = cairo_image_surface_get_stride(image.get());
    for (int y = 0; y < picture.height; ++y) {
        auto* const row = reinterpret_cast<std::uint32_t*>(
            cairo_image_surface_get_data(image.get()) + static_cast<std::ptrdiff_t>(y) * stride);
        for (int x = 0; x < picture.width; ++x) {
            const auto& pixel = picture.pixels[static_cast<std::size_t>(y) * picture.width + x];
            row[x] = static_cast<std::uint32_t>(pixel.red << 16 | pixel.green << 8 | pixel.blue);
        }
    }
    cairo_surface_mark_dirty(image.get());

    auto* const context = page_->context.get();
    const double scale = rect.width / picture.width;
    cairo_save(context);
    cairo_rectangle(context, rect.x, rect.y, rect.width, rect.height);
    cairo_clip(context);
    cairo_translate(context, rect.x, rect.y);
    cairo_scale(context, scale, rect.height / picture.height);
    cairo_set_source_surface(context, image.get(), 0, 0);
    const bool pixels = enlarge == Enlarge::pixels && scale == std::round(scale);
    cairo_pattern_set_filter(cairo_get_source(context),
                             pixels ? CAIRO_FILTER_NEAREST : CAIRO_FILTER_GOOD);
    // Otherwise a smooth filter fades into the page at the border.
    cairo_pattern_set_extend(cairo_get_source(context), CAIRO_EXTEND_PAD);
    cairo_paint(context);
    cairo_restore(context);
}

void Canvas::text(double x, double y, const std::string& text, const TextStyle& type, Align align) {
    const double width = align == Align::left ? 0 : text_width(text, type);
    auto* const context = page_->pen(type);
    cairo_move_to(context, std::round(x - (align == Align::right ? width : width / 2)), y);
    cairo_show_text(context, text.c_str());
}

double Canvas::text_width(const std::string& text, const TextStyle& type) {
    cairo_text_extents_t extents;
    cairo_text_extents(page_->pen(type), text.c_str(), &extents);
    return extents.x_advance;
}

void Canvas::write_png(const std::string& path, const Provenance& provenance) const {
    // The context keeps the first error of all drawing calls.
    auto status = cairo_status(page_->context.get());
    OutputFile file(path);
    std::ofstream out(file.aside(), std::ios::binary);
    if (status == CAIRO_STATUS_SUCCESS)
        status = cairo_surface_write_to_png_stream(page_->surface.get(), put_bytes, &out);
    if (status != CAIRO_STATUS_SUCCESS && status != CAIRO_STATUS_WRITE_ERROR)
        throw Failure(fmt::format("cannot write {}: {}", path, cairo_status_to_string(status)));
    file.close(out);
    add_provenance(file.aside(), provenance);
    file.commit();
}

}  // namespace fluidcarve
