#pragma once

#include "graph/text/problem.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// One value of a pipeline file as written, with its place. The declared type of the parameter
/// decides how a scalar is read; its form and quotes do not.
struct Value {
    enum class Kind {
        null,
        scalar,
        list,
        map,
        unresolved,  ///< has a fault that is already reported
    };
    struct Field;

    Kind kind = Kind::null;
    Mark mark;
    std::string text;           ///< scalar
    std::vector<Value> items;   ///< list
    std::vector<Field> fields;  ///< map, in file order, names unique

    static Value scalar(Mark mark, std::string text);
    /// A map without fields.
    static Value map(Mark mark);

    const Field* find(std::string_view name) const;
    Field* find(std::string_view name);

    /// Short form for messages: the text in quotes, "a list", "a map", "nothing".
    std::string describe() const;

    /// Bytes of all texts in it: scalars and names.
    std::size_t text_bytes() const;
};

struct Value::Field {
    std::string name;
    Mark mark;  ///< place of the name
    Value value;
};

}  // namespace fluidcarve
