#pragma once

#include "carve/volume/volume.h"
#include "graph/types/param.h"

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace fluidcarve {

/// A program in OpenVDB AX, and the names that it may use.
struct Expression {
    std::string code;
    std::vector<std::string> inputs;  ///< names of grids, read as `@name`, or `v@name` for vectors
    /// Read as `$name`, or `v$name` for vectors.
    std::map<std::string, std::variant<double, Vec3>> constants;
    std::string output;  ///< name of the grid that it writes as `@name`, a number
};

/// The moment: `@Frame` is the frame's number, `@Time` is (frame - 1) / `$fps` in seconds. A
/// program may read them as numbers where no input has the name. `$F` is `@Frame` where no constant
/// has the name.
inline constexpr auto frame_input = "Frame", time_input = "Time", frame_constant = "F",
                      rate_constant = "fps";

/// A fault of a program.
struct ExpressionFault {
    std::string field;  ///< "code", "inputs" or "params"
    int line = 0;       ///< line of the code, from 1; 0: the field as a whole
    int column = 0;     ///< from 1, in bytes
    std::string message;
    bool warning = false;  ///< the program can still run
};

/// A program ready to run, from many threads at once.
struct CompiledExpression {
    /// The first place where an input or a moment is read.
    struct Read {
        std::string input;
        bool vector = false;  ///< read as a vector, `v@name`
        int line = 0, column = 0;
    };
    std::vector<Read> reads;  ///< one per name
    bool asks_where = false;  ///< whether the program uses the voxel's position
    virtual ~CompiledExpression() = default;
};

using NamedGrid = std::pair<std::string, openvdb::GridBase::ConstPtr>;

/// The functions of the module `expressions`.
///
/// The language is AX without everything that might not end, crash the process, or differ between
/// runs: loops without a stated end, casts of a value to its own type, division of a whole number
/// by a value that may be 0, indices that are not literals, random numbers without a seed,
/// printing, bit shifts, texts, matrices, and functions that read anything but their arguments and
/// the voxel's position.
struct ExpressionModule {
    static constexpr auto package = "libopenvdb-ax-dev";
    /// Compiles a program. The compiled program ends and does not crash.
    /// @param faults  receives all faults that can be found at once, but none that follows from
    ///   another; if there are none, the warnings
    /// @return null if there are faults other than warnings
    std::shared_ptr<const CompiledExpression> (*compile)(const Expression& expression,
                                                         std::vector<ExpressionFault>& faults);
    /// Runs a program for each active voxel of `out`; once per tile, unless the program uses the
    /// voxel's position: tiles then become voxels where values differ.
    /// @param inputs  float and vector grids with the transform of `out`, each of the type that the
    ///   program reads
    /// @param out     named like the program's output
    void (*run)(const CompiledExpression& program, const std::vector<NamedGrid>& inputs,
                FloatGrid& out);
};

}  // namespace fluidcarve
