#include "graph/document_names.h"

namespace fluidcarve {

std::vector<std::string> names(const Value& map) {
    std::vector<std::string> out;
    for (const auto& field : map.fields) out.push_back(field.name);
    return out;
}

}  // namespace fluidcarve
