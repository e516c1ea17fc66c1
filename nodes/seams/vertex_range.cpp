#include "nodes/seams/vertex_range.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

namespace fluidcarve {

Window VertexRange::of(int size) const {
    const auto vertex = [&](double stated) { return static_cast<int>(std::lround(shares ? stated / 100 * (size - 1) : stated)); };
    return {vertex(first), vertex(last)};
}

std::optional<Window> VertexRange::vertices() const { return shares ? std::nullopt : std::optional(of(0)); }

Shape ParamTraits<VertexRange>::shape() {
    return {Shape::Kind::any_of, {}, {{Shape::Kind::interval, {}, {}}, {Shape::Kind::list, {}, {{Shape::Kind::text, {}, {}}}}}};
}

std::optional<VertexRange> ParamTraits<VertexRange>::parse(const Value& value, ValueReader& reader) {
    const std::string form = "[first, last], whole vertices or shares of them such as [0%, 50%]";
    if (value.kind != Value::Kind::list || value.items.size() != 2) return reader.unwanted(value, form), std::nullopt;
    const auto wanted = [&] {
        return reader.fault(value, fmt::format("must be {}, not [{}, {}]", form, value.items[0].text, value.items[1].text)), std::nullopt;
    };
    std::array<double, 2> ends{};
    const bool shares = value.items[0].text.ends_with('%');
    for (std::size_t n = 0; n < 2; ++n) {
        const std::string_view text = value.items[n].text;
        if (value.items[n].kind != Value::Kind::scalar || text.ends_with('%') != shares) return wanted();
        const auto number = parse_number(text.substr(0, text.size() - shares));
        if (!number || (!shares && *number != std::trunc(*number))) return wanted();
        if (*number < 0 || *number > (shares ? 100 : 1e6))
            return reader.fault(value, fmt::format("must be {}, not {}", shares ? "from 0% to 100%" : "from 0 to 1e6", text)), std::nullopt;
        ends[n] = *number;
    }
    if (ends[0] > ends[1])
        return reader.fault(value, fmt::format("has its first vertex {} above its last one {}", value.items[0].text, value.items[1].text)), std::nullopt;
    return VertexRange{ends[0], ends[1], shares};
}

std::string ParamTraits<VertexRange>::text(const VertexRange& range) {
    const auto* const unit = range.shares ? "%" : "";
    return fmt::format("[{}{}, {}{}]", range.first, unit, range.last, unit);
}

std::optional<Window> vertices_of(const Auto<VertexRange>& range) { return range ? range->vertices() : std::nullopt; }

std::optional<std::string> pair_fault(const Window& window, const VertexRange& window_stated, const Window& pair, const VertexRange& pair_stated, bool share) {
    const int shared = share ? 1 : 0;
    if (pair.first > window.last - shared) return std::nullopt;
    return fmt::format("pair_window {} {} window {}; it must begin {}", ParamTraits<VertexRange>::text(pair_stated),
                       pair.last < window.first + shared ? "lies below" : "overlaps", ParamTraits<VertexRange>::text(window_stated),
                       share ? fmt::format("at vertex {} or above", window.last) : fmt::format("above vertex {}", window.last));
}

}  // namespace fluidcarve
