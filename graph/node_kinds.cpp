#include "graph/node_kinds.h"

#include "carve/base/find_or_null.h"

#include <cstddef>
#include <optional>
#include <string>
#include <typeindex>

namespace fluidcarve {
namespace {

class Kinds {
public:
    Kinds(const Document& document, const Registry& registry)
        : document_(document), registry_(registry), left_(document.nodes.fields.size()) {}

    const NodeType* of(const Value& node) {
        const auto* const name = node.find("type");
        const auto* const named = name ? registry_.node(name->value.text) : nullptr;
        // Cycles of connections are reported elsewhere.
        if (!named || named->kinds.empty() || left_ == 0) return named;
        --left_;
        for (const auto& [input, payload, type] : named->kinds)
            if (const auto* const connected = node.find(input);
                connected && payload_of(connected->value) == payload)
                return registry_.node(type);
        return named;
    }

private:
    /// The payload type of `node` or `node.output`; nothing if declarations do not tell it.
    std::optional<std::type_index> payload_of(const Value& reference) {
        if (reference.kind != Value::Kind::scalar) return std::nullopt;
        const auto dot = reference.text.find('.');
        const auto* const source = document_.nodes.find(reference.text.substr(0, dot));
        const auto* const type = source ? of(source->value) : nullptr;
        if (!type || type->outputs.empty()) return std::nullopt;
        if (dot == std::string::npos) return type->outputs.front().type;
        const auto* const found =
            find_or_null(type->outputs, reference.text.substr(dot + 1), &OutputSpec::name);
        return found ? std::optional(found->type) : std::nullopt;
    }

    const Document& document_;
    const Registry& registry_;
    std::size_t left_;  ///< nodes that may still be followed
};

}  // namespace

const NodeType* type_of(const Value& node, const Document& document, const Registry& registry) {
    return Kinds(document, registry).of(node);
}

}  // namespace fluidcarve
