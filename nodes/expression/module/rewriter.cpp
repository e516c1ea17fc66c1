#include "nodes/expression/module/rewriter.h"

#include <memory>
#include <string>

namespace fluidcarve {
namespace {

namespace ast = openvdb::ax::ast;
namespace tokens = openvdb::ax::ast::tokens;

// The names contain a space, so that no program can use them.
std::string input_variable(const std::string& name) { return "input " + name; }
std::string constant_variable(const std::string& name) { return "constant " + name; }

/// Makes the rewritten tree of a program, see `rewritten`.
class Rewriter {
public:
    Rewriter(const Expression& expression, const ExpressionSource& source,
             openvdb::ax::Logger& logger)
        : expression_(expression), source_(source), logger_(logger) {}

    ast::Tree::ConstPtr tree(const std::vector<CompiledExpression::Read>& reads) {
        std::vector<ast::Statement*> statements;
        const auto& block = *source_.tree().child(0);
        // The program's variables live in their own scope and may have any name.
        auto body = std::make_unique<ast::Block>(block);
        for (std::size_t n = 0; n < block.children(); ++n)
            rewrite(*block.child(n), *const_cast<ast::Statement*>(body->child(n)));

        for (const auto& read : reads) {
            const auto type = read.vector ? tokens::VEC3F : tokens::FLOAT;
            declare(statements, type, input_variable(read.input),
                    new ast::Attribute(read.input, type));
        }
        for (const auto& [name, value] : expression_.constants) {
            const auto* const number = std::get_if<double>(&value);
            declare(statements, number ? tokens::FLOAT : tokens::VEC3F, constant_variable(name),
                    number ? literal(*number) : literal(std::get<Vec3>(value)));
        }
        for (std::size_t n = 0; n < casts_.size(); ++n)
            declare(statements, casts_[n], cast_variable(n), new ast::Value<std::int32_t>(0));
        statements.push_back(body.release());
        auto out = std::make_shared<ast::Tree>(new ast::Block(statements));
        logger_.setSourceTree(out);
        return out;
    }

private:
    static std::string cast_variable(std::size_t n) { return "cast " + std::to_string(n); }

    static void declare(std::vector<ast::Statement*>& to, tokens::CoreType type,
                        const std::string& name, ast::Expression* value) {
        to.push_back(new ast::DeclareLocal(type, new ast::Local(name), value));
    }

    static ast::Expression* literal(double value) {
        return new ast::Value<float>(static_cast<float>(value));
    }
    static ast::Expression* literal(const Vec3& value) {
        return new ast::ArrayPack(
            std::vector<ast::Expression*>{literal(value[0]), literal(value[1]), literal(value[2])});
    }

    void locate(const ast::Node& to, const ast::Node& from) {
        const auto [line, column] = source_.place(from);
        logger_.addNodeLocation(&to, {line, column});
    }

    /// Rewrites a node and its children.
    /// @param from  the node in the old tree
    /// @param to    its copy in the new tree, which is changed
    void rewrite(const ast::Node& from, ast::Node& to) {
        switch (from.nodetype()) {
            case ast::Node::AttributeNode:
                if (const auto& name = static_cast<const ast::Attribute&>(from).name();
                    name != expression_.output)
                    return put(from, to, new ast::Local(input_variable(name)));
                break;
            case ast::Node::ExternalVariableNode: {
                const auto& name = static_cast<const ast::ExternalVariable&>(from).name();
                const bool moment = name == frame_constant && !expression_.constants.contains(name);
                return put(
                    from, to,
                    new ast::Local(moment ? input_variable(frame_input) : constant_variable(name)));
            }
            case ast::Node::CastNode:
                return convert(from, to, *static_cast<const ast::Cast&>(from).expression(),
                               static_cast<const ast::Cast&>(from).type());
            case ast::Node::FunctionCallNode:
                if (static_cast<const ast::FunctionCall&>(from).name() == "pow" &&
                    from.children() == 2) {
                    locate(to, from);
                    rewrite(*from.child(0), *const_cast<ast::Node*>(to.child(0)));
                    const auto& exponent = static_cast<const ast::Expression&>(*from.child(1));
                    return convert(exponent, *const_cast<ast::Node*>(to.child(1)), exponent,
                                   tokens::DOUBLE);
                }
                break;
            case ast::Node::DeclareLocalNode:
                if (!static_cast<const ast::DeclareLocal&>(from).hasInit())
                    to.replacechild(1, new ast::Value<std::int32_t>(0));
                break;
            default: break;
        }
        locate(to, from);
        for (std::size_t n = 0; n < from.children(); ++n)
            if (const auto* const child = from.child(n))
                rewrite(*child, *const_cast<ast::Node*>(to.child(n)));
    }

    /// Replaces `to` by an assignment of `value` to a variable of the type.
    void convert(const ast::Node& from, ast::Node& to, const ast::Expression& value,
                 tokens::CoreType type) {
        casts_.push_back(type);
        auto* const copy = value.copy();
        put(from, to,
            new ast::AssignExpression(new ast::Local(cast_variable(casts_.size() - 1)), copy));
        rewrite(value, *copy);
    }

    void put(const ast::Node& from, ast::Node& to, ast::Expression* made) {
        to.replace(made);
        locate(*made, from);
    }

    const Expression& expression_;
    const ExpressionSource& source_;
    openvdb::ax::Logger& logger_;
    std::vector<tokens::CoreType> casts_;
};

}  // namespace

ast::Tree::ConstPtr rewritten(const Expression& expression, const ExpressionSource& source,
                              const std::vector<CompiledExpression::Read>& reads,
                              openvdb::ax::Logger& logger) {
    return Rewriter(expression, source, logger).tree(reads);
}

}  // namespace fluidcarve
