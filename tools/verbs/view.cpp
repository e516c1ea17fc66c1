#include "tools/verbs/view.h"

#include "graph/provenance.h"
#include "runtime/run/interrupt.h"
#include "runtime/run/preparation.h"
#include "runtime/tell/report.h"
#include "runtime/tell/uncaught.h"
#include "tools/verbs/verbs.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace fluidcarve {
namespace {

constexpr std::string_view page_type = "preview.page";
/// Frames on a page that has nothing else to show.
constexpr int most_played = 24;

/// A field of a node as written; null if it is not stated.
const Value* field(const Value::Field* node, std::string_view name) {
    if (!node) return nullptr;
    const auto* const found = node->value.find(name);
    return found && found->value.kind != Value::Kind::null ? &found->value : nullptr;
}

std::string type_of(const Value::Field& node) {
    const auto* const type = field(&node, "type");
    return type ? type->text : std::string();
}

/// The first node of one of these types that states a field, types in order; null if there is none.
const Value::Field* first_of(const Document& document,
                             std::initializer_list<std::string_view> types, std::string_view with) {
    for (const auto type : types)
        for (const auto& node : document.nodes.fields)
            if (type_of(node) == type && field(&node, with)) return &node;
    return nullptr;
}

/// The node that a connection names: "box" of `box` and of `box.lattice`; of a list the last one.
const Value::Field* connected(const Document& document, const Value* link) {
    if (!link) return nullptr;
    const auto& text = link->kind == Value::Kind::list && !link->items.empty()
                           ? link->items.back().text
                           : link->text;
    return document.nodes.find(text.substr(0, text.find('.')));
}

/// Adds a field to a node, unless it has one of this name.
void add(Value& node, const std::string& name, const Value* value) {
    if (value && !node.find(name)) node.fields.push_back({name, value->mark, *value});
}

/// What sets the count of a solver: the param whose whole value it is, else its own field.
std::string setting_of(const Document& document, const Value::Field& solver) {
    const auto* const count = field(&solver, "count");
    for (const auto& param : document.params.fields)
        if (count && param.value.mark == count->mark) return param.name;
    return solver.name + ".count";
}

/// Whether a solver finds seams of frames.
bool in_time(const Value::Field* solver) {
    const auto* const axis = field(solver, "axis");
    return axis && axis->text == "t";
}

/// Whether frames are carved: then a page shows what comes of it, since it has other frames.
bool carves_frames(const Document& document) {
    return std::ranges::any_of(document.nodes.fields, [&](const Value::Field& node) {
        return type_of(node) == "remap.grids" &&
               in_time(connected(document, field(&node, "seams")));
    });
}

/// Leaves out the seams of a node, and what is for them.
void leave_out_seams(Value& node) {
    std::erase_if(node.fields, [](const Value::Field& each) {
        return each.name == "seams" || each.name == "count";
    });
}

/// Lets all solvers take as many seams as there are: a page of these shows more than an error.
void take_what_is_there(Document& document, const Registry& registry) {
    for (auto& node : document.nodes.fields) {
        const auto* const type = registry.node(type_of(node));
        const auto yes = Value::scalar(node.value.mark, ParamTraits<bool>::text(true));
        if (type && type->param("best_effort") && !in_time(&node))
            add(node.value, "best_effort", &yes);
    }
}

/// Makes a page for a document without one. It shows what the document's nodes carve.
class PageDraft {
public:
    explicit PageDraft(const Document& document) : document_(document) {
        sheet_ = first({"preview.sheet"}, "lattice");
        remap_ = first({"remap.grids"}, "seams");
        seams_ = stated("seams", {sheet_, remap_});
        solver_ = connected(document, seams_);
        const auto* const built = first({"lattice.build", "lattice.box"}, "type");
        lattice_ = stated("lattice", {sheet_, remap_, solver_});
        if (!lattice_ && built)
            lattice_ = &lattice_name_.emplace(Value::scalar(mark(), built->name));
        before_ = carved_grids(built);
        plays_ = !before_;
        if (plays_) before_ = played_grids();
        if (before_ && before_->kind == Value::Kind::list && !before_->items.empty())
            before_ = &before_->items.front();
    }
    PageDraft(const PageDraft&) = delete;
    PageDraft& operator=(const PageDraft&) = delete;

    bool shows_nothing() const { return !before_; }
    Value page() const {
        auto out = Value::map(mark());
        const auto state = [&](const char* name, std::string text) {
            const auto value = Value::scalar(mark(), std::move(text));
            add(out, name, &value);
        };
        state("type", std::string(page_type));
        add(out, "before", before_);
        add(out, "grid", field(sheet_ ? sheet_ : played_, "grid"));
        if (plays_) state("frames", std::to_string(most_played));
        add(out, "lattice", lattice_);
        add(out, "energy", stated("energy", {sheet_, solver_}));
        add(out, "rig", field(connected(document_, lattice_), "rig"));
        if (lattice_) add(out, "seams", seams_);
        auto masks = Value::map(mark());
        for (const auto* const each : {"protect", "attract"})
            add(masks, each, field(solver_, each));
        if (!masks.fields.empty()) add(out, "masks", &masks);
        for (const auto* const each : {"count", "soft", "soft_time", "rim", "fade"})
            add(out, each, field(remap_, each));
        state("setting", solver_ ? setting_of(document_, *solver_) : "count");
        state("path", "out/" + std::filesystem::path(document_.name).stem().string() + ".html");
        return out;
    }

private:
    const Mark& mark() const { return document_.nodes.mark; }
    /// As first_of, where the page shows what is carved.
    const Value::Field* first(std::initializer_list<std::string_view> types,
                              std::string_view with) const {
        return frames_carved_ ? nullptr : first_of(document_, types, with);
    }
    /// A field, of the first node that states it.
    static const Value* stated(std::string_view name,
                               std::initializer_list<const Value::Field*> nodes) {
        for (const auto* const node : nodes)
            if (const auto* const value = field(node, name)) return value;
        return nullptr;
    }
    const Value* carved_grids(const Value::Field* built) const {
        if (const auto* const before = sheet_ ? field(sheet_, "before") : field(remap_, "source"))
            return before;
        if (const auto* const fitted = field(built, "fit")) return fitted;
        return field(solver_, "field");
    }
    /// Nothing is carved: the page plays what a sheet shows, or what is written.
    const Value* played_grids() const {
        if (played_) return field(played_, "before");
        return field(first_of(document_, {"vdb.write", "image.write"}, "source"), "source");
    }

    const Document& document_;
    const bool frames_carved_ = carves_frames(document_);
    const Value::Field* const played_ = first_of(document_, {"preview.sheet"}, "before");
    const Value::Field *sheet_ = nullptr, *remap_ = nullptr, *solver_ = nullptr;
    const Value *seams_ = nullptr, *lattice_ = nullptr, *before_ = nullptr;
    std::optional<Value> lattice_name_;  ///< of the lattice that is built, if no node takes it
    bool plays_ = false;                 ///< nothing is carved
};

/// Whether a run would have to find seams: a solver upstream of a node is not in the work folder
/// with all that is wanted.
/// @throws Failure if nothing tells, since the work folder or an input can't be read
bool must_solve(const Pipeline& pipeline, const Registry& registry, const RunRequest& request) {
    Report report(pipeline);
    Preparation prepared(pipeline, registry, request, report);
    // What is missing is told by the run.
    if (prepared.frames().empty() || !prepared.inputs().missing.empty()) return false;
    const auto to_do = prepared.demands(prepared.schedule());
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        if (to_do[n].computed == 0 || !pipeline.nodes[n].type->growth) continue;
        auto fault = prepared.cache().read_fault();
        if (!fault.empty()) fault += "; make it readable, or name another work folder with --work";
        else if (request.options.cache) fault = prepared.fault_of_contents();
        if (!fault.empty())
            throw Failure("nothing tells whether the seams are found: " + fault,
                          Failure::Kind::input);
        return true;
    }
    return false;
}

}  // namespace

std::string add_page(Document& document, std::string& name) {
    for (const auto& node : document.nodes.fields)
        if (type_of(node) == page_type) return name = node.name, std::string();
    const PageDraft draft(document);
    if (draft.shows_nothing())
        return fmt::format(
            "{}: it has no preview.page or preview.sheet, and carves and writes no grids, so that "
            "nothing says what to show; add a preview.page",
            document.name);
    auto page = draft.page();
    for (name = "view"; document.nodes.find(name);) name += "_";
    document.nodes.fields.push_back({name, document.nodes.mark, std::move(page)});
    return {};
}

void set_page_path(Document& document, const std::string& node, const std::string& path) {
    auto& page = document.nodes.find(node)->value;
    std::erase_if(page.fields, [](const Value::Field& each) { return each.name == "path"; });
    const auto value = Value::scalar(page.mark, path);
    add(page, "path", &value);
}

std::string page_path(const Pipeline& pipeline, const std::string& node) {
    const auto& page = *pipeline.find(node);
    const auto* const spec = page.type->param("path");
    return spec ? spec->path(page.params.get()).at(pipeline.frames.frames().front())
                : std::string();
}

namespace {

/// Arguments of the verb `view`.
struct ViewArguments {
    std::string path;    ///< of the page; empty: that of the pipeline's preview.page, or
                         ///< out/NAME.html for a pipeline NAME.yaml
    bool solve = false;  ///< find seams that are not in the work folder
    RunArguments run;

    void declare(CLI::App& verb);
};

void ViewArguments::declare(CLI::App& verb) {
    verb.add_option("-o,--output", path,
                    "The page (default: that of the pipeline's preview.page, else out/NAME.html "
                    "for NAME.yaml)")
        ->type_name("FILE.html");
    verb.add_flag("--solve", solve,
                  "Find the seams if no earlier run has; without it the page then shows where they "
                  "are to be found");
    run.declare_limits(verb);
}

/// Runs what a page needs, and tells where it lies. @return an exit code
int make_page(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
              const std::string& node, bool left_out) {
    const Interrupt interrupt(last_words(request.quiet, request.options.cache));
    const int code = run_pipeline(pipeline, registry, request, [&] { return interrupt.asked(); });
    if (code != exit_code::done) return code;
    if (left_out && !request.quiet)
        complain("the seams are not found yet: the page shows where; --solve finds them\n");
    print(page_path(pipeline, node) + "\n");
    return exit_code::done;
}

/// The verb `view`: writes a page of a pipeline, and prints its path. Runs what the pipeline's
/// first preview.page needs; if it has none, one that shows what its preview.sheet or remap.grids
/// does. Without --solve, seams that no earlier run found are left out.
/// @return an exit code
int view_pipeline(const PipelineArguments& arguments, ViewArguments& view, Registry& registry) {
    Problems problems;
    auto document = read_document(arguments.path, arguments.settings, problems);
    auto pipeline = arguments.build(document, registry, problems);
    if (!problems.empty()) return end_with(problems);
    std::string name;
    if (const auto fault = add_page(document, name); !fault.empty()) return end_with(fault);
    if (!view.path.empty()) set_page_path(document, name, view.path);
    if (view.solve) take_what_is_there(document, registry);
    view.run.request.target.to = name;
    std::optional<RunRequest> request;
    const auto build = [&] {
        // The plugins are loaded.
        pipeline = build_pipeline(document, registry, problems, std::move(pipeline.plugins));
        if (!problems.empty()) return complain(to_text(problems)), false;
        state_provenance(pipeline, document, registry);
        request = view.run.read(pipeline);
        return request.has_value();
    };
    if (!build()) return exit_code::usage;
    bool left_out = false;
    try {
        require_threads(request->options.threads);
        left_out = !view.solve && field(document.nodes.find(name), "seams") &&
                   must_solve(pipeline, registry, *request);
    } catch (const Failure& failure) {
        return end_with(fmt::format("failed: {}", failure.what()), exit_code::of(failure));
    }
    if (left_out) {
        leave_out_seams(document.nodes.find(name)->value);
        if (!build()) return exit_code::usage;
    }
    return make_page(pipeline, registry, *request, name, left_out);
}

}  // namespace

Verb::Work view_verb(CLI::App& verb, Program& program) {
    const auto arguments = std::make_shared<ViewArguments>();
    program.pipeline.declare(verb);
    arguments->declare(verb);
    return [=, &program] { return view_pipeline(program.pipeline, *arguments, program.registry); };
}

}  // namespace fluidcarve
