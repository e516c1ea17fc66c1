#pragma once

#include "graph/types/param.h"
#include "nodes/payloads.h"

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace fluidcarve {

/// A program in OpenVDB AX, and all that it may name.
struct Expression {
    std::string code;
    std::vector<std::string> inputs;                              ///< grids, read as `@name`, or as `v@name` where they hold vectors
    std::map<std::string, std::variant<double, Vec3>> constants;  ///< `$name`, or `v$name`
    std::string output;                                           ///< what it writes: `@name`, a number
};

/// What is wrong with a program.
struct ExpressionFault {
    std::string field;  ///< "code", "inputs" or "params"
    int line = 0;       ///< of the code, from 1, as the column; 0: the field as a whole
    int column = 0;
    std::string message;
};

/// A program ready to run, from many threads at once.
struct CompiledExpression {
    /// The first place where an input is read, and as what.
    struct Read {
        std::string input;
        bool vector = false;
        int line = 0, column = 0;
    };
    std::vector<Read> reads;  ///< every input, once
    bool asks_where = false;  ///< depends on the voxel's place, not on its inputs alone
    virtual ~CompiledExpression() = default;
};

using NamedGrid = std::pair<std::string, openvdb::GridBase::ConstPtr>;

/// The functions of the module `expressions`.
///
/// The language is AX but for what would not end, crash the process, or differ from run to run: loops that don't count to a
/// stated end, casts to the type that a value has, whole numbers divided by what may be 0, indices that are no literals, random
/// numbers without a seed, printing, bit shifts, texts, matrices, and functions that look outside.
struct ExpressionModule {
    /// @return null, and what is wrong, all of it that can be known at once; else a program that ends and does not crash
    std::shared_ptr<const CompiledExpression> (*compile)(const Expression& expression, std::vector<ExpressionFault>& faults);
    /// Runs a program for each active voxel of `out`, which bears the output's name; once for a tile, unless the program asks
    /// where it is: then tiles become voxels where values differ.
    /// @param inputs  float and vector grids of the transform of `out`, each as the program reads it
    void (*run)(const CompiledExpression& program, const std::vector<NamedGrid>& inputs, FloatGrid& out);
};

}  // namespace fluidcarve
