#include "nodes/warp/amount.h"

#include "graph/text/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace fluidcarve {

template <>
struct ChoiceNames<WarpAmount::Along> {
    static constexpr std::array names = {std::pair{"w", WarpAmount::Along::w}, std::pair{"time", WarpAmount::Along::time}};
};

namespace {

using Length = WarpAmount::Length;

std::string text_of(const Length& length) { return fmt::format("{}{}", length.value, length.percent ? "%" : ""); }

std::optional<Length> parse_length(const Value& value, ValueReader& reader) {
    const bool percent = value.kind == Value::Kind::scalar && value.text.ends_with('%');
    auto number = value;
    if (percent) number.text.pop_back();
    const auto got = reader.number(number, false);
    return got ? std::optional(Length{*got, percent}) : std::nullopt;
}

/// Reads `[[place, value], ...]`, places rising.
/// @param parse  reads a value
template <class Point, class Parse>
std::optional<std::vector<Point>> parse_points(const Value::Field& field, bool along_w, ValueReader& reader, const Parse& parse) {
    const auto wanted = fmt::format("a list of points in '{}', [[place, {}], ...]", field.name, field.name == "at" ? "amount" : "share");
    const auto& list = field.value;
    if (list.kind != Value::Kind::list) return reader.unwanted(list, wanted), std::nullopt;
    if (list.items.empty()) return reader.fault(list, fmt::format("has no points in '{}': a curve needs at least one", field.name)), std::nullopt;
    std::vector<Point> out;
    for (const auto& item : list.items) {
        if (item.kind != Value::Kind::list || item.items.size() != 2) return reader.unwanted(item, wanted), std::nullopt;
        const auto place = reader.number(item.items[0], false);
        const auto got = parse(item.items[1]);
        if (!place || !got) return std::nullopt;
        if (along_w && (*place < 0 || *place > 1))
            return reader.fault(item, fmt::format("has a point at {} of the way along w, which goes from 0, the first plane, to 1, the last one", *place)),
                   std::nullopt;
        if (!out.empty() && *place < out.back().at + WarpAmount::least_step)
            return reader.fault(item, fmt::format("has a point at {} behind one at {}: points must rise", *place, out.back().at)), std::nullopt;
        out.push_back({*place, *got});
    }
    return out;
}

std::optional<WarpAmount> parse_curve(const Value& value, ValueReader& reader) {
    WarpAmount out;
    for (const auto& field : value.fields)
        if (field.name != "along" && field.name != "at" && field.name != "over")
            return reader.fault(field.value, fmt::format("has no field '{}'; it has along, at and over", field.name)), std::nullopt;
    const auto* const along = value.find("along");
    const auto* const at = value.find("at");
    const auto* const over = value.find("over");
    if (!along || !at)
        return reader.fault(value, fmt::format("lacks '{}': a curve is {{along: w or time, at: [[place, amount], ...]}}", along ? "at" : "along")),
               std::nullopt;
    const auto dimension = ParamTraits<WarpAmount::Along>::parse(along->value, reader);
    if (!dimension) return std::nullopt;
    out.along = *dimension;
    const bool along_w = out.along == WarpAmount::Along::w;
    auto points = parse_points<WarpAmount::Point>(*at, along_w, reader, [&](const Value& amount) { return parse_length(amount, reader); });
    if (!points) return std::nullopt;
    out.points = std::move(*points);
    if (!over) return out;
    auto shares = parse_points<WarpAmount::Share>(*over, !along_w, reader, [&](const Value& share) { return reader.number(share, false); });
    if (!shares) return std::nullopt;
    out.shares = std::move(*shares);
    return out;
}

/// A curve's value at a place. @param value  of a point
template <class Point, class Get>
double linear(const std::vector<Point>& points, double place, const Get& value) {
    const auto above = std::ranges::lower_bound(points, place, {}, &Point::at);
    if (above == points.end()) return value(points.back());
    if (above == points.begin()) return value(points.front());
    const auto below = above - 1;
    return value(*below) + (place - below->at) / (above->at - below->at) * (value(*above) - value(*below));
}

}  // namespace

bool WarpAmount::nothing() const {
    if (!varies()) return whole.value == 0;
    const auto none = [](const std::vector<Point>& curve) { return std::ranges::all_of(curve, [](const Point& point) { return point.amount.value == 0; }); };
    if (!sections.empty()) return std::ranges::all_of(sections, none, &Section::points);
    return none(points) || (!shares.empty() && std::ranges::all_of(shares, [](const Share& share) { return share.share == 0; }));
}

double WarpAmount::at(double w, double frame, int size) const {
    if (!varies()) return whole.of(size);
    const auto length = [size](const Point& point) { return point.amount.of(size); };
    if (!sections.empty()) return linear(sections, frame, [&](const Section& section) { return linear(section.points, w, length); });
    const bool along_w = along == Along::w;
    const double amount = linear(points, along_w ? w : frame, length);
    return shares.empty() ? amount : amount * linear(shares, along_w ? frame : w, [](const Share& share) { return share.share; });
}

Shape ParamTraits<WarpAmount>::shape() {
    // A percentage is no number in YAML.
    const Shape length{Shape::Kind::any_of, {}, {{Shape::Kind::number, {}, {}}, {Shape::Kind::text, {}, {}}}};
    const Shape point{Shape::Kind::list, {}, {length}}, share{Shape::Kind::list, {}, {{Shape::Kind::number, {}, {}}}};
    Shape curve{Shape::Kind::map, {}, {}};
    curve.fields = {{"along", ParamTraits<WarpAmount::Along>::shape()}, {"at", {Shape::Kind::list, {}, {point}}}, {"over", {Shape::Kind::list, {}, {share}}}};
    return {Shape::Kind::any_of, {}, {length.of[0], length.of[1], curve}};
}

std::optional<WarpAmount> ParamTraits<WarpAmount>::parse(const Value& value, ValueReader& reader) {
    if (value.kind == Value::Kind::map) return parse_curve(value, reader);
    if (value.kind != Value::Kind::scalar) {
        reader.unwanted(value, "a number of vertices, a percentage such as -10%, or {along: w or time, at: [[place, amount], ...]}");
        return std::nullopt;
    }
    const auto length = parse_length(value, reader);
    if (!length) return std::nullopt;
    WarpAmount out;
    out.whole = *length;
    return out;
}

std::string ParamTraits<WarpAmount>::text(const WarpAmount& amount) {
    if (!amount.varies()) return text_of(amount.whole);
    std::vector<std::string> points, shares;
    for (const auto& point : amount.points) points.push_back(fmt::format("[{}, {}]", point.at, text_of(point.amount)));
    for (const auto& share : amount.shares) shares.push_back(fmt::format("[{}, {}]", share.at, share.share));
    return fmt::format("{{along: {}, at: [{}]{}}}", ParamTraits<WarpAmount::Along>::text(amount.along), fmt::join(points, ", "),
                       shares.empty() ? std::string() : fmt::format(", over: [{}]", fmt::join(shares, ", ")));
}

}  // namespace fluidcarve
