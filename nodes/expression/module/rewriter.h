#pragma once

#include "nodes/expression/expression.h"
#include "nodes/expression/module/source.h"

#include <openvdb_ax/ast/AST.h>
#include <openvdb_ax/compiler/Logger.h>

#include <vector>

namespace fluidcarve {

/// Rewrites a checked program to avoid faults of AX:
/// - Inputs are copied to variables at the start: AX takes an attribute that is a function's
///   argument for written, and would run the program over that grid too. Constants are also copied,
///   so that the optimiser sees their values.
/// - A cast becomes an assignment to a variable of its type: a cast of a value to its own type
///   crashes.
/// - The exponent of pow is converted to double: with an integer exponent AX calls a function that
///   does not exist.
/// - A variable without a value becomes 0.
/// @param logger  receives the tree and the places of its nodes, for the compiler's messages
openvdb::ax::ast::Tree::ConstPtr rewritten(const Expression& expression,
                                           const ExpressionSource& source,
                                           const std::vector<CompiledExpression::Read>& reads,
                                           openvdb::ax::Logger& logger);

}  // namespace fluidcarve
