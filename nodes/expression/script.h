#pragma once

#include "graph/types/param.h"

#include <string>
#include <variant>

namespace fluidcarve {

/// A program in a pipeline file.
struct Script {
    std::string text;
    Mark mark;  ///< place of the YAML scalar

    /// Converts a place in the program to a place in the file, for all YAML styles (plain, quoted,
    /// `|`, `>`). The result is exact unless `${name}` or an escaped character comes before it;
    /// then it is the last exact place before that. For a space it is the place after the
    /// preceding character.
    /// @param line, column  in the program, from 1, in bytes; line 0: the program as a whole
    Mark place(int line, int column) const;
};

template <>
struct ParamTraits<Script> {
    static Shape shape() { return {Shape::Kind::text, {}, {}}; }
    static std::optional<Script> parse(const Value& value, ValueReader& reader);
    static std::string text(const Script& script) { return script.text; }
};

/// A number, or a vector of three.
using ScriptConstant = std::variant<double, Vec3>;

template <>
struct ParamTraits<ScriptConstant> {
    static Shape shape() {
        return {
            Shape::Kind::any_of, {}, {ParamTraits<double>::shape(), ParamTraits<Vec3>::shape()}};
    }
    static std::optional<ScriptConstant> parse(const Value& value, ValueReader& reader);
    static std::string text(const ScriptConstant& value);
};

}  // namespace fluidcarve
