#pragma once

#include "graph/types/param.h"

#include <string>
#include <variant>

namespace fluidcarve {

/// A program that stands in a pipeline file.
struct Script {
    std::string text;
    Mark mark;  ///< where YAML has it begin

    /// Where a place of the text stands in the file: exactly, whatever YAML's style (plain, quoted, `|`, `>`), unless `${name}` or
    /// an escaped letter stands before it; then the last place before that. Ends and spaces are told by the letter before them.
    /// @param line, column  from 1, in bytes; 0: the script as a whole
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
    static Shape shape() { return {Shape::Kind::any_of, {}, {ParamTraits<double>::shape(), ParamTraits<Vec3>::shape()}}; }
    static std::optional<ScriptConstant> parse(const Value& value, ValueReader& reader);
    static std::string text(const ScriptConstant& value);
};

}  // namespace fluidcarve
