#include "nodes/expression/module/syntax.h"

namespace fluidcarve {

bool is_fraction(CoreType type) {
    return type == tokens::FLOAT || type == tokens::DOUBLE || type == tokens::VEC3F ||
           type == tokens::VEC3D;
}

CoreType component_of(CoreType type) {
    switch (type) {
        case tokens::VEC3F: return tokens::FLOAT;
        case tokens::VEC3D: return tokens::DOUBLE;
        case tokens::VEC3I: return tokens::INT32;
        default: return tokens::UNKNOWN;
    }
}

std::optional<std::uint64_t> whole_literal(const ast::Node* node) {
    if (!node) return std::nullopt;
    switch (node->nodetype()) {
        case ast::Node::ValueInt16Node:
            return as<ast::Value<std::int16_t>>(*node).asContainerType();
        case ast::Node::ValueInt32Node:
            return as<ast::Value<std::int32_t>>(*node).asContainerType();
        case ast::Node::ValueInt64Node:
            return as<ast::Value<std::int64_t>>(*node).asContainerType();
        default: return std::nullopt;
    }
}

bool is_local(const ast::Node* node, const std::string& name) {
    return node && node->nodetype() == ast::Node::LocalNode && as<ast::Local>(*node).name() == name;
}

}  // namespace fluidcarve
