#pragma once

#include "nodes/expression/expression.h"

#include <openvdb_ax/ast/AST.h>
#include <openvdb_ax/compiler/Logger.h>

#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Converts a message of AX to a fault. The message ends with its place: "unexpected SEMICOLON
/// 1:15".
ExpressionFault fault_of(const std::string& message);

/// The syntax tree of a program, with the places of its nodes.
class ExpressionSource {
public:
    /// Parses a program. If the text is not valid AX, adds a fault and has no tree.
    ExpressionSource(const std::string& code, std::vector<ExpressionFault>& faults);

    explicit operator bool() const { return tree_ != nullptr; }
    const openvdb::ax::ast::Tree& tree() const { return *tree_; }
    /// Line and column, from 1.
    std::pair<int, int> place(const openvdb::ax::ast::Node& node) const;

private:
    mutable std::vector<std::string> messages_;
    /// The only source of places: it prints them at the end of a message.
    mutable openvdb::ax::Logger logger_;
    openvdb::ax::ast::Tree::ConstPtr tree_;
};

}  // namespace fluidcarve
