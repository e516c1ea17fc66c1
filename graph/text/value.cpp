#include "graph/text/value.h"

#include "carve/base/find_or_null.h"
#include "carve/base/one_line.h"

#include <fmt/format.h>

#include <utility>

namespace fluidcarve {

Value Value::scalar(Mark mark, std::string text) {
    return {Kind::scalar, std::move(mark), std::move(text), {}, {}};
}

Value Value::map(Mark mark) { return {Kind::map, std::move(mark), {}, {}, {}}; }

const Value::Field* Value::find(std::string_view name) const {
    return find_or_null(fields, name, &Field::name);
}

Value::Field* Value::find(std::string_view name) {
    return const_cast<Field*>(std::as_const(*this).find(name));
}

std::size_t Value::text_bytes() const {
    auto out = text.size();
    for (const auto& item : items) out += item.text_bytes();
    for (const auto& field : fields) out += field.name.size() + field.value.text_bytes();
    return out;
}

std::string Value::describe() const {
    switch (kind) {
        case Kind::null: return "nothing";
        case Kind::scalar: return fmt::format("'{}'", cut_short(text));
        case Kind::list:
            return items.size() == 1 ? "a list of one" : fmt::format("a list of {}", items.size());
        case Kind::unresolved: return "something unresolved";
        case Kind::map: break;
    }
    return "a map";
}

}  // namespace fluidcarve
