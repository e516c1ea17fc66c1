#include "tools/verbs/verbs.h"

#include "formats/file/output_file.h"
#include "graph/build_pipeline.h"
#include "graph/types/registry.h"
#include "runtime/tell/exit_codes.h"
#include "tools/draft/draft.h"
#include "tools/draft/draft_files.h"
#include "tools/verbs/arguments.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <string>

namespace fluidcarve {
namespace {

/// Arguments of the verb `init`.
struct InitArguments {
    std::string files;
    std::string out;  ///< empty: stdout

    void declare(CLI::App& verb);
};

void InitArguments::declare(CLI::App& verb) {
    verb.add_option("files", files,
                    "A sequence such as smoke.####.vdb, a file, or a folder: its longest sequence")
        ->required()
        ->type_name("FILES");
    verb.add_option("-o,--out", out, "The pipeline to write; it must not exist (default: print it)")
        ->type_name("SHOT.yaml");
}

/// The verb `init`: looks at files and writes the commented pipeline for them. @return an exit code
int init_pipeline(const InitArguments& arguments, const Registry& registry) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    if (!arguments.out.empty() && fs::exists(arguments.out, ignored))
        return end_with(fmt::format("-o: {} exists already; name another file", arguments.out));
    try {
        const auto files = look_at_draft_files(arguments.files, Several::chosen);
        auto request = files.request(fs::path(arguments.out).parent_path().string());
        const auto folder = std::string("out/"),
                   ending = fs::path(files.sequence.path.text()).extension().string();
        request.out = folder + fs::path(files.sequence.path.text()).filename().string();
        request.seams = folder + files.stem() + "_seams.vdb";
        request.sheet = folder + files.stem() + "_sheet.png";
        auto source = std::make_shared<Source>();
        source->name = arguments.out.empty() ? "init" : arguments.out;
        source->text = draft_pipeline(request);
        source->folder = fs::path(arguments.out).parent_path().string();
        Problems problems;
        build_pipeline(read_document(source, {}, problems), registry, problems);
        if (!problems.empty()) return end_with(problems);
        for (const auto& note : files.notes) complain(fmt::format("warning: {}\n", note));
        if (arguments.out.empty()) return print(source->text), exit_code::done;
        OutputFile::write(arguments.out, source->text);
        complain(
            fmt::format("{} is written; next: fluidcarve run {}\n", arguments.out, arguments.out));
        return exit_code::done;
    } catch (const Failure& failure) {
        return end_with(failure.what(), exit_code::of(failure, exit_code::usage));
    }
}

}  // namespace

Verb::Work init_verb(CLI::App& verb, Program& program) {
    const auto arguments = std::make_shared<InitArguments>();
    arguments->declare(verb);
    return [=, &program] { return init_pipeline(*arguments, program.registry); };
}

}  // namespace fluidcarve
