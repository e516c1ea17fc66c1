#include "tools/verbs/verbs.h"

#include "formats/file/input_file.h"
#include "formats/file/output_file.h"
#include "formats/file/path_pattern.h"
#include "graph/provenance.h"
#include "graph/text/yaml_text.h"
#include "graph/views/value_sources.h"
#include "runtime/run/interrupt.h"
#include "runtime/run/run.h"
#include "runtime/tell/outcome.h"
#include "tools/draft/draft_preview.h"
#include "tools/draft/request.h"
#include "tools/verbs/arguments.h"
#include "tools/verbs/view.h"
#include "tools/wedge/combinations.h"
#include "tools/wedge/contact_sheet.h"
#include "tools/wedge/joined_page.h"
#include "tools/wedge/wedge_page.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {
namespace {

/// Arguments of the verb `wedge`, beside those of the pipeline.
struct WedgeArguments {
    std::vector<std::string> over;  ///< of --over: `TARGET=VALUE,VALUE`
    std::string out = "wedge";      ///< the folder of all results
    RunArguments run;

    void declare(CLI::App& verb);
};

namespace fs = std::filesystem;

std::string to_text(const Combination& combination) {
    std::vector<std::string> out;
    for (const auto& [target, value] : combination)
        out.push_back(fmt::format("{}={}", target, value));
    return fmt::format("{}", fmt::join(out, ", "));
}

/// One of the runs.
struct WedgeRun {
    Combination combination;
    std::string folder;  ///< of all of its files
    Document document;
    Pipeline pipeline;
    std::string picture;  ///< path of what its first preview draws; empty: none
    Pipeline viewed;      ///< the same, with a preview.page
    std::string view;     ///< the node of that type; empty: there is nothing to show
    int code = exit_code::done;
    WedgeResult result;
};

/// Settings by which a pipeline writes all of its files into a folder, under their own names.
std::vector<std::string> outputs_into(const std::string& folder, const Pipeline& pipeline) {
    std::map<std::string, int> named;
    for (const auto& node : pipeline.nodes)
        for (const auto& [param, path] : node.written())
            ++named[fs::path(path.text()).filename().string()];
    std::vector<std::string> out;
    std::map<std::string, std::string> moved;
    for (const auto& node : pipeline.nodes)
        for (const auto& [param, path] : node.written()) {
            const auto name = fs::path(path.text()).filename();
            const auto to =
                (named.at(name.string()) > 1 ? fs::path(folder) / node.name / name : folder / name)
                    .string();
            moved.emplace(fs::path(path.text()).lexically_normal().string(), to);
            out.push_back(fmt::format("{}.{}={}", node.name, param.name, to));
        }
    for (const auto& node : pipeline.nodes)
        for (const auto& spec : node.type->params) {
            if (!spec.written || spec.written(node.params.get()).empty()) continue;
            std::vector<std::string> files;
            for (const auto& [name, path] : spec.written(node.params.get())) {
                const auto found = moved.find(fs::path(path.text()).lexically_normal().string());
                files.push_back(
                    fmt::format("{}: {}", yaml_scalar(name),
                                yaml_scalar(found == moved.end() ? path.text() : found->second)));
            }
            out.push_back(
                fmt::format("{}.{}={{{}}}", node.name, spec.name, fmt::join(files, ", ")));
        }
    return out;
}

/// Adds a node that draws what is carved.
/// @return the path of its picture; empty: nothing can be drawn
std::string add_preview(Document& document, const DraftRequest::Fields& fields,
                        const std::string& folder) {
    if (fields.empty()) return {};
    auto source = std::make_shared<Source>();
    source->name = "wedge";
    const Mark mark{source, 0, 0};
    const auto path = (fs::path(folder) / "wedge_sheet.png").string();
    Value::Field node{"wedge_sheet", mark, Value::map(mark)};
    const auto put = [&](const std::string& name, const std::string& text) {
        node.value.fields.push_back({name, mark, Value::scalar(mark, text)});
    };
    for (const auto& [name, text] : fields) put(name, text);
    put("path", path);
    document.nodes.fields.push_back(std::move(node));
    return path;
}

/// The picture of the first preview; empty: there is none.
std::string picture_of(const Pipeline& pipeline) {
    std::string out;
    for (const auto& node : pipeline.nodes)
        for (const auto& [param, path] : node.written())
            if (out.empty() && node.type->name.starts_with("preview.") &&
                path.text().ends_with(".png"))
                out = path.at(pipeline.frames.frames().front());
    return out;
}

/// How many items, such as seams, the nodes of a pipeline are to find. Percentages count as of a
/// thousand.
std::size_t wanted(const Pipeline& pipeline) {
    std::size_t out = 0;
    for (const auto& node : pipeline.nodes)
        if (node.type->growth) out += node.type->growth->wanted(node.params.get(), 1000);
    return out;
}

/// Problems of values that --over states are told as such.
void name_over(Problems& problems, const std::vector<Varied>& varied) {
    const auto rename = [&](Mark& mark) {
        if (!mark.source || mark.source->name != "--set") return;
        const auto target = mark.source->text.substr(0, mark.source->text.find('='));
        if (std::ranges::find(varied, target, &Varied::target) == varied.end()) return;
        auto source = std::make_shared<Source>(*mark.source);
        source->name = "--over";
        mark.source = std::move(source);
    };
    for (auto& problem : problems) rename(problem.at), rename(problem.also_at);
}

/// Prepares the page of a run, if the pipeline has something to show.
void prepare_view(WedgeRun& run, const Registry& registry) {
    auto document = run.document;
    std::string name;
    if (!add_page(document, name).empty()) return;
    if (!run.document.nodes.find(name))
        set_page_path(document, name, (fs::path(run.folder) / "wedge_view.html").string());
    Problems unfit;
    auto viewed = build_pipeline(document, registry, unfit, run.pipeline.plugins);
    if (!unfit.empty()) return;
    state_provenance(viewed, document, registry);
    run.viewed = std::move(viewed);
    run.view = name;
}

/// Checks all runs. @param problems  of all of them
std::vector<WedgeRun> prepare(const PipelineArguments& arguments, const std::vector<Varied>& varied,
                              const std::string& folder, Registry& registry, Problems& problems) {
    std::vector<WedgeRun> out;
    for (const auto& combination : combinations_of(varied)) {
        WedgeRun run;
        run.combination = combination;
        run.folder = (fs::path(folder) / folder_name(combination, out.size() + 1)).string();
        auto settings = arguments.settings;
        for (const auto& [target, value] : combination) settings.push_back(target + "=" + value);
        Problems found;
        const auto document = read_document(arguments.path, settings, found);
        const auto as_stated =
            out.empty() ? arguments.build(document, registry, found)
                        : build_pipeline(document, registry, found, out.front().pipeline.plugins);
        if (found.empty()) {
            for (auto& setting : outputs_into(run.folder, as_stated))
                settings.push_back(std::move(setting));
            run.document = read_document(arguments.path, settings, found);
            run.picture = picture_of(as_stated);
            if (run.picture.empty())
                run.picture = add_preview(run.document, draft_preview(as_stated), run.folder);
            run.pipeline = build_pipeline(run.document, registry, found, as_stated.plugins);
        }
        if (found.empty()) {
            if (const auto drawn = picture_of(run.pipeline); !drawn.empty()) run.picture = drawn;
            state_provenance(run.pipeline, run.document, registry);
            prepare_view(run, registry);
        }
        problems.insert(problems.end(), found.begin(), found.end());
        out.push_back(std::move(run));
    }
    name_over(problems, varied);
    return out;
}

/// The report of a run that has ended; nothing if it wrote none.
std::optional<nlohmann::ordered_json> report_in(const std::string& path) {
    try {
        return nlohmann::ordered_json::parse(InputFile(path, {.what = "a report"}).whole());
    } catch (const Unreadable&) {
        return std::nullopt;
    }
}

/// Makes the page of a run that has ended, from what it kept.
/// @return its path; empty: there is none
std::string draw_view(const WedgeRun& run, RunArguments arguments, const Registry& registry,
                      const Interrupt& interrupt) {
    if (run.view.empty() || arguments.no_cache || !arguments.only.empty() ||
        !arguments.request.target.to.empty())
        return {};
    arguments.request.target.to = run.view;
    arguments.request.quiet = true;
    const auto request = arguments.read(run.viewed);
    if (!request || run_pipeline(run.viewed, registry, *request,
                                 [&] { return interrupt.asked(); }) != exit_code::done)
        return {};
    return page_path(run.viewed, run.view);
}

/// Runs one of the pipelines. Nothing of an earlier run is taken for its result.
/// @return false if its options are wrong
bool execute(WedgeRun& run, RunArguments& arguments, const Registry& registry,
             const Interrupt& interrupt) {
    auto request = arguments.read(run.pipeline);
    if (!request) return false;
    request->sources = value_sources_of(run.document, registry);
    request->report_path = run.folder + "/report.json";
    request->html_path = run.folder + "/report.html";
    std::error_code ignored;
    fs::remove(request->report_path, ignored);
    run.code = run_pipeline(run.pipeline, registry, *request, [&] { return interrupt.asked(); });
    const auto report = report_in(request->report_path);
    run.result.differs = run.combination;
    run.result.failed = run.code != exit_code::done;
    run.result.results = report ? wedge_results(*report)
                                : std::vector<std::string>{"failed: it ended without a report"};
    run.result.report =
        report ? fs::path(run.folder).filename().string() + "/report.html" : std::string();
    if (run.result.failed) return true;
    run.result.picture = run.picture;
    run.result.view = draw_view(run, arguments, registry, interrupt);
    return true;
}

/// Runs all of the pipelines.
/// @param code  becomes the first exit code that is not 0
/// @return false if the options are wrong, or the user stops the wedge
bool execute_all(std::vector<WedgeRun>& runs, RunArguments& arguments, const Registry& registry,
                 const Interrupt& interrupt, int& code) {
    // The run with most seams comes first: the others take theirs from the work folder.
    std::vector<WedgeRun*> order;
    for (auto& run : runs) order.push_back(&run);
    std::ranges::stable_sort(order, std::ranges::greater(),
                             [](const WedgeRun* run) { return wanted(run->pipeline); });
    for (std::size_t place = 0; place < order.size(); ++place) {
        auto& run = *order[place];
        if (!arguments.request.quiet)
            complain(
                fmt::format("{} of {}: {}\n", place + 1, order.size(), to_text(run.combination)));
        if (!execute(run, arguments, registry, interrupt)) return code = exit_code::usage, false;
        if (run.code == exit_code::interrupted) return code = run.code, false;
        if (code == exit_code::done) code = run.code;
    }
    return true;
}

/// A row of texts for each run: its values, and what came of it.
std::string table_of(const std::vector<Varied>& varied, const std::vector<WedgeRun>& runs) {
    std::vector<std::size_t> widths;
    for (const auto& [target, values] : varied) {
        auto width = target.size();
        for (const auto& value : values) width = std::max(width, value.size());
        widths.push_back(width);
    }
    std::string out;
    for (std::size_t n = 0; n < varied.size(); ++n)
        out += fmt::format("{:<{}}  ", varied[n].target, widths[n]);
    out += "result\n";
    for (const auto& run : runs) {
        for (std::size_t n = 0; n < varied.size(); ++n)
            out += fmt::format("{:<{}}  ", run.combination[n].second, widths[n]);
        out += fmt::format("{}\n", fmt::join(run.result.results, "; "));
    }
    return out;
}

/// Writes the sheet and the pages of all runs. @throws Failure
void show(const std::string& name, const std::string& folder, const std::vector<Varied>& varied,
          const std::vector<WedgeRun>& runs) {
    std::vector<ContactCell> cells;
    std::vector<PagePart> pages;
    std::vector<WedgeResult> results;
    std::vector<std::string> targets;
    for (const auto& each : varied) targets.push_back(each.target);
    for (const auto& run : runs) {
        ContactCell cell{{}, run.result.results, run.result.picture};
        for (const auto& [target, value] : run.combination)
            cell.labels.push_back(fmt::format("{} = {}", target, value));
        cells.push_back(std::move(cell));
        if (!run.result.view.empty()) pages.push_back({run.result.view, run.combination});
        results.push_back(run.result);
    }
    const auto columns =
        varied.size() > 1
            ? varied.back().values.size()
            : static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(runs.size()))));
    const auto title = fmt::format("{}: {}", name, fmt::join(targets, ", "));
    write_contact_sheet(title, cells, columns, folder + "/wedge.png");
    std::string view, fault;
    try {
        if (!pages.empty())
            write_joined_page(title, pages, folder + "/view.html"), view = "view.html";
    } catch (const Failure& failure) {
        fault = fmt::format("no {}/view.html: {}\n", folder, failure.what());
    }
    OutputFile::write(
        folder + "/wedge.html",
        wedge_page(name, fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(std::time(nullptr))), view,
                   results));
    print(fmt::format("{0}/wedge.png, {0}/wedge.html{1}\n{2}", folder,
                      view.empty() ? "" : fmt::format(", {}/{}", folder, view), fault));
}

void WedgeArguments::declare(CLI::App& verb) {
    verb.add_option("--over", over,
                    "A param, a node's field or the frames, and the values to run it with; may be "
                    "repeated, for all combinations")
        ->type_name("NODE.FIELD=VALUE,...|PARAM=VALUE,...")
        ->expected(1)
        ->take_all()
        ->required();
    verb.add_option("-o,--out", out,
                    "The folder of all results: one folder for each run, wedge.png, wedge.html and "
                    "view.html")
        ->capture_default_str()
        ->type_name("DIR");
    run.declare(verb);
}

/// The verb `wedge`: runs a pipeline with all combinations of values, each into a folder of its
/// own, and shows the results side by side.
/// @return an exit code: the first that is not 0, if a run failed
int wedge_pipeline(const PipelineArguments& pipeline, WedgeArguments& arguments,
                   Registry& registry) {
    const auto& own = arguments.run.request;
    if (!own.report_path.empty() || !own.html_path.empty() || !own.profile_path.empty())
        return end_with(
            fmt::format("--report, --html and --profile name one file, and a wedge has many runs: "
                        "each writes its report into its folder in {}",
                        arguments.out));
    std::vector<Varied> varied;
    try {
        varied = read_varied(arguments.over);
    } catch (const Failure& failure) {
        return end_with(failure.what());
    }
    Problems problems;
    auto runs = prepare(pipeline, varied, arguments.out, registry, problems);
    if (!problems.empty()) return end_with(problems);
    const Interrupt interrupt(last_words(own.quiet, !arguments.run.no_cache));
    int code = exit_code::done;
    if (!execute_all(runs, arguments.run, registry, interrupt, code)) return code;
    print(table_of(varied, runs));
    try {
        show(pipeline.path, arguments.out, varied, runs);
    } catch (const Failure& failure) {
        return end_with(fmt::format("failed: {}", failure.what()),
                        code == exit_code::done ? exit_code::node_failed : code);
    }
    return code;
}

}  // namespace

Verb::Work wedge_verb(CLI::App& verb, Program& program) {
    const auto arguments = std::make_shared<WedgeArguments>();
    program.pipeline.declare(verb);
    arguments->declare(verb);
    return [=, &program] { return wedge_pipeline(program.pipeline, *arguments, program.registry); };
}

}  // namespace fluidcarve
