#include "runtime/html/plot.h"

#include "graph/text/xml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fluidcarve {
namespace {

constexpr double width = 420, height = 230, top = 30, bottom = 38, right = 14;
constexpr double text_size = 12;
constexpr std::size_t most_marks = 60;  ///< curves with more points have no marks

/// Step of a scale: 1, 2 or 5 times a power of ten, about a quarter of the range.
double step_of(double range) {
    const double rough = range / 4, power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= rough * 0.999) return factor * power;
    return 10 * power;
}

/// Maps a plot's values to pixels.
class Axes {
public:
    explicit Axes(const LinePlot& plot) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const auto& curve : plot.curves) {
            count_ = std::max(count_, curve.values.size());
            for (const auto value : curve.values) {
                if (!std::isfinite(value)) continue;
                low = std::min(low, value);
                high = std::max(high, value);
            }
        }
        if (!(low <= high)) low = high = 0;
        if (plot.from_zero) low = std::min(low, 0.0);
        if (low == high) high = low + std::max(std::abs(low) * 0.1, 1e-12);
        step_ = step_of(high - low);
        low_ = step_ * std::floor(low / step_ + 1e-9);
        high_ = step_ * std::ceil(high / step_ - 1e-9);
        const double most = std::max(std::abs(low_), std::abs(high_));
        if (most >= 1e5 || most < 1e-2)
            power_ = 3 * static_cast<int>(std::floor(std::log10(most) / 3));
        std::size_t longest = 0;
        for (const auto value : ticks()) longest = std::max(longest, label(value).size());
        left_ = static_cast<double>(longest) * text_size * 0.6 + 14;
    }

    double left() const { return left_; }
    double x(std::size_t n) const {
        const double share =
            count_ > 1 ? static_cast<double>(n) / static_cast<double>(count_ - 1) : 0.5;
        return left_ + 8 + share * (width - right - left_ - 16);
    }
    double y(double value) const {
        return height - bottom - (value - low_) / (high_ - low_) * (height - bottom - top);
    }
    std::vector<double> ticks() const {
        std::vector<double> out;
        const auto steps = static_cast<int>(std::lround((high_ - low_) / step_));
        for (int n = 0; n <= steps; ++n) out.push_back(low_ + n * step_);
        return out;
    }
    /// Indices of the points that get a label on the x axis: the first, and those at round numbers.
    std::vector<std::size_t> places() const {
        const auto step = std::max<std::size_t>(
            1, static_cast<std::size_t>(
                   step_of(std::max<double>(4, static_cast<double>(count_) / 1.6))));
        std::vector<std::size_t> out;
        for (std::size_t n = 0; n < count_; ++n)
            if ((n + 1) % step == 0 || n == 0) out.push_back(n);
        return out;
    }
    std::string label(double value) const {
        const double unit = std::pow(10.0, power_);
        const int decimals =
            std::max(0, -static_cast<int>(std::floor(std::log10(step_ / unit) + 1e-9)));
        return fmt::format("{:.{}f}", std::abs(value) < step_ / 2 ? 0.0 : value / unit, decimals);
    }
    /// The power of ten that labels of the y axis leave out, for the title; empty if there is none.
    std::string power() const {
        return power_ == 0 ? std::string() : fmt::format(", in 1e{}", power_);
    }

private:
    std::size_t count_ = 0;
    double low_ = 0, high_ = 1, step_ = 1, left_ = 0;
    int power_ = 0;
};

std::string text(double x, double y, const char* anchor, const std::string& words) {
    return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}">{}</text>)", x, y, anchor,
                       xml_text(words));
}

std::string point(const Axes& axes, std::size_t n, double value) {
    return fmt::format("{:.1f},{:.1f}", axes.x(n), axes.y(value));
}

std::string line(const Axes& axes, const PlotCurve& curve) {
    std::string path;
    bool drawing = false;
    for (std::size_t n = 0; n < curve.values.size(); ++n) {
        const auto value = curve.values[n];
        if (std::isfinite(value)) path += (drawing ? " L" : " M") + point(axes, n, value);
        drawing = std::isfinite(value);
    }
    return fmt::format(R"(<path class="{}" d="{}" fill="none"/>)", curve.style, path);
}

/// The area between two curves, where both have values.
std::string band(const Axes& axes, const std::vector<double>& upper,
                 const std::vector<double>& lower) {
    std::string path, back;
    const auto close = [&] {
        if (!back.empty()) path += back + " Z";
        back.clear();
    };
    for (std::size_t n = 0; n < std::min(upper.size(), lower.size()); ++n) {
        if (!std::isfinite(upper[n]) || !std::isfinite(lower[n])) {
            close();
            continue;
        }
        path += (back.empty() ? " M" : " L") + point(axes, n, upper[n]);
        back = " L" + point(axes, n, lower[n]) + back;
    }
    close();
    return fmt::format(R"(<path class="band" d="{}"/>)", path);
}

std::string marks(const Axes& axes, const PlotCurve& curve, const std::vector<std::string>& notes) {
    std::string out;
    for (std::size_t n = 0; n < curve.values.size(); ++n)
        if (std::isfinite(curve.values[n]))
            out += fmt::format(
                R"(<circle class="{}" cx="{:.1f}" cy="{:.1f}" r="3">{}</circle>)", curve.style,
                axes.x(n), axes.y(curve.values[n]),
                n < notes.size() ? "<title>" + xml_text(notes[n]) + "</title>" : std::string());
    return out;
}

}  // namespace

std::string to_svg(const LinePlot& plot) {
    const Axes axes(plot);
    auto out =
        fmt::format("<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" font-size=\"{}\">\n",
                    width, height, text_size);
    out += text(0, 14, "start", plot.title + axes.power()) + "\n";
    for (const auto value : axes.ticks()) {
        out +=
            fmt::format(R"(<line class="grid" x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}"/>)",
                        axes.left(), axes.y(value), width - right, axes.y(value));
        out += text(axes.left() - 8, axes.y(value) + 4, "end", axes.label(value)) + "\n";
    }
    for (const auto place : axes.places())
        out +=
            text(axes.x(place), height - bottom + 18, "middle", std::to_string(place + 1)) + "\n";
    out += text((axes.left() + width - right) / 2, height - 4, "middle", plot.x_label) + "\n";
    if (plot.band && plot.curves.size() > 1)
        out += band(axes, plot.curves[0].values, plot.curves[1].values) + "\n";
    for (auto curve = plot.curves.rbegin(); curve != plot.curves.rend(); ++curve)
        out += line(axes, *curve) + "\n";
    for (std::size_t n = plot.curves.size(); n-- > 0;)
        if (plot.curves[n].values.size() <= most_marks)
            out += marks(axes, plot.curves[n], n == 0 ? plot.notes : std::vector<std::string>()) +
                   "\n";
    return out + "</svg>\n";
}

}  // namespace fluidcarve
