#include "carve/warp/amount.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace fluidcarve {

namespace {

/// A curve's value at a place. @param value  of a point
template <class Point, class Get>
double linear(const std::vector<Point>& points, double place, const Get& value) {
    const auto above = std::ranges::lower_bound(points, place, {}, &Point::at);
    if (above == points.end()) return value(points.back());
    if (above == points.begin()) return value(points.front());
    const auto below = above - 1;
    return value(*below) +
           (place - below->at) / (above->at - below->at) * (value(*above) - value(*below));
}

}  // namespace

bool WarpAmount::nothing() const {
    if (!varies()) return constant.value == 0;
    const auto none = [](const std::vector<Point>& curve) {
        return std::ranges::all_of(curve,
                                   [](const Point& point) { return point.amount.value == 0; });
    };
    if (!sections.empty()) return std::ranges::all_of(sections, none, &Section::points);
    return none(points) ||
           (!factors.empty() &&
            std::ranges::all_of(factors, [](const Factor& each) { return each.factor == 0; }));
}

WarpAmount WarpAmount::in_vertices(double size) const {
    auto out = *this;
    const auto count = [size](Count& amount) { amount = {amount.exactly(size), false}; };
    count(out.constant);
    for (auto& point : out.points) count(point.amount);
    for (auto& section : out.sections)
        for (auto& point : section.points) count(point.amount);
    return out;
}

bool WarpAmount::has_percent() const {
    const auto percent = [](const Point& point) { return point.amount.percent; };
    return constant.percent || std::ranges::any_of(points, percent) ||
           std::ranges::any_of(sections, [&](const Section& section) {
               return std::ranges::any_of(section.points, percent);
           });
}

double WarpAmount::at(double w, double frame, int size) const {
    if (!varies()) return constant.exactly(size);
    const auto each = [size](const Point& point) { return point.amount.exactly(size); };
    if (!sections.empty())
        return linear(sections, frame,
                      [&](const Section& section) { return linear(section.points, w, each); });
    const bool along_w = along == Along::w;
    const double amount = linear(points, along_w ? w : frame, each);
    return factors.empty() ? amount
                           : amount * linear(factors, along_w ? frame : w,
                                             [](const Factor& each) { return each.factor; });
}

std::string to_text(const WarpAmount& amount) {
    if (!amount.varies()) return to_text(amount.constant);
    std::vector<std::string> points, factors;
    for (const auto& point : amount.points)
        points.push_back(fmt::format("[{}, {}]", point.at, to_text(point.amount)));
    for (const auto& each : amount.factors)
        factors.push_back(fmt::format("[{}, {}]", each.at, each.factor));
    return fmt::format(
        "{{along: {}, at: [{}]{}}}", choice_text(amount.along), fmt::join(points, ", "),
        factors.empty() ? std::string() : fmt::format(", over: [{}]", fmt::join(factors, ", ")));
}

}  // namespace fluidcarve
