#pragma once

#include "nodes/expression/expression.h"

#include <openvdb_ax/ast/AST.h>
#include <openvdb_ax/compiler/Logger.h>

#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// A fault from a message of AX, which ends in its place: "unexpected SEMICOLON 1:15".
ExpressionFault fault_of(const std::string& message);

/// A program's text as a syntax tree whose nodes know their places.
class ExpressionSource {
public:
    /// Without a tree, and a fault more, if the text is no AX.
    ExpressionSource(const std::string& code, std::vector<ExpressionFault>& faults);

    explicit operator bool() const { return tree_ != nullptr; }
    const openvdb::ax::ast::Tree& tree() const { return *tree_; }
    /// Line and column, from 1.
    std::pair<int, int> place(const openvdb::ax::ast::Node& node) const;

private:
    mutable std::vector<std::string> messages_;
    mutable openvdb::ax::Logger logger_;  ///< alone knows the places, and tells them only as a message's end
    openvdb::ax::ast::Tree::ConstPtr tree_;
};

}  // namespace fluidcarve
