#pragma once

#include "graph/text/problem.h"

#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// One value of a pipeline file as written, with its place. What a scalar means is decided by the declaration
/// that it meets (a parameter's type), never by its looks or its quotes.
struct Value {
    enum class Kind {
        null,
        scalar,
        list,
        map,
        unresolved,  ///< stood for something that is wrong and has been reported
    };
    struct Field;

    Kind kind = Kind::null;
    Mark mark;
    std::string text;           ///< scalar
    std::vector<Value> items;   ///< list
    std::vector<Field> fields;  ///< map, in file order, names unique

    const Field* find(std::string_view name) const;
    Field* find(std::string_view name);

    /// Short form for messages: 'text', a list, a map, nothing.
    std::string describe() const;
};

struct Value::Field {
    std::string name;
    Mark mark;  ///< of the name
    Value value;
};

}  // namespace fluidcarve
