#pragma once

#include "graph/types/param.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Two values, stated as `a` if they are equal, or as `[a, b]`.
template <class T>
struct OneOrTwo {
    std::array<T, 2> of{};
};

template <class T>
struct ParamTraits<OneOrTwo<T>> {
    static Shape shape() {
        return {.kind = Shape::Kind::any_of,
                .parts = {ParamTraits<T>::shape(), ParamTraits<std::vector<T>>::shape()}};
    }
    static std::optional<OneOrTwo<T>> parse(const Value& value, ValueReader& reader) {
        if (value.kind == Value::Kind::scalar) {
            const auto one = ParamTraits<T>::parse(value, reader);
            return one ? std::optional(OneOrTwo<T>{{*one, *one}}) : std::nullopt;
        }
        const auto both = ParamTraits<std::vector<T>>::parse(value, reader);
        if (!both) return std::nullopt;
        if (both->size() != 2)
            return reader.fault(value,
                                fmt::format("must have one number or two, not {}", both->size())),
                   std::nullopt;
        return OneOrTwo<T>{{(*both)[0], (*both)[1]}};
    }
    static std::string text(const OneOrTwo<T>& both) {
        return fmt::format("[{}, {}]", both.of[0], both.of[1]);
    }
};

}  // namespace fluidcarve
