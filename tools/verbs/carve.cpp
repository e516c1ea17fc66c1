#include "tools/verbs/verbs.h"

#include "carve/base/words.h"
#include "formats/file/path_pattern.h"
#include "graph/build_pipeline.h"
#include "graph/types/param.h"
#include "graph/types/registry.h"
#include "tools/draft/draft.h"
#include "tools/draft/draft_files.h"
#include "tools/draft/request.h"
#include "tools/verbs/arguments.h"
#include "tools/verbs/run.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fluidcarve {
namespace {

/// Arguments of the verb `carve`.
struct CarveArguments {
    std::string files, count, out, seams, sheet;
    std::string axis = "x", solver;
    bool warp = false;  ///< instead of a solver
    std::vector<std::string> protect;
    /// Stated values of options that become parameters of nodes, by name; empty: as the draft has
    /// it.
    std::map<std::string, std::string> params;
    bool print_pipeline = false;
    RunArguments run;

    void declare(CLI::App& verb);
};

/// Whether a text is a number, perhaps with a sign, or a percentage.
bool is_count(std::string_view text) {
    if (text.ends_with('%')) text.remove_suffix(1);
    return parse_number(text).has_value();
}

/// What is wrong with the arguments, beside what the pipeline's check finds; empty: nothing.
std::string wrong_output(const CarveArguments& arguments, const DraftFiles& files) {
    const auto& input = files.sequence.path.text();
    const PathPattern out(arguments.out);
    const auto ending = ending_of(input);
    if (files.sequence.per_frame() && out.bad_token().empty() && !out.per_frame())
        return fmt::format(
            "-o: {} is a sequence, and each frame needs a file of its own: name them as in {}",
            input,
            (std::filesystem::path(arguments.out).parent_path() /
             std::filesystem::path(input).filename())
                .string());
    if (ending == ".vdb" && ending_of(arguments.out) != ending)
        return fmt::format("-o: {} holds volumes, and so will {}: let its name end in .vdb", input,
                           arguments.out);
    return {};
}

/// An option that states a parameter of a node of the same name.
struct ParamOption {
    const char* name;
    DraftRequest::Fields DraftRequest::*fields;  ///< those of the node
    const char* form;                            ///< of the value in a pipeline
    const char* doc;
};

constexpr std::array param_options{
    ParamOption{"empty", &DraftRequest::solver_fields, "{}",
                "Price of empty space: the higher, the more of the carve goes through the content "
                "(`empty` of the solver)"},
    ParamOption{"spread", &DraftRequest::solver_fields, "{}",
                "How far a seam keeps others away, in voxels (`spread`)"},
    ParamOption{"rigidity", &DraftRequest::solver_fields, "{}",
                "How straight seams are (`rigidity`)"},
    ParamOption{"anchor", &DraftRequest::solver_fields, "{}",
                "What stays in place: low, middle, high, or a vertex (`anchor`)"},
    ParamOption{"window", &DraftRequest::solver_fields, "[{}]",
                "First and last voxel of the box that seams may take, as in 3,20 (`window`)"},
    ParamOption{"soft", &DraftRequest::remap_fields, "{}",
                "How softly seams are carved, in voxels; 0 moves whole voxels (`soft` of "
                "remap.grids)"},
    ParamOption{"conserve", &DraftRequest::remap_fields, "{}",
                "mass: keeps the mass of densities (`conserve`)"},
};

/// The stated value of an option; empty: as the draft has it.
const std::string& value_of(const ParamOption& option, const CarveArguments& arguments) {
    return arguments.params.at(option.name);
}

/// The node type that the arguments ask for; empty if they ask for none.
std::string solver_type(const CarveArguments& arguments) {
    if (arguments.warp || arguments.solver == "warp") return "warp.solve";
    return arguments.solver.empty() ? "" : "seam." + arguments.solver;
}

DraftRequest request_of(const CarveArguments& arguments, const DraftFiles& files) {
    auto out = files.request({});
    out.out = arguments.out;
    out.seams = arguments.seams;
    out.sheet = arguments.sheet;
    out.count = arguments.count;
    out.axis = arguments.axis.front();
    out.solver = solver_type(arguments);
    out.protect = arguments.protect;
    for (const auto& each : param_options)
        if (const auto& value = value_of(each, arguments); !value.empty())
            (out.*each.fields).emplace_back(each.name, fmt::format(fmt::runtime(each.form), value));
    return out;
}

/// The command that carves the same again, for what the files state: it does not depend on folders
/// of outputs, threads and the like.
std::vector<std::string> words_of(const CarveArguments& arguments, const DraftFiles& files) {
    const CarveArguments fallback;
    std::vector<std::string> out{"carve", files.sequence.path.text(), arguments.count, "-o",
                                 std::filesystem::path(arguments.out).filename().string()};
    const auto add = [&](const std::string& name, const std::string& value,
                         const std::string& otherwise) {
        if (value != otherwise) out.insert(out.end(), {name, value});
    };
    add("--axis", arguments.axis, fallback.axis);
    if (arguments.warp) out.emplace_back("--warp");
    else add("--solver", arguments.solver, {});
    for (const auto& each : arguments.protect) add("--protect", each, {});
    for (const auto& each : param_options)
        add(fmt::format("--{}", each.name), value_of(each, arguments), {});
    return out;
}

/// What is wrong with the arguments, before any file is looked at; empty: nothing.
std::string wrong_request(const CarveArguments& arguments, const Registry& registry) {
    if (!is_count(arguments.count))
        return fmt::format(
            "COUNT must be a number of seams such as -12 or 12, or a share such as -20%, not '{}'",
            arguments.count);
    if (arguments.warp && !arguments.solver.empty())
        return "--warp takes the place of a solver: leave --solver out";
    const auto solver = solver_type(arguments);
    if (!solver.empty() && !registry.node(solver))
        return fmt::format("--solver: there is no node type '{}'{}", solver,
                           did_you_mean(solver, registry.node_names()));
    return {};
}

/// Options of how seams are found and carved.
void declare_solving(CLI::App& verb, CarveArguments& carve) {
    verb.add_option("--solver", carve.solver,
                    "What finds the seams, a type of the family `seam`, such as pyramid (default: "
                    "pyramid; for level sets and particles --warp)")
        ->type_name("SOLVER");
    verb.add_flag("--warp", carve.warp,
                  "Squeeze or draw out without seams, also by fractions of a voxel");
    verb.add_option("--protect", carve.protect,
                    "Where no seam may pass: GRID=VALUE, such as density=0.7, is where the grid "
                    "has at least this value; or a closed mesh; of images, a picture "
                    "that is white there; may be repeated")
        ->type_name("GRID=VALUE|FILE")
        ->expected(1)
        ->take_all();
    for (const auto& each : param_options)
        verb.add_option(fmt::format("--{}", each.name), carve.params[each.name], each.doc)
            ->type_name("VALUE");
}

void CarveArguments::declare(CLI::App& verb) {
    verb.add_option("files", files,
                    "A sequence such as smoke.####.vdb, a file, or a folder that holds one "
                    "sequence: volumes, images, particles or meshes")
        ->required()
        ->type_name("FILES");
    verb.add_option("count", count,
                    "Number of seams: -12 makes it narrower by twelve voxels, 12 wider; -20% is a "
                    "share of the size; with --warp also -12.5; with --axis t frames")
        ->required()
        ->type_name("COUNT");
    verb.add_option("-o,--out", out,
                    "The carved files; with a frame token such as #### if there are several")
        ->required()
        ->type_name("FILES");
    verb.add_option("--axis", axis,
                    "The axis of the files along which it becomes narrower or wider; w: lower or "
                    "higher, along the axis that points up (y in pictures and files of Houdini and "
                    "EmberGen, else z); t: shorter or longer in time, by frames")
        ->check(CLI::IsMember({"x", "y", "z", "w", "t"}))
        ->capture_default_str();
    declare_solving(verb, *this);
    verb.add_option("--sheet", sheet,
                    "Write before, after and the seams as one picture; with --axis t some frames")
        ->type_name("FILE.png");
    verb.add_option("--seams", seams, "Write the seams, to use again without solving")
        ->type_name("FILE.vdb");
    verb.add_flag("--print-pipeline", print_pipeline,
                  "Print the pipeline for `fluidcarve run`; carve nothing");
    run.declare(verb);
}

/// The verb `carve`: carves files in the box around them by the pipeline that `init` would write,
/// without a file of it.
/// @return an exit code
int carve_files(CarveArguments& arguments, const Registry& registry) {
    if (const auto fault = wrong_request(arguments, registry); !fault.empty())
        return end_with(fault);
    auto source = std::make_shared<Source>();
    std::vector<std::string> words;
    try {
        const auto files = look_at_draft_files(arguments.files, Several::refused);
        if (const auto fault = wrong_output(arguments, files); !fault.empty())
            return end_with(fault);
        source->name =
            "carve " + std::filesystem::path(files.sequence.path.text()).filename().string();
        source->text = draft_pipeline(request_of(arguments, files));
        words = words_of(arguments, files);
    } catch (const Failure& failure) {
        return end_with(failure.what(), exit_code::of(failure, exit_code::usage));
    }
    Problems problems;
    auto document = read_document(source, {}, problems);
    document.command = std::move(words);
    auto pipeline = build_pipeline(document, registry, problems);
    if (!problems.empty()) return end_with(problems);
    if (arguments.print_pipeline) return print(source->text), exit_code::done;
    return run_built(std::move(pipeline), document, arguments.run, registry);
}

}  // namespace

Verb::Work carve_verb(CLI::App& verb, Program& program) {
    const auto arguments = std::make_shared<CarveArguments>();
    arguments->declare(verb);
    return [=, &program] { return carve_files(*arguments, program.registry); };
}

}  // namespace fluidcarve
