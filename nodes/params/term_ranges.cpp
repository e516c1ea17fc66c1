#include "nodes/params/term_ranges.h"

#include "carve/field/active_range.h"
#include "graph/types/node_type.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace fluidcarve {
namespace {

using One = ParamTraits<Auto<Interval>>;
using Each = ParamTraits<std::vector<Auto<Interval>>>;

}  // namespace

Shape ParamTraits<TermRanges>::shape() {
    return {.kind = Shape::Kind::any_of, .parts = {One::shape(), Each::shape()}};
}

std::optional<TermRanges> ParamTraits<TermRanges>::parse(const Value& value, ValueReader& reader) {
    const auto is_number = [](const Value& item) {
        return item.kind == Value::Kind::scalar && item.text != "auto";
    };
    if (value.kind == Value::Kind::list && std::ranges::none_of(value.items, is_number)) {
        auto each = Each::parse(value, reader);
        return each ? std::optional(TermRanges{std::move(*each), false}) : std::nullopt;
    }
    if (value.kind != Value::Kind::list && value.text != "auto")
        return reader.unwanted(value, to_text(shape())), std::nullopt;
    const auto one = One::parse(value, reader);
    return one ? std::optional(TermRanges{{*one}, true}) : std::nullopt;
}

std::string ParamTraits<TermRanges>::text(const TermRanges& ranges) {
    return ranges.shared ? One::text(ranges.each.at(0)) : Each::text(ranges.each);
}

bool TermRanges::gathers() const {
    return std::ranges::any_of(each, [](const auto& range) { return !range; });
}

void TermRanges::check(std::size_t terms, NodeCheck& check) const {
    if (!shared && each.size() != terms)
        check.fault("range", fmt::format("states {} ranges for {} terms; state one per term",
                                         each.size(), terms));
}

std::shared_ptr<FrameRanges> ranges_of(const TermRanges& stated,
                                       const std::vector<Ref<FloatGrid>>& terms) {
    auto out = std::make_shared<FrameRanges>();
    for (std::size_t n = 0; n < terms.size(); ++n)
        out->each.push_back(stated.of(n) ? empty_range : active_range(*terms[n]));
    return out;
}

void GatheredRanges::add(const FrameRanges& frame) {
    found_.resize(frame.each.size(), empty_range);
    for (std::size_t n = 0; n < frame.each.size(); ++n)
        found_[n] = joined(found_[n], frame.each[n]);
}

Interval GatheredRanges::of(const TermRanges& stated, std::size_t term) const {
    const auto& range = stated.of(term);
    return range ? *range : found_.at(term);
}

}  // namespace fluidcarve
