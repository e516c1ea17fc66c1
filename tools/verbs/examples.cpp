#include "tools/verbs/examples.h"

namespace fluidcarve {

namespace {

/// From 2.5 on, CLI11 would set the lines of examples anew, as a paragraph.
template <class Formatter>
void keep_lines(Formatter& formatter) {
    if constexpr (requires { formatter.enable_footer_formatting(false); })
        formatter.enable_footer_formatting(false);
}

}  // namespace

void add_examples(CLI::App& app) {
    const std::map<std::string, const char*> examples{
        {"run",
         "  fluidcarve run pipelines/plume.yaml --set count=-20\n"
         "  fluidcarve run shot.yaml -f 1001-1010 --report out/shot.json     a farm's chunk\n"
         "  fluidcarve run shot.yaml --manifest shot.manifest                no input may have "
         "rotted since the first run\n"
         "  fluidcarve run shot.yaml --to seams.energy -f 1-42              only the solver's data "
         "of these frames\n"
         "  fluidcarve run theirs.yaml --confine /shots/sh010 --work /shots/sh010/work\n"
         "  fluidcarve run shot.yaml --only seams                           the solver alone, from "
         "cached results"},
        {"check",
         "  fluidcarve check shot.yaml\n  fluidcarve check theirs.yaml --confine /shots/sh010\n  "
         "fluidcarve check shot.yaml -v        where each value comes from, and where the files "
         "lie"},
        {"plan", "  fluidcarve plan shot.yaml --set look.weights='[0.4, 0.6]'"},
        {"farm",
         "  fluidcarve farm local shot.yaml -j 4\n"
         "  fluidcarve farm local shot.yaml --chunk 10 --dry-run            the steps, and the "
         "command of each\n"
         "  fluidcarve farm slurm shot.yaml --minutes 20 --output shot_job  batch scripts; then: "
         "shot_job/submit --partition=fx\n"
         "  fluidcarve farm slurm shot.yaml --work /shared/sh010/work --prefix 'rez-env fluidcarve "
         "--' --submit\n"
         "  fluidcarve farm openjd shot.yaml --output shot_bundle           a bundle; then: "
         "deadline bundle submit shot_bundle"},
        {"view",
         "  fluidcarve view pipelines/plume.yaml                            after `run`: a slider "
         "for the count\n"
         "  fluidcarve view shot.yaml -o shot.html                          before: where rig, "
         "lattice, masks and energy lie\n"
         "  fluidcarve view shot.yaml --solve --set count=-40"},
        {"status", "  fluidcarve status --work /shared/sh010/work"},
        {"carve",
         "  fluidcarve carve smoke.####.vdb -12 -o out/smoke.####.vdb\n"
         "  fluidcarve carve smoke.####.vdb -20% -o out/smoke.####.vdb --axis y --protect "
         "density=0.7 --sheet out/sheet.png\n"
         "  fluidcarve carve beach.jpg -20% -o narrow.jpg\n"
         "  fluidcarve carve smoke.####.vdb -12 -o out/smoke.####.vdb --print-pipeline > "
         "shot.yaml"},
        {"wedge",
         "  fluidcarve wedge shot.yaml --over count=-4,-8,-12\n"
         "  fluidcarve wedge shot.yaml --over count=-8,-16 --over "
         "seams.type=seam.greedy,seam.pyramid --out wedges/seams"},
        {"init",
         "  fluidcarve init smoke.####.vdb -o shot.yaml\n  fluidcarve init /shots/sh010      the "
         "one sequence in a folder"},
        {"clean",
         "  fluidcarve clean --work /shared/sh010/work\n  fluidcarve clean --older 7d --shot sh010 "
         "--dry-run"},
        {"nodes",
         "  fluidcarve nodes\n  fluidcarve nodes mask\n  fluidcarve nodes seam.pyramid\n  "
         "fluidcarve nodes acme.sparkle --plugin build/acme_sparkle.so"},
        {"new-node",
         "  fluidcarve new-node acme.sparkle\n  fluidcarve new-node acme.straight --solver "
         "--folder /shows/ab/straight\n  fluidcarve new-node acme.glow --python"},
        {"schema",
         "  fluidcarve schema > schema.json      named in a pipeline's first line:\n"
         "  # yaml-language-server: $schema=schema.json"},
        {"graph", "  fluidcarve graph shot.yaml --format svg > shot.svg"},
        {"inspect",
         "  fluidcarve inspect /shots/sh010/*.vdb\n"
         "  fluidcarve inspect /shots/sh010/smoke.####.vdb      the sequence as one\n"
         "  fluidcarve inspect /shots/sh010                     all files of a folder"},
        {"diff",
         "  fluidcarve diff before.####.vdb after.####.vdb\n"
         "  fluidcarve diff before.####.vdb after.####.vdb -f 51-56 --fail 1e-4 --fail-percent 0.1 "
         "--picture worst.png\n"
         "  fluidcarve diff out/monday out/tuesday --json"},
        {"explain",
         "  fluidcarve explain out/plume.0051.vdb\n  fluidcarve explain --json out/sheet.png"},
        {"man", "  fluidcarve man | man -l -"},
        {"completion",
         "  source <(fluidcarve completion bash)      in ~/.bashrc\n"
         "  source <(fluidcarve completion zsh)       in ~/.zshrc, after compinit\n"
         "  fluidcarve completion fish | source       in ~/.config/fish/config.fish"}};
    for (auto* const verb : app.get_subcommands([](CLI::App*) { return true; }))
        if (const auto found = examples.find(verb->get_name()); found != examples.end()) {
            keep_lines(*verb->get_formatter());
            verb->footer(std::string("Examples:\n") + found->second);
        }
}

}  // namespace fluidcarve
