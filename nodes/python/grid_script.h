#pragma once

#include "carve/volume/volume.h"
#include "nodes/python/python_script.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

extern const char* const python_inputs_doc;

/// Parameters of a node whose function takes grids.
struct GridScriptParams : PythonParams {
    Auto<int> halo;
};

/// A node whose function takes grids and returns something for each voxel. A script may also have
/// the functions `add`, which sees all frames in order, and `finish`, whose results are arguments
/// of the function in each frame.
class GridScript {
public:
    using Inputs = std::vector<std::pair<std::string, Ref<AnyGrid>>>;

    static void check(const PythonParams& params, const std::string& function, NodeCheck& check);
    /// Calls `add` of the script. @throws as numbers
    void add(const GridScriptParams& params, const Inputs& inputs, Context& context);
    /// Calls `finish` of the script, if it has one.
    void finish(const GridScriptParams& params, Context& context);

    /// Calls a function that returns a number for each voxel.
    /// @param least  smallest allowed result, or -infinity
    /// @return a grid called like the function, with the voxels that are active in any input; 0
    ///   elsewhere
    /// @throws Failure naming the script and the voxel, if a result is below `least` or not finite;
    ///   else as SharedGrids and call_script
    FloatGrid::Ptr numbers(const GridScriptParams& params, const std::string& function, float least,
                           const Inputs& inputs, Context& context) const;
    /// Calls a function that returns true or false for each voxel. @throws as numbers
    MaskGrid::Ptr states(const GridScriptParams& params, const std::string& function,
                         const Inputs& inputs, Context& context) const;

private:
    std::unique_ptr<Worker> worker_;  ///< whose script sees all frames
    std::string found_;               ///< result of `finish`, as the worker wrote it
};

/// The base of nodes with a GridScript; each adds an output, `check` and `run`.
struct GridScriptNode {
    using Params = GridScriptParams;
    struct Ports {
        Named<AnyGrid> inputs;
    };

    GridScript script;

    static NodeTraits traits(const Params& params) {
        auto out = script_traits(params);
        out.gathers = script_gathers(params);
        return out;
    }
    void add(const Params& params, const Ports& io, Context& context) {
        script.add(params, io.inputs, context);
    }
    void finish(const Params& params, Ports&, Context& context) { script.finish(params, context); }
};

/// Adds the input and the parameters of a GridScriptNode to a declaration.
template <class Declaration>
Declaration& declare_grid_script(Declaration& node) {
    node.input("inputs", &GridScriptNode::Ports::inputs, python_inputs_doc);
    return declare_python(node).param(
        "halo", &GridScriptParams::halo, Unit::voxels, between(0, 512),
        "Calls the function for blocks of at most 64 x 64 x 64 voxels, each with all voxels that "
        "are so near to it, and takes of its result only the block. So a frame may be larger than "
        "memory holds as an array. The function must not look farther. Auto: the whole frame at "
        "once.");
}

}  // namespace fluidcarve
