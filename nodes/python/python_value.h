#pragma once

#include "graph/types/param.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A value that a pipeline hands to a script: a number, true or false, a text, or a list of these.
struct PythonValue {
    bool list = false;
    std::vector<std::string> items;  ///< as written; one, if it is no list

    /// The value that the script gets: texts that look like a number, true or false become these.
    nlohmann::json json() const;
};

template <>
struct ParamTraits<PythonValue> {
    static Shape shape();
    static std::optional<PythonValue> parse(const Value& value, ValueReader& reader);
    static std::string text(const PythonValue& value);
};

}  // namespace fluidcarve
