#include "nodes/expression/module/checker.h"
#include "nodes/expression/module/syntax.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace fluidcarve {

namespace {

constexpr double most_rounds = 10'000;  ///< maximum rounds of all loops, per voxel

/// Maximum absolute value of a counter, so that it never overflows.
constexpr double furthest = 1e9;

}  // namespace

std::optional<double> ExpressionChecker::stated_number(const Node* node) const {
    if (!node) return std::nullopt;
    if (node->nodetype() == Node::UnaryOperatorNode &&
        as<ast::UnaryOperator>(*node).operation() == tokens::MINUS) {
        const auto value = stated_number(as<ast::UnaryOperator>(*node).expression());
        return value ? std::optional(-*value) : std::nullopt;
    }
    if (node->nodetype() == Node::ExternalVariableNode) {
        const auto found = expression_.constants.find(as<ast::ExternalVariable>(*node).name());
        if (found != expression_.constants.end())
            if (const auto* const number = std::get_if<double>(&found->second)) return *number;
        return std::nullopt;
    }
    const auto whole = whole_literal(node);
    return whole ? std::optional(static_cast<double>(*whole)) : std::nullopt;
}

std::optional<double> ExpressionChecker::rounds(const ast::Loop& node) const {
    if (node.loopType() != tokens::FOR || !node.hasInit() || !node.hasIter() || !node.condition())
        return std::nullopt;
    if (node.initial()->nodetype() != Node::DeclareLocalNode ||
        node.condition()->nodetype() != Node::BinaryOperatorNode)
        return std::nullopt;
    const auto& initial = as<ast::DeclareLocal>(*node.initial());
    const auto& condition = as<ast::BinaryOperator>(*node.condition());
    const auto& counter = initial.local()->name();
    const auto first = initial.hasInit() ? stated_number(initial.init()) : 0.0,
               end = stated_number(condition.rhs());
    if ((initial.type() != tokens::INT32 && initial.type() != tokens::INT64) ||
        !is_local(condition.lhs(), counter))
        return std::nullopt;

    std::optional<double> step;
    if (node.iteration()->nodetype() == Node::CrementNode) {
        const auto& crement = as<ast::Crement>(*node.iteration());
        if (is_local(crement.expression(), counter)) step = crement.increment() ? 1 : -1;
    } else if (node.iteration()->nodetype() == Node::AssignExpressionNode) {
        const auto& assign = as<ast::AssignExpression>(*node.iteration());
        const auto by = whole_literal(assign.rhs());
        if (is_local(assign.lhs(), counter) && by && assign.operation() == tokens::PLUS)
            step = static_cast<double>(*by);
        if (is_local(assign.lhs(), counter) && by && assign.operation() == tokens::MINUS)
            step = -static_cast<double>(*by);
    }
    if (!first || !end || !step || *step == 0 || std::abs(*first) > furthest ||
        std::abs(*end) > furthest || std::abs(*step) > furthest)
        return std::nullopt;

    const auto operation = condition.operation();
    const bool rises = operation == tokens::LESSTHAN || operation == tokens::LESSTHANOREQUAL,
               falls = operation == tokens::MORETHAN || operation == tokens::MORETHANOREQUAL;
    const bool last_too =
        operation == tokens::LESSTHANOREQUAL || operation == tokens::MORETHANOREQUAL;
    if ((!rises && !falls) || (rises && *step < 0) || (falls && *step > 0)) return std::nullopt;
    const double steps = (*end - std::trunc(*first)) / *step;
    return std::max(0.0, last_too ? std::floor(steps) + 1 : std::ceil(steps));
}

ExpressionChecker::KnownValue ExpressionChecker::loop(const ast::Loop& node) {
    const auto count = rounds(node);
    if (!count)
        fault(node, fmt::format("'{}' may never end; count to a stated end, as in for (int i = 0; "
                                "i < 10; ++i), and leave it early by break",
                                tokens::loopNameFromToken(node.loopType())));
    scopes_.emplace_back();
    visit(node.initial());
    visit(node.condition());
    if (!count) {
        visit(node.body());
        scopes_.pop_back();
        return {};
    }
    const auto& counter = as<ast::DeclareLocal>(*node.initial()).local()->name();
    if (!counters_.insert(counter).second)
        fault(
            node,
            fmt::format(
                "'{}' already counts a loop around this one; give this loop's counter another name",
                counter));
    const auto around = around_;
    around_ *= *count;
    rounds_ += around_;
    if (rounds_ > most_rounds)
        fault(node, fmt::format("the loops run {:.0f} times for each voxel; {:.0f} are the most",
                                rounds_, most_rounds));
    visit(node.body());
    around_ = around;
    counters_.erase(counter);
    scopes_.pop_back();
    return {};
}

}  // namespace fluidcarve
