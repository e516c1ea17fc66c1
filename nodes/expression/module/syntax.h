#pragma once

#include <openvdb_ax/ast/AST.h>

#include <cstdint>
#include <optional>
#include <string>

namespace fluidcarve {

namespace ast = openvdb::ax::ast;
namespace tokens = openvdb::ax::ast::tokens;
using tokens::CoreType;

bool is_fraction(CoreType type);

CoreType component_of(CoreType type);

template <class T>
const T& as(const ast::Node& node) {
    return static_cast<const T&>(node);
}

std::optional<std::uint64_t> whole_literal(const ast::Node* node);

bool is_local(const ast::Node* node, const std::string& name);

}  // namespace fluidcarve
