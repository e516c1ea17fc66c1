#pragma once

#include "nodes/expression/expression.h"
#include "nodes/expression/module/source.h"

#include <openvdb_ax/ast/AST.h>
#include <openvdb_ax/compiler/Logger.h>

#include <vector>

namespace fluidcarve {

/// A checked program as AX is to have it:
/// - inputs and constants are copied to variables at its start. An attribute that is an argument counts as written, and the
///   whole program would run over that grid as well; constants are then seen by the optimiser;
/// - a cast is an assignment to a variable of its type, which converts alike: of a value that has the type, a cast crashes;
/// - so is the exponent of pow, to a double: a whole one makes it call what is not there;
/// - a variable without a value is 0.
/// @param logger  told the tree and the places of its nodes, for the compiler's messages
openvdb::ax::ast::Tree::ConstPtr rewritten(const Expression& expression, const ExpressionSource& source, const std::vector<CompiledExpression::Read>& reads,
                                           openvdb::ax::Logger& logger);

}  // namespace fluidcarve
