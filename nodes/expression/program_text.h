#pragma once

#include "graph/types/param.h"

#include <optional>
#include <string>
#include <variant>

namespace fluidcarve {

/// A program in a pipeline file.
struct ProgramText {
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
struct ParamTraits<ProgramText> {
    static Shape shape() { return {Shape::Kind::text}; }
    static std::optional<ProgramText> parse(const Value& value, ValueReader& reader);
    static std::string text(const ProgramText& program) { return program.text; }
};

/// A number, or a vector of three.
using ProgramConstant = std::variant<double, Vec3>;

template <>
struct ParamTraits<ProgramConstant> {
    static Shape shape() {
        return {.kind = Shape::Kind::any_of,
                .parts = {ParamTraits<double>::shape(), ParamTraits<Vec3>::shape()}};
    }
    static std::optional<ProgramConstant> parse(const Value& value, ValueReader& reader);
    static std::string text(const ProgramConstant& value);
};

}  // namespace fluidcarve
