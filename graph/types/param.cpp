#include "graph/types/param.h"

#include "carve/base/numbers.h"
#include "carve/base/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <climits>
#include <cmath>

namespace fluidcarve {
namespace {

/// Parses a list of N numbers and checks each against the reader's range.
template <std::size_t N>
std::optional<std::array<double, N>> numbers(const Value& value, ValueReader& reader,
                                             const char* wanted) {
    if (value.kind != Value::Kind::list || value.items.size() != N)
        return reader.unwanted(value, wanted), std::nullopt;
    std::array<double, N> out{};
    bool good = true;
    for (std::size_t n = 0; n < N; ++n) {
        const auto number = reader.number(value.items[n], false);
        good = good && number;
        out[n] = number.value_or(0);
    }
    return good ? std::optional(out) : std::nullopt;
}

template <class P>
std::optional<P> read_path(const Value& value, ValueReader& reader, std::string folder) {
    if (value.kind != Value::Kind::scalar || value.text.empty())
        return reader.unwanted(value, "a path"), std::nullopt;
    if (value.text.size() >= PATH_MAX)
        return reader.fault(value, fmt::format("has {} bytes; a path has at most {}",
                                               value.text.size(), PATH_MAX - 1)),
               std::nullopt;
    P path(value.text, std::move(folder));
    if (path.bad_token().empty()) return path;
    const auto best = nearest(path.bad_token(), {"####", "%04d", "$F4", "<frame04>", "<frame>"});
    const auto remedy =
        best.empty() ? "use ####, %04d, $F4 or <frame>" : fmt::format("did you mean '{}'?", best);
    return reader.fault(value, fmt::format("has '{}', which is no frame token; {}",
                                           path.bad_token(), remedy)),
           std::nullopt;
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
    const auto out = number_of_word<double>(text);
    return out && std::isfinite(*out) ? out : std::nullopt;
}

std::string to_text(const Range& range) {
    const bool low = std::isfinite(range.min), high = std::isfinite(range.max);
    return low && high ? fmt::format("from {} to {}", range.min, range.max)
           : low       ? fmt::format("at least {}", range.min)
           : high      ? fmt::format("at most {}", range.max)
                       : "";
}

std::string to_text(Unit unit) {
    switch (unit) {
        case Unit::none: return "";
        case Unit::world: return "world units";
        case Unit::voxels: return "voxels";
        case Unit::vertices: return "vertices";
        case Unit::seams: return "seams";
        case Unit::frames: return "frames";
        case Unit::pixels: return "pixels";
    }
    return "";
}

std::string to_text(const Shape& shape) {
    switch (shape.kind) {
        case Shape::Kind::boolean: return "true or false";
        case Shape::Kind::integer: return "a whole number";
        case Shape::Kind::number: return "a number";
        case Shape::Kind::text: return "a text";
        case Shape::Kind::input_path:
        case Shape::Kind::output_path: return "a path";
        case Shape::Kind::count: return "a whole number of seams or a percentage such as -10%";
        case Shape::Kind::vector: return "[x, y, z]";
        case Shape::Kind::interval: return "[low, high]";
        case Shape::Kind::choice: return fmt::format("one of {}", fmt::join(shape.choices, ", "));
        case Shape::Kind::list: return "a list, each " + to_text(shape.parts.at(0));
        case Shape::Kind::map: {
            if (!shape.parts.empty()) return "a map, each " + to_text(shape.parts[0]);
            std::string fields;
            for (const auto& [name, field] : shape.fields)
                fields += (fields.empty() ? "" : ", ") + name + ": " + to_text(field);
            return "{" + fields + "}";
        }
        case Shape::Kind::automatic: return "auto or " + to_text(shape.parts.at(0));
        case Shape::Kind::any_of: break;
    }
    std::string out;
    for (const auto& each : shape.parts) out += (out.empty() ? "" : ", or ") + to_text(each);
    return out;
}

void ValueReader::unwanted(const Value& value, const std::string& form) {
    fault(value, fmt::format("must be {}, not {}", form, value.describe()));
}

void ValueReader::fault(const Value& value, const std::string& message) {
    if (value.kind != Value::Kind::unresolved) add(problems_, value.mark, what_ + " " + message);
}

std::optional<double> ValueReader::number(const Value& value, bool whole) {
    const char* const wanted = whole ? "a whole number" : "a number";
    const auto parsed = value.kind == Value::Kind::scalar ? parse_number(value.text) : std::nullopt;
    if (!parsed || (whole && *parsed != std::trunc(*parsed)))
        return unwanted(value, wanted), std::nullopt;
    const double out = *parsed;
    constexpr double most = std::numeric_limits<int>::max();
    if (whole && std::abs(out) > most)
        return unwanted(value, fmt::format("a whole number from {} to {}", -most, most)),
               std::nullopt;
    if (out < range_.min || out > range_.max) {
        return fault(value, fmt::format("must be {}, not {}", to_text(range_), value.text)),
               std::nullopt;
    }
    return out;
}

std::optional<bool> ParamTraits<bool>::parse(const Value& value, ValueReader& reader) {
    if (value.kind == Value::Kind::scalar && value.text == "true") return true;
    if (value.kind == Value::Kind::scalar && value.text == "false") return false;
    return reader.unwanted(value, "true or false"), std::nullopt;
}

std::optional<int> ParamTraits<int>::parse(const Value& value, ValueReader& reader) {
    const auto number = reader.number(value, true);
    return number ? std::optional(static_cast<int>(*number)) : std::nullopt;
}

std::string ParamTraits<double>::text(double value) { return fmt::format("{}", value); }
std::string ParamTraits<float>::text(float value) { return fmt::format("{}", value); }

std::optional<float> ParamTraits<float>::parse(const Value& value, ValueReader& reader) {
    const auto number = reader.number(value, false);
    if (number && std::abs(*number) > std::numeric_limits<float>::max())
        return reader.unwanted(value, "a number up to 3.4e38"), std::nullopt;
    return number ? std::optional(static_cast<float>(*number)) : std::nullopt;
}

std::optional<std::string> ParamTraits<std::string>::parse(const Value& value,
                                                           ValueReader& reader) {
    if (value.kind == Value::Kind::scalar) return value.text;
    return reader.unwanted(value, "a text"), std::nullopt;
}

std::optional<Vec3> ParamTraits<Vec3>::parse(const Value& value, ValueReader& reader) {
    return numbers<3>(value, reader, "[x, y, z]");
}

std::string ParamTraits<Vec3>::text(const Vec3& value) {
    return fmt::format("[{}, {}, {}]", value[0], value[1], value[2]);
}

std::optional<Interval> ParamTraits<Interval>::parse(const Value& value, ValueReader& reader) {
    const auto pair = numbers<2>(value, reader, "[low, high]");
    if (!pair) return std::nullopt;
    if ((*pair)[0] > (*pair)[1])
        return reader.fault(value, fmt::format("has its low end {} above its high end {}",
                                               (*pair)[0], (*pair)[1])),
               std::nullopt;
    return Interval{(*pair)[0], (*pair)[1]};
}

std::string ParamTraits<Interval>::text(const Interval& value) {
    return fmt::format("[{}, {}]", value.low, value.high);
}

std::optional<Count> ParamTraits<Count>::parse(const Value& value, ValueReader& reader) {
    const bool percent = value.text.ends_with('%');
    const auto number =
        value.kind == Value::Kind::scalar
            ? parse_number(std::string_view(value.text).substr(0, value.text.size() - percent))
            : std::nullopt;
    if (!number || (!percent && *number != std::trunc(*number)) || std::abs(*number) > 1e6)
        return reader.unwanted(value, to_text(shape())), std::nullopt;
    return Count{*number, percent};
}

std::string ParamTraits<Count>::text(const Count& value) { return to_text(value); }

std::optional<InputPath> ParamTraits<InputPath>::parse(const Value& value, ValueReader& reader) {
    const auto beside = read_path<InputPath>(
        value, reader, value.mark.source ? value.mark.source->folder : std::string());
    if (!beside || beside->exists()) return beside;
    InputPath here(value.text);
    return here.exists() ? here : beside;
}

std::optional<OutputPath> ParamTraits<OutputPath>::parse(const Value& value, ValueReader& reader) {
    return read_path<OutputPath>(value, reader, {});
}

std::optional<WrittenPath> ParamTraits<WrittenPath>::parse(const Value& value,
                                                           ValueReader& reader) {
    return read_path<WrittenPath>(value, reader, {});
}

}  // namespace fluidcarve
