#pragma once

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

/// A line of a plot: y over its place, from 1.
struct Curve {
    std::string name;
    std::vector<double> values;
};

struct Panel {
    std::string title, x_label;
    std::vector<Curve> curves;
};

/// Line plots in rows of two in a PNG, one legend for all: curves of the same place have the same
/// colour and name.
class Plot {
public:
    explicit Plot(std::vector<Panel> panels) : panels_(std::move(panels)) {}

    /// @throws std::runtime_error if the file can't be written
    void write(const std::string& path) const {
        const auto rows = (panels_.size() + columns - 1) / columns;
        const int width =
            static_cast<int>(std::min(columns, panels_.size())) * (panel_width + left + right);
        const int height = static_cast<int>(rows) * (top + panel_height + bottom) + legend;
        auto* const surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
        auto* const cairo = cairo_create(surface);
        cairo_set_source_rgb(cairo, 1, 1, 1);
        cairo_paint(cairo);
        cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                               CAIRO_FONT_WEIGHT_NORMAL);
        cairo_set_font_size(cairo, 13);
        for (std::size_t n = 0; n < panels_.size(); ++n) {
            cairo_save(cairo);
            cairo_translate(cairo, static_cast<double>(n % columns) * (panel_width + left + right),
                            static_cast<double>(n / columns) * (top + panel_height + bottom));
            draw(cairo, panels_[n], left);
            cairo_restore(cairo);
        }
        draw_legend(cairo, height - 18.0);
        const auto status = cairo_surface_write_to_png(surface, path.c_str());
        cairo_destroy(cairo);
        cairo_surface_destroy(surface);
        if (status != CAIRO_STATUS_SUCCESS)
            throw std::runtime_error(path + ": " + cairo_status_to_string(status));
    }

private:
    static constexpr int panel_width = 480, panel_height = 340, left = 78, right = 24, top = 40,
                         bottom = 52, legend = 40;
    static constexpr std::size_t columns = 2;

    static void set_colour(cairo_t* cairo, std::size_t curve) {
        // Okabe and Ito's, which colour-blind readers can tell apart.
        static constexpr std::array<std::array<double, 3>, 6> colours{{{0.60, 0.60, 0.60},
                                                                       {0.90, 0.62, 0.00},
                                                                       {0.84, 0.37, 0.00},
                                                                       {0.00, 0.45, 0.70},
                                                                       {0.00, 0.62, 0.45},
                                                                       {0.80, 0.47, 0.65}}};
        const auto& [r, g, b] = colours[curve % colours.size()];
        cairo_set_source_rgb(cairo, r, g, b);
        // So that curves one upon the other both show.
        const std::array dash{7.0, 5.0};
        cairo_set_dash(cairo, dash.data(), curve == 4 ? 2 : 0, 0);
        cairo_set_line_width(cairo, 2);
    }
    static void set_ink(cairo_t* cairo, double grey) {
        cairo_set_source_rgb(cairo, grey, grey, grey);
        cairo_set_dash(cairo, nullptr, 0, 0);
        cairo_set_line_width(cairo, 1);
    }
    static double text_width(cairo_t* cairo, const std::string& text) {
        cairo_text_extents_t extents;
        cairo_text_extents(cairo, text.c_str(), &extents);
        return extents.x_advance;
    }
    /// @param align  0: x is its left, 0.5: its middle, 1: its right
    static void write_text(cairo_t* cairo, const std::string& text, double x, double y,
                           double align) {
        cairo_move_to(cairo, x - align * text_width(cairo, text), y);
        cairo_show_text(cairo, text.c_str());
    }

    /// A step of 1, 2 or 5 times a power of ten, so that there are about six.
    static double step_of(double range) {
        const double rough = range / 6, power = std::pow(10.0, std::floor(std::log10(rough)));
        for (const double factor : {1.0, 2.0, 5.0})
            if (factor * power >= rough) return factor * power;
        return 10 * power;
    }

    static void draw(cairo_t* cairo, const Panel& panel, double x0) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        std::size_t count = 2;
        for (const auto& curve : panel.curves) {
            low = std::min(low, *std::ranges::min_element(curve.values));
            high = std::max(high, *std::ranges::max_element(curve.values));
            count = std::max(count, curve.values.size());
        }
        const double step = step_of(std::max(high - low, 1e-9));
        low = step * std::floor(low / step);
        high = step * std::ceil(high / step);
        const double y0 = top + panel_height;
        const auto x_of = [&](double n) {
            return x0 + panel_width * n / static_cast<double>(count);
        };
        const auto y_of = [&](double value) {
            return y0 - panel_height * (value - low) / (high - low);
        };

        const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
        for (double value = low; value < high + step / 2; value += step) {
            set_ink(cairo, 0.88);
            cairo_move_to(cairo, x0, std::round(y_of(value)) + 0.5);
            cairo_rel_line_to(cairo, panel_width, 0);
            cairo_stroke(cairo);
            set_ink(cairo, 0.2);
            write_text(cairo, fmt::format("{:.{}f}", value, decimals), x0 - 8, y_of(value) + 5, 1);
        }
        const double x_step = step_of(static_cast<double>(count));
        for (double n = 0; n <= static_cast<double>(count); n += x_step) {
            set_ink(cairo, 0.2);
            cairo_move_to(cairo, std::round(x_of(n)) + 0.5, y0);
            cairo_rel_line_to(cairo, 0, 5);
            cairo_stroke(cairo);
            write_text(cairo, fmt::format("{}", n), x_of(n), y0 + 20, 0.5);
        }
        cairo_rectangle(cairo, x0 + 0.5, top + 0.5, panel_width, panel_height);
        cairo_stroke(cairo);
        write_text(cairo, panel.title, x0, top - 14, 0);
        write_text(cairo, panel.x_label, x0 + panel_width / 2.0, y0 + 42, 0.5);

        for (std::size_t c = 0; c < panel.curves.size(); ++c) {
            set_colour(cairo, c);
            const auto& values = panel.curves[c].values;
            cairo_new_path(cairo);  // text leaves a point behind
            for (std::size_t n = 0; n < values.size(); ++n)
                cairo_line_to(cairo, x_of(static_cast<double>(n + 1)), y_of(values[n]));
            cairo_stroke(cairo);
        }
    }

    void draw_legend(cairo_t* cairo, double y) const {
        double x = left;
        for (std::size_t c = 0; c < panels_.front().curves.size(); ++c) {
            const auto& name = panels_.front().curves[c].name;
            set_colour(cairo, c);
            cairo_move_to(cairo, x, y - 4);
            cairo_rel_line_to(cairo, 34, 0);
            cairo_stroke(cairo);
            set_ink(cairo, 0.2);
            write_text(cairo, name, x + 42, y, 0);
            x += 42 + text_width(cairo, name) + 30;
        }
    }

    std::vector<Panel> panels_;
};
