#include "nodes/expression/ax_node.h"

#include "formats/file/module.h"
#include "graph/types/context.h"
#include "graph/types/node_check.h"
#include "nodes/expression/evaluate.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace fluidcarve {
namespace {

const ExpressionModule& expressions() { return load_module<ExpressionModule>("expressions"); }

Expression expression_of(const AxParams& params, std::vector<std::string> inputs,
                         const std::string& output) {
    return {params.code.text, std::move(inputs), params.params, output};
}

constexpr double usual_rate = 24;

/// Frames per second. Nothing if the params state anything else than a number above 0.
std::optional<double> rate_of(const AxParams& params) {
    const auto found = params.params.find(rate_constant);
    if (found == params.params.end()) return usual_rate;
    const auto* const rate = std::get_if<double>(&found->second);
    return rate && *rate > 0 ? std::optional(*rate) : std::nullopt;
}

/// A grid with one value everywhere and no active voxel.
Ref<AnyGrid> everywhere(double value, const openvdb::math::Transform& transform) {
    const auto grid = FloatGrid::create(static_cast<float>(value));
    grid->setTransform(transform.copy());
    return std::make_shared<AnyGrid>(AnyGrid{grid});
}

std::string to_text(const Mark& mark) {
    return fmt::format("{}:{}:{}", mark.source ? mark.source->name : std::string("code"), mark.line,
                       mark.column);
}

}  // namespace

const char* const ax_inputs_doc =
    "Grids by name, all with the same transform: `{d: sim.density, vel: sim.velocity}`. The "
    "program reads a float grid or a mask (1 and 0) as `@d`, a vector grid as `v@vel`. Staggered "
    "vectors are collocated first.";
const char* const ax_params_doc =
    "Constants by name, numbers or [x, y, z]: `{gain: 2}`. The program reads a number as `$gain`, "
    "a vector as `v$name`.";

std::string ax_code_doc(const std::string& output) {
    return fmt::format(
        "A program in OpenVDB AX that runs for each voxel: `float speed = length(v@vel); {0} = "
        "$gain * speed + abs(@d);`. {0} is 0 until the program writes it. Variables may be float, "
        "vec3f, int, bool, double, vec3d, vec3i or int64. getvoxelpws() is the voxel's position in "
        "the world, as in `vec3d p = getvoxelpws(); {0} = max(p.z, 0.0);`; getcoordx(), "
        "getcoordy() and getcoordz() are its index. `@Frame` or `$F` is the frame's number, "
        "`@Time` is (frame - 1) / fps in seconds, with `fps` from the params, or 24. A program "
        "can't read neighbouring voxels: use field.gradient or field.curl as inputs. Loops must "
        "count to a stated end, rand() needs a seed, and a whole number may only be divided by a "
        "value that can't be 0.",
        output);
}

void check_ax(const AxParams& params, const std::string& output, NodeCheck& check) {
    if (check.stated("inputs") && check.connections("inputs") == 0)
        return check.fault("inputs", "'inputs' names no grid; name at least one");
    const ExpressionModule* module = nullptr;
    try {
        module = &expressions();
    } catch (const Failure&) {
        return;
    }
    std::vector<ExpressionFault> faults;
    const auto inputs = check.names("inputs");
    const auto compiled = module->compile(expression_of(params, inputs, output), faults);
    const auto reads_time = [&](const auto& read) { return read.input == time_input; };
    if (compiled && std::ranges::any_of(compiled->reads, reads_time) &&
        std::ranges::count(inputs, time_input) == 0 && !rate_of(params))
        check.fault("params",
                    fmt::format("'{}' must be a number above 0, for the program reads @{}",
                                rate_constant, time_input));
    for (const auto& fault : faults) {
        const auto message = fmt::format("'{}' {}", fault.field, fault.message);
        if (fault.warning) check.warn(fault.field, message);
        else if (fault.line > 0)
            check.fault(params.code.place(fault.line, fault.column),
                        fmt::format("'{}': {}", fault.field, fault.message));
        else check.fault(fault.field, message);
    }
}

FloatGrid::Ptr AxProgram::run(const AxParams& params, const std::string& output, float least,
                              const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs,
                              const Context& context) const {
    const auto& module = expressions();
    const auto place = [&](int line, int column) {
        return to_text(params.code.place(line, column));
    };
    std::call_once(once_, [&] {
        std::vector<std::string> names;
        for (const auto& [name, grid] : inputs) names.push_back(name);
        std::vector<ExpressionFault> faults;
        compiled_ = module.compile(expression_of(params, std::move(names), output), faults);
        if (!compiled_)
            throw Failure(fmt::format("{}: {}", place(faults.at(0).line, faults[0].column),
                                      faults[0].message));
    });
    auto all = inputs;
    for (const auto& read : compiled_->reads) {
        const auto& name = read.input;
        if (std::ranges::any_of(inputs, [&](const auto& input) { return input.first == name; }))
            continue;
        const auto frame = context.frame();
        all.emplace_back(
            name, everywhere(name == frame_input ? frame : (frame - 1) / rate_of(params).value(),
                             inputs.front().second->grid->transform()));
    }
    return evaluated(module, *compiled_, all, output, least, context.limits().memory, place);
}

bool may_read_moment(const AxParams& params) {
    for (const auto& name : {fmt::format("@{}", frame_input), fmt::format("@{}", time_input),
                             fmt::format("${}", frame_constant)})
        if (params.code.text.find(name) != std::string::npos) return true;
    return false;
}

}  // namespace fluidcarve
