#include "nodes/params/param_forms.h"

#include "carve/seam/seams.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

/// An amount of a warp, which need not be whole.
std::optional<Count> parse_amount(const Value& value, ValueReader& reader) {
    const bool percent = value.kind == Value::Kind::scalar && value.text.ends_with('%');
    auto number = value;
    if (percent) number.text.pop_back();
    const auto got = reader.number(number, false);
    return got ? std::optional(Count{*got, percent}) : std::nullopt;
}

/// Reads `[[place, value], ...]`, places rising.
/// @param parse  reads a value
template <class Point, class Parse>
std::optional<std::vector<Point>> parse_points(const Value::Field& field, bool along_w,
                                               ValueReader& reader, const Parse& parse) {
    const auto wanted = fmt::format("a list of points in '{}', [[place, {}], ...]", field.name,
                                    field.name == "at" ? "amount" : "share");
    const auto& list = field.value;
    if (list.kind != Value::Kind::list) return reader.unwanted(list, wanted), std::nullopt;
    if (list.items.empty())
        return reader.fault(list, fmt::format("has no points in '{}': a curve needs at least one",
                                              field.name)),
               std::nullopt;
    std::vector<Point> out;
    for (const auto& item : list.items) {
        if (item.kind != Value::Kind::list || item.items.size() != 2)
            return reader.unwanted(item, wanted), std::nullopt;
        const auto place = reader.number(item.items[0], false);
        const auto got = parse(item.items[1]);
        if (!place || !got) return std::nullopt;
        if (along_w && (*place < 0 || *place > 1))
            return reader.fault(item,
                                fmt::format("has a point at {} of the way along w, which goes from "
                                            "0, the first plane, to 1, the last one",
                                            *place)),
                   std::nullopt;
        if (!out.empty() && *place < out.back().at + WarpAmount::least_step)
            return reader.fault(item,
                                fmt::format("has a point at {} behind one at {}: points must rise",
                                            *place, out.back().at)),
                   std::nullopt;
        out.push_back({*place, *got});
    }
    return out;
}

std::optional<WarpAmount> parse_curve(const Value& value, ValueReader& reader) {
    WarpAmount out;
    for (const auto& field : value.fields)
        if (field.name != "along" && field.name != "at" && field.name != "over")
            return reader.fault(
                       field.value,
                       fmt::format("has no field '{}'; it has along, at and over", field.name)),
                   std::nullopt;
    const auto* const along = value.find("along");
    const auto* const at = value.find("at");
    const auto* const over = value.find("over");
    if (!along || !at)
        return reader.fault(
                   value,
                   fmt::format(
                       "lacks '{}': a curve is {{along: w or time, at: [[place, amount], ...]}}",
                       along ? "at" : "along")),
               std::nullopt;
    const auto dimension = ParamTraits<WarpAmount::Along>::parse(along->value, reader);
    if (!dimension) return std::nullopt;
    out.along = *dimension;
    const bool along_w = out.along == WarpAmount::Along::w;
    auto points = parse_points<WarpAmount::Point>(
        *at, along_w, reader, [&](const Value& amount) { return parse_amount(amount, reader); });
    if (!points) return std::nullopt;
    out.points = std::move(*points);
    if (!over) return out;
    auto factors = parse_points<WarpAmount::Factor>(
        *over, !along_w, reader, [&](const Value& factor) { return reader.number(factor, false); });
    if (!factors) return std::nullopt;
    out.factors = std::move(*factors);
    return out;
}

/// `[low, high]`, or a list of percentages, which are not numbers in YAML.
Shape pair_or_percent() {
    return {.kind = Shape::Kind::any_of,
            .parts = {{Shape::Kind::interval},
                      {.kind = Shape::Kind::list, .parts = {{Shape::Kind::text}}}}};
}

void unwanted_pair(const Value& value, ValueReader& reader, const std::string& form) {
    reader.fault(value, fmt::format("must be {}, not [{}, {}]", form, value.items[0].text,
                                    value.items[1].text));
}

struct Pair {
    std::array<double, 2> ends{};
    bool percent = false;
};

/// Two numbers, or two percentages. @param form  the wanted form, for messages
std::optional<Pair> parse_pair(const Value& value, ValueReader& reader, const std::string& form) {
    if (value.kind != Value::Kind::list || value.items.size() != 2)
        return reader.unwanted(value, form), std::nullopt;
    Pair out;
    out.percent = value.items[0].text.ends_with('%');
    for (std::size_t n = 0; n < 2; ++n) {
        const std::string_view text = value.items[n].text;
        const bool matches =
            value.items[n].kind == Value::Kind::scalar && text.ends_with('%') == out.percent;
        const auto number =
            matches ? parse_number(text.substr(0, text.size() - out.percent)) : std::nullopt;
        if (!number) return unwanted_pair(value, reader, form), std::nullopt;
        out.ends[n] = *number;
    }
    return out;
}

}  // namespace

Shape ParamTraits<Anchor>::shape() {
    return {.kind = Shape::Kind::any_of,
            .parts = {{.kind = Shape::Kind::choice, .choices = {"low", "middle", "high"}},
                      {Shape::Kind::integer}}};
}

std::optional<Anchor> ParamTraits<Anchor>::parse(const Value& value, ValueReader& reader) {
    for (const auto at : {Anchor::At::low, Anchor::At::middle, Anchor::At::high})
        if (value.kind == Value::Kind::scalar && value.text == text({at, 0})) return Anchor{at, 0};
    if (const auto vertex = reader.number(value, true))
        return Anchor{Anchor::At::vertex, static_cast<int>(*vertex)};
    return std::nullopt;
}

std::string ParamTraits<Anchor>::text(const Anchor& anchor) { return to_text(anchor); }

Shape ParamTraits<RigExtent>::shape() { return pair_or_percent(); }

std::optional<RigExtent> ParamTraits<RigExtent>::parse(const Value& value, ValueReader& reader) {
    const std::string form = "[low, high], world units or shares such as [-150%, 150%]";
    const auto pair = parse_pair(value, reader, form);
    if (!pair) return std::nullopt;
    const auto& [ends, percent] = *pair;
    if (ends[0] > ends[1])
        return reader.fault(value, fmt::format("has its low end {} above its high end {}",
                                               value.items[0].text, value.items[1].text)),
               std::nullopt;
    return RigExtent{ends[0], ends[1], percent};
}

std::string ParamTraits<RigExtent>::text(const RigExtent& extent) { return to_text(extent); }

Shape ParamTraits<VertexRange>::shape() { return pair_or_percent(); }

std::optional<VertexRange> ParamTraits<VertexRange>::parse(const Value& value,
                                                           ValueReader& reader) {
    const std::string form = "[first, last], whole vertices or shares of them such as [0%, 50%]";
    const auto pair = parse_pair(value, reader, form);
    if (!pair) return std::nullopt;
    const auto& [ends, percent] = *pair;
    for (std::size_t n = 0; n < 2; ++n) {
        if (!percent && ends[n] != std::trunc(ends[n]))
            return unwanted_pair(value, reader, form), std::nullopt;
        if (ends[n] < 0 || ends[n] > (percent ? 100 : 1e6))
            return reader.fault(value, fmt::format("must be {}, not {}",
                                                   percent ? "from 0% to 100%" : "from 0 to 1e6",
                                                   value.items[n].text)),
                   std::nullopt;
    }
    if (ends[0] > ends[1])
        return reader.fault(value, fmt::format("has its first vertex {} above its last one {}",
                                               value.items[0].text, value.items[1].text)),
               std::nullopt;
    return VertexRange{ends[0], ends[1], percent};
}

std::string ParamTraits<VertexRange>::text(const VertexRange& range) { return to_text(range); }

Shape ParamTraits<PairRanges>::shape() {
    auto out = ParamTraits<VertexRange>::shape();
    out.parts.push_back({.kind = Shape::Kind::list, .parts = {ParamTraits<VertexRange>::shape()}});
    return out;
}

std::optional<PairRanges> ParamTraits<PairRanges>::parse(const Value& value, ValueReader& reader) {
    using Range = ParamTraits<VertexRange>;
    const bool two = value.kind == Value::Kind::list && value.items.size() == 2 &&
                     std::ranges::all_of(value.items, [](const Value& item) {
                         return item.kind == Value::Kind::list;
                     });
    if (!two) {
        const auto above = Range::parse(value, reader);
        return above ? std::optional(PairRanges{*above, {}}) : std::nullopt;
    }
    const auto below = Range::parse(value.items[0], reader),
               above = Range::parse(value.items[1], reader);
    return below && above ? std::optional(PairRanges{*above, below}) : std::nullopt;
}

std::string ParamTraits<PairRanges>::text(const PairRanges& ranges) { return to_text(ranges); }

Shape ParamTraits<WarpAmount>::shape() {
    // A percentage is not a number in YAML.
    const Shape length{.kind = Shape::Kind::any_of,
                       .parts = {{Shape::Kind::number}, {Shape::Kind::text}}};
    const Shape point{.kind = Shape::Kind::list, .parts = {length}},
        factor{.kind = Shape::Kind::list, .parts = {{Shape::Kind::number}}};
    Shape curve{Shape::Kind::map};
    curve.fields = {{"along", ParamTraits<WarpAmount::Along>::shape()},
                    {"at", {.kind = Shape::Kind::list, .parts = {point}}},
                    {"over", {.kind = Shape::Kind::list, .parts = {factor}}}};
    return {.kind = Shape::Kind::any_of, .parts = {length.parts[0], length.parts[1], curve}};
}

std::optional<WarpAmount> ParamTraits<WarpAmount>::parse(const Value& value, ValueReader& reader) {
    if (value.kind == Value::Kind::map) return parse_curve(value, reader);
    if (value.kind != Value::Kind::scalar) {
        reader.unwanted(value,
                        "a number of vertices, a percentage such as -10%, or {along: w or time, "
                        "at: [[place, amount], ...]}");
        return std::nullopt;
    }
    const auto amount = parse_amount(value, reader);
    if (!amount) return std::nullopt;
    WarpAmount out;
    out.constant = *amount;
    return out;
}

std::string ParamTraits<WarpAmount>::text(const WarpAmount& amount) { return to_text(amount); }

}  // namespace fluidcarve
