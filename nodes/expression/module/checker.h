#pragma once

#include "nodes/expression/expression.h"
#include "nodes/expression/module/source.h"

#include <openvdb_ax/ast/AST.h>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace fluidcarve {

/// Checks a syntax tree for code that AX accepts, but that crashes, never ends, or silently reads
/// as zero (ExpressionModule).
class ExpressionChecker {
public:
    ExpressionChecker(const Expression& expression, const ExpressionSource& source,
                      std::vector<ExpressionFault>& faults)
        : expression_(expression), source_(source), faults_(faults) {}

    /// Finds all faults, but none that follows from another: a name that is wrong in many places is
    /// reported once.
    void check();
    /// Adds a warning for each input and constant that the program never reads. Call it if there
    /// are no faults.
    void warn_of_unread();

    /// As CompiledExpression::reads. Valid if there are no faults.
    const std::vector<CompiledExpression::Read>& reads() const { return reads_; }
    bool asks_where() const { return asks_where_; }

private:
    using Node = openvdb::ax::ast::Node;
    using Type = openvdb::ax::ast::tokens::CoreType;
    /// What is known of a value before compilation.
    struct KnownValue {
        Type type = Type::UNKNOWN;
        bool fraction = false;  ///< certainly of a floating-point type
    };

    void fault(const Node& node, const std::string& message);
    /// Reports a fault of a name, unless one of that name is reported.
    /// @param name  with its sign: "@d", "$gain", "speed", "length()"
    void name_fault(const Node& node, const std::string& name, const std::string& message);
    void note_read(const Node& node, const std::string& name, bool vector);
    bool reads(const std::string& name) const;
    /// Reports an output that is never written, and an input of its name.
    void check_names();

    KnownValue visit(const Node* node);
    KnownValue visit_children(const Node& node);
    KnownValue attribute(const openvdb::ax::ast::Attribute& node);
    KnownValue external(const openvdb::ax::ast::ExternalVariable& node);
    KnownValue local(const openvdb::ax::ast::Local& node);
    KnownValue cast(const openvdb::ax::ast::Cast& node);
    KnownValue unary(const openvdb::ax::ast::UnaryOperator& node);
    KnownValue binary(const openvdb::ax::ast::BinaryOperator& node);
    KnownValue assign(const openvdb::ax::ast::AssignExpression& node);
    KnownValue crement(const openvdb::ax::ast::Crement& node);
    KnownValue ternary(const openvdb::ax::ast::TernaryOperator& node);
    KnownValue pack(const openvdb::ax::ast::ArrayPack& node);
    KnownValue unpack(const openvdb::ax::ast::ArrayUnpack& node);
    KnownValue call(const openvdb::ax::ast::FunctionCall& node);
    KnownValue declare(const openvdb::ax::ast::DeclareLocal& node);
    KnownValue loop(const openvdb::ax::ast::Loop& node);

    static KnownValue known(Type type);
    static KnownValue joined(const KnownValue& a, const KnownValue& b);
    void require_offered(const Node& node, Type type);
    void require_divisor(const Node& divisor, const KnownValue& divided, const KnownValue& by);
    /// Reports a bit shift, and a division of whole numbers by what may be 0.
    /// @param node  of two sides, with an operation: a BinaryOperator or an AssignExpression
    template <class Operation>
    void require_operation(const Operation& node, const KnownValue& left, const KnownValue& right);
    /// Reports a fault if the target of an assignment is an input or a loop counter.
    void require_writable(const Node& target);
    /// The value of an integer literal or a constant; nothing for other expressions.
    std::optional<double> stated_number(const Node* node) const;
    /// Number of rounds of a loop; nothing if it does not count to a stated end.
    std::optional<double> rounds(const openvdb::ax::ast::Loop& node) const;

    const Expression& expression_;
    const ExpressionSource& source_;
    std::vector<ExpressionFault>& faults_;
    std::vector<CompiledExpression::Read> reads_;
    std::set<std::string> constants_read_;
    std::vector<std::map<std::string, Type>> scopes_{{}};
    std::set<std::string> counters_;  ///< counters of the enclosing loops
    double around_ = 1;               ///< product of the rounds of the enclosing loops
    double rounds_ = 0;               ///< rounds of all loops so far
    int depth_ = 0;
    bool writes_ = false;
    std::set<std::string> faulty_names_;  ///< names whose fault is reported
    bool asks_where_ = false;
};

}  // namespace fluidcarve
