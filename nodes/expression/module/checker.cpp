#include "nodes/expression/module/checker.h"

#include "carve/base/words.h"
#include "nodes/expression/module/syntax.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <map>

namespace fluidcarve {

namespace {

constexpr int deepest = 100;  ///< maximum depth of a syntax tree: AX walks it by recursion

/// Type of a function's result.
enum class Gives {
    fraction,
    as_given,  ///< a fraction if any argument is one
    whole,
};

/// The allowed functions: they read only their arguments and the voxel's position, and have no
/// state.
std::map<std::string, Gives> all_functions() {
    std::map<std::string, Gives> out;
    const auto add = [&](Gives gives, std::initializer_list<const char*> names) {
        for (const auto* const name : names) out.emplace(name, gives);
    };
    add(Gives::fraction, {"acos",    "asin",         "atan",
                          "atan2",   "cbrt",         "ceil",
                          "cos",     "cosh",         "curlsimplexnoise",
                          "degrees", "exp",          "exp2",
                          "floor",   "getvoxelpws",  "hsvtorgb",
                          "length",  "log",          "log10",
                          "log2",    "normalize",    "radians",
                          "rand",    "rand32",       "rgbtohsv",
                          "round",   "simplexnoise", "sin",
                          "sinh",    "sqrt",         "tan",
                          "tanh"});
    add(Gives::as_given, {"abs", "clamp", "cross", "dot", "euclideanmod", "fit", "floormod",
                          "lengthsq", "lerp", "max", "min", "pow", "truncatemod"});
    add(Gives::whole, {"getcoord", "getcoordx", "getcoordy", "getcoordz", "isfinite", "isinf",
                       "isnan", "sign", "signbit"});
    return out;
}
const std::map<std::string, Gives>& functions() {
    static const auto all = all_functions();
    return all;
}

/// Thrown to stop the check of a tree that is too deep.
struct TooDeep {};

}  // namespace

void ExpressionChecker::check() {
    try {
        visit(&source_.tree());
    } catch (const TooDeep&) {
        return;
    }
    check_names();
}

void ExpressionChecker::fault(const Node& node, const std::string& message) {
    const auto [line, column] = source_.place(node);
    faults_.push_back({"code", line, column, message});
}

void ExpressionChecker::name_fault(const Node& node, const std::string& name,
                                   const std::string& message) {
    if (faulty_names_.insert(name).second) fault(node, message);
}

void ExpressionChecker::check_names() {
    if (!writes_)
        faults_.push_back({"code", 0, 0, fmt::format("never writes @{}", expression_.output)});
    if (std::ranges::find(expression_.inputs, expression_.output) != expression_.inputs.end())
        faults_.push_back(
            {"inputs", 0, 0,
             fmt::format("can't have the name '{}': it is the output's name", expression_.output)});
}

void ExpressionChecker::warn_of_unread() {
    const auto warn = [&](const char* field, const std::string& name) {
        faults_.push_back(
            {field, 0, 0, fmt::format("has '{}', which the program never reads", name), true});
    };
    for (const auto& input : expression_.inputs)
        if (!reads(input)) warn("inputs", input);
    for (const auto& [name, value] : expression_.constants)
        if (!constants_read_.contains(name) && !(name == rate_constant && reads(time_input)))
            warn("params", name);
}

ExpressionChecker::KnownValue ExpressionChecker::known(Type type) {
    return {type, is_fraction(type)};
}

/// The result of an operation on two values.
ExpressionChecker::KnownValue ExpressionChecker::joined(const KnownValue& a, const KnownValue& b) {
    const bool scalars = a.type <= tokens::DOUBLE && b.type <= tokens::DOUBLE &&
                         a.type >= tokens::INT32 && b.type >= tokens::INT32;
    if (scalars || (a.type == b.type && component_of(a.type) != tokens::UNKNOWN))
        return known(std::max(a.type, b.type));
    return {Type::UNKNOWN, a.fraction || b.fraction};
}

void ExpressionChecker::require_offered(const Node& node, Type type) {
    constexpr std::array offered{tokens::BOOL,   tokens::INT32, tokens::INT64, tokens::FLOAT,
                                 tokens::DOUBLE, tokens::VEC3I, tokens::VEC3F, tokens::VEC3D};
    if (std::ranges::find(offered, type) == offered.end())
        fault(node, fmt::format("the type '{}' is not supported; use float, vec3f, int, bool, "
                                "double, vec3d, vec3i or int64",
                                tokens::typeStringFromToken(type)));
}

void ExpressionChecker::require_divisor(const Node& divisor, const KnownValue& divided,
                                        const KnownValue& by) {
    if (divided.fraction || by.fraction || whole_literal(&divisor).value_or(0) > 0) return;
    fault(divisor,
          "a whole number can't be divided by one that may be 0; make one of them a fraction: 1.0f "
          "* a / b");
}

template <class Operation>
void ExpressionChecker::require_operation(const Operation& node, const KnownValue& left,
                                          const KnownValue& right) {
    const auto operation = node.operation();
    if (operation == tokens::SHIFTLEFT || operation == tokens::SHIFTRIGHT)
        fault(node, "bit shifts are not supported");
    if (operation == tokens::DIVIDE || operation == tokens::MODULO)
        require_divisor(*node.rhs(), left, right);
}

void ExpressionChecker::require_writable(const Node& target) {
    const Node* node = &target;
    if (node->nodetype() == Node::ArrayUnpackNode) node = as<ast::ArrayUnpack>(*node).expression();
    if (node->nodetype() == Node::AttributeNode) {
        const auto& attribute = as<ast::Attribute>(*node);
        if (attribute.name() != expression_.output)
            name_fault(target, "@" + attribute.name(),
                       fmt::format("'@{}' can't be written to; write to @{}", attribute.name(),
                                   expression_.output));
        writes_ = true;
    } else if (node->nodetype() == Node::LocalNode &&
               counters_.contains(as<ast::Local>(*node).name())) {
        fault(target, fmt::format("'{}' counts a loop and can't be changed inside it",
                                  as<ast::Local>(*node).name()));
    }
}

ExpressionChecker::KnownValue ExpressionChecker::visit(const Node* node) {
    if (!node) return {};
    if (++depth_ > deepest) {
        fault(*node, fmt::format("nested more than {} levels deep", deepest));
        throw TooDeep{};
    }
    KnownValue out;
    switch (node->nodetype()) {
        case Node::AttributeNode: out = attribute(as<ast::Attribute>(*node)); break;
        case Node::ExternalVariableNode: out = external(as<ast::ExternalVariable>(*node)); break;
        case Node::LocalNode: out = local(as<ast::Local>(*node)); break;
        case Node::CastNode: out = cast(as<ast::Cast>(*node)); break;
        case Node::UnaryOperatorNode: out = unary(as<ast::UnaryOperator>(*node)); break;
        case Node::BinaryOperatorNode: out = binary(as<ast::BinaryOperator>(*node)); break;
        case Node::AssignExpressionNode: out = assign(as<ast::AssignExpression>(*node)); break;
        case Node::CrementNode: out = crement(as<ast::Crement>(*node)); break;
        case Node::TernaryOperatorNode: out = ternary(as<ast::TernaryOperator>(*node)); break;
        case Node::ArrayPackNode: out = pack(as<ast::ArrayPack>(*node)); break;
        case Node::ArrayUnpackNode: out = unpack(as<ast::ArrayUnpack>(*node)); break;
        case Node::FunctionCallNode: out = call(as<ast::FunctionCall>(*node)); break;
        case Node::DeclareLocalNode: out = declare(as<ast::DeclareLocal>(*node)); break;
        case Node::LoopNode: out = loop(as<ast::Loop>(*node)); break;
        case Node::BlockNode:
            scopes_.emplace_back();
            visit_children(*node);
            scopes_.pop_back();
            break;
        case Node::ValueBoolNode: out = known(tokens::BOOL); break;
        case Node::ValueInt16Node: out = known(tokens::INT16); break;
        case Node::ValueInt32Node: out = known(tokens::INT32); break;
        case Node::ValueInt64Node: out = known(tokens::INT64); break;
        case Node::ValueFloatNode: out = known(tokens::FLOAT); break;
        case Node::ValueDoubleNode: out = known(tokens::DOUBLE); break;
        case Node::ValueStrNode: fault(*node, "strings are not supported"); break;
        default: out = visit_children(*node); break;
    }
    --depth_;
    return out;
}

/// @return what is known of the last child
ExpressionChecker::KnownValue ExpressionChecker::visit_children(const Node& node) {
    KnownValue out;
    for (std::size_t n = 0; n < node.children(); ++n) out = visit(node.child(n));
    return out;
}

ExpressionChecker::KnownValue ExpressionChecker::attribute(const ast::Attribute& node) {
    const auto type = node.type();
    const auto written = node.tokenname();
    if (node.name() == expression_.output) {
        if (type != tokens::FLOAT)
            name_fault(node, "@" + node.name(),
                       fmt::format("@{} is a number, not '{}'", node.name(), written));
        return known(tokens::FLOAT);
    }
    const auto& inputs = expression_.inputs;
    const bool input = std::ranges::find(inputs, node.name()) != inputs.end();
    const bool moment = !input && (node.name() == frame_input || node.name() == time_input);
    if (moment && type != tokens::FLOAT) {
        name_fault(node, "@" + node.name(),
                   fmt::format("'{0}' is a number: write @{0}", node.name()));
        return known(type);
    }
    if (!input && !moment) {
        name_fault(
            node, "@" + node.name(),
            fmt::format("'@{}' is no input{}", node.name(), did_you_mean(node.name(), inputs)));
        return {type, true};
    }
    if (type != tokens::FLOAT && type != tokens::VEC3F)
        name_fault(
            node, "@" + node.name(),
            fmt::format(
                "an input can't be read as '{}'; write @{} (numbers, masks) or v@{} (vectors)",
                written, node.name(), node.name()));
    note_read(node, node.name(), type == tokens::VEC3F);
    return known(type);
}

void ExpressionChecker::note_read(const Node& node, const std::string& name, bool vector) {
    const auto found =
        std::ranges::find_if(reads_, [&](const auto& read) { return read.input == name; });
    if (found == reads_.end()) {
        const auto [line, column] = source_.place(node);
        reads_.push_back({name, vector, line, column});
    } else if (found->vector != vector) {
        name_fault(node, "@" + name,
                   fmt::format("'{0}' is read as @{0} and as v@{0}; it can't be both", name));
    }
}

bool ExpressionChecker::reads(const std::string& name) const {
    return std::ranges::any_of(reads_, [&](const auto& read) { return read.input == name; });
}

ExpressionChecker::KnownValue ExpressionChecker::external(const ast::ExternalVariable& node) {
    const auto found = expression_.constants.find(node.name());
    if (found == expression_.constants.end() && node.name() == frame_constant &&
        node.type() == tokens::FLOAT) {
        note_read(node, frame_input, false);
        return known(tokens::FLOAT);
    }
    if (found == expression_.constants.end()) {
        std::vector<std::string> names;
        for (const auto& [name, value] : expression_.constants) names.push_back(name);
        name_fault(node, "$" + node.name(),
                   fmt::format("'${}' is not among the params{}", node.name(),
                               did_you_mean(node.name(), names)));
        return {node.type(), true};
    }
    constants_read_.insert(node.name());
    const bool vector = std::holds_alternative<Vec3>(found->second);
    if (node.type() != (vector ? tokens::VEC3F : tokens::FLOAT))
        name_fault(node, "$" + node.name(),
                   fmt::format("'{0}' is a {1}: write {2}${0}", node.name(),
                               vector ? "vector" : "number", vector ? "v" : ""));
    return known(node.type());
}

ExpressionChecker::KnownValue ExpressionChecker::local(const ast::Local& node) {
    std::vector<std::string> declared;
    for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope) {
        if (const auto found = scope->find(node.name()); found != scope->end())
            return known(found->second);
        for (const auto& [name, type] : *scope) declared.push_back(name);
    }
    const auto& name = node.name();
    const auto& inputs = expression_.inputs;
    std::string remedy = did_you_mean(name, declared);
    if (name == expression_.output) remedy = fmt::format("; write @{} for the output", name);
    else if (std::ranges::find(inputs, name) != inputs.end())
        remedy = fmt::format("; write @{0} or v@{0} for the input", name);
    else if (expression_.constants.contains(name))
        remedy = fmt::format("; write ${0} or v${0} for the param", name);
    name_fault(node, name, fmt::format("there is no variable '{}'{}", name, remedy));
    return {Type::UNKNOWN, true};
}

ExpressionChecker::KnownValue ExpressionChecker::cast(const ast::Cast& node) {
    const auto value = visit(node.expression());
    require_offered(node, node.type());
    if (value.type == node.type())
        fault(node, fmt::format("the cast is redundant: the value is {} already; leave it out",
                                node.typestr()));
    return known(node.type());
}

ExpressionChecker::KnownValue ExpressionChecker::unary(const ast::UnaryOperator& node) {
    const auto value = visit(node.expression());
    if (node.operation() == tokens::NOT) return known(tokens::BOOL);
    // The operand is not a fraction if it is a bool.
    return value.type == tokens::BOOL ? KnownValue{} : value;
}

ExpressionChecker::KnownValue ExpressionChecker::binary(const ast::BinaryOperator& node) {
    const auto left = visit(node.lhs()), right = visit(node.rhs());
    require_operation(node, left, right);
    const auto kind = tokens::operatorType(node.operation());
    if (kind == tokens::LOGICAL || kind == tokens::RELATIONAL) return known(tokens::BOOL);
    return joined(left, right);
}

ExpressionChecker::KnownValue ExpressionChecker::assign(const ast::AssignExpression& node) {
    const auto right = visit(node.rhs());
    require_writable(*node.lhs());
    // The target of an assignment does not count as read. require_writable has reported its faults.
    const auto* const target = node.lhs();
    const auto left =
        target->nodetype() == Node::AttributeNode ? known(as<ast::Attribute>(*target).type())
        : target->nodetype() == Node::ArrayUnpackNode &&
                as<ast::ArrayUnpack>(*target).expression()->nodetype() == Node::AttributeNode
            ? known(tokens::FLOAT)
            : visit(target);
    if (target->nodetype() == Node::AttributeNode &&
        as<ast::Attribute>(*target).name() == expression_.output && left.type != tokens::FLOAT)
        name_fault(node, "@" + expression_.output,
                   fmt::format("@{} is a number, not '{}'", expression_.output,
                               as<ast::Attribute>(*target).tokenname()));
    // The parser keeps `a /= b` as an assignment with a division.
    require_operation(node, left, right);
    return left;
}

ExpressionChecker::KnownValue ExpressionChecker::crement(const ast::Crement& node) {
    require_writable(*node.expression());
    const auto* const target = node.expression();
    return target->nodetype() == Node::AttributeNode ? known(as<ast::Attribute>(*target).type())
                                                     : visit(target);
}

ExpressionChecker::KnownValue ExpressionChecker::ternary(const ast::TernaryOperator& node) {
    const auto condition = visit(node.condition());
    const auto yes = node.hasTrue() ? visit(node.trueBranch()) : condition,
               no = visit(node.falseBranch());
    return yes.type == no.type ? KnownValue{yes.type, yes.fraction && no.fraction}
                               : joined(yes, no);
}

ExpressionChecker::KnownValue ExpressionChecker::pack(const ast::ArrayPack& node) {
    if (node.size() != 3)
        fault(node, fmt::format("vectors have 3 components, not {}", node.size()));
    KnownValue out;
    for (std::size_t n = 0; n < node.size(); ++n) {
        const auto each = visit(node.child(n));
        out.fraction = out.fraction || each.fraction;
    }
    return out;
}

ExpressionChecker::KnownValue ExpressionChecker::unpack(const ast::ArrayUnpack& node) {
    const auto value = visit(node.expression());
    const auto index = whole_literal(node.component0());
    if (node.isMatrixIndex()) fault(node, "matrices are not supported");
    else if (!index || *index > 2)
        fault(node, "a component is .x, .y, .z or [0], [1], [2]; other indices are not supported");
    return {component_of(value.type), value.fraction};
}

ExpressionChecker::KnownValue ExpressionChecker::call(const ast::FunctionCall& node) {
    std::vector<KnownValue> arguments;
    for (std::size_t n = 0; n < node.numArgs(); ++n) arguments.push_back(visit(node.child(n)));
    const auto& name = node.name();
    const auto found = functions().find(name);
    if (found == functions().end()) {
        std::vector<std::string> names;
        for (const auto& [each, gives] : functions()) names.push_back(each);
        name_fault(node, name + "()",
                   fmt::format("there is no function '{}'{}", name, did_you_mean(name, names)));
        return {Type::UNKNOWN, true};
    }
    if (name.starts_with("rand") && arguments.empty())
        fault(node,
              fmt::format(
                  "{0} needs a seed, as in {0}(@density): without one no two runs are the same",
                  name));
    if (name.starts_with("get")) asks_where_ = true;
    if (name.ends_with("mod") && arguments.size() == 2)
        require_divisor(*node.child(1), arguments[0], arguments[1]);
    const bool fraction =
        std::ranges::any_of(arguments, [](const KnownValue& each) { return each.fraction; });
    return {Type::UNKNOWN,
            found->second == Gives::fraction || (found->second == Gives::as_given && fraction)};
}

ExpressionChecker::KnownValue ExpressionChecker::declare(const ast::DeclareLocal& node) {
    visit(node.init());
    require_offered(node, node.type());
    scopes_.back()[node.local()->name()] = node.type();
    return known(node.type());
}

}  // namespace fluidcarve
