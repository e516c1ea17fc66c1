// How carved sequences look, scene by scene, beside the same sequences scaled evenly.
//
//   build/look [--no-loop] [--scene NAME]... [FOLDER] [OUT]
//       all shipped scenes on plume/, vortex/, bonfire/, torch/, trail/ and images/ of the
//                                                              folder (tests/data): OUT.md,
//                                                              OUT.png, OUT_pairs.png (out/look)
//
// --scene NAME: only this pipeline; --no-loop: without the paper's method, which takes most of the
// time.

#include "graph/types/param.h"
#include "tests/bench/carved.h"
#include "tests/bench/look_picture.h"
#include "tests/bench/lqr_carve.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace {

/// The scenes and their counts along u. The first is a fifth, or what is shipped; the last two, as
/// narrow and as wide as shots ask for, or as there is room for, are shown frame by frame.
const std::vector<Scene> scenes{
    {"plume", "sim", "plume/plume.####.vdb", {"density"}, {"-8", "+8", "+14", "-14", "+21"}},
    {"plume",
     "sim",
     "plume_fine/plume.####.vdb",
     {"density"},
     {"-20", "+20", "-33", "+49"},
     "fine"},
    {"plume_ax", "sim", "plume/plume.####.vdb", {"density"}, {"-8", "+8"}},
    {"plume_path", "sim", "plume/plume.####.vdb", {"density"}, {"-5", "+5"}},
    {"vortex", "sim", "vortex/vortex.####.vdb", {"density"}, {"-6", "+6", "-8", "+10"}},
    {"bonfire", "sim", "bonfire/bonfire.####.vdb", {"flame"}, {"-4", "+5"}},
    {"bonfire_hot", "sim", "bonfire/bonfire.####.vdb", {"density"}, {"-8", "+8"}},
    {"trail", "sim", "trail/trail.####.vdb", {"density"}, {"-3", "+3"}},
    {"torch", "sim", "torch/torch.####.vdb", {"flame"}, {"-10", "+10"}},
    {"image", "photo", "images/*", {}, {"-20%", "+20%", "-33%", "+50%"}},
    {"image_ring", "photo", "images/chelsea.png", {"R", "G", "B"}, {"-8", "+12"}},
};

constexpr auto about =
    "- shipped: the pipeline as it is.\n"
    "- the paper's: the same energy carved by the paper's method. Empty space gets a price by a "
    "mask (0.5, content 0.3 more than its energy). Multi-greedy "
    "seams pay backward costs, whole vertices move. To narrow, each seam is carved "
    "from the files that the one before left; to widen, all are found at once, since a loop would "
    "double the same seam again and again.\n"
    "- warp: the shipped pipeline with warp.solve in place of its solver.\n"
    "- both: as many of the shipped seams as seams.choose keeps, and a warp for the rest.\n"
    "- liblqr's: images carved by liblqr as it comes.\n"
    "\n"
    "Each figure is a share: below 1 is better than even scaling to the same visible width. Even "
    "scaling is done by the shipped pipeline, too, with a warp of "
    "even weights. Samples stand at the lattice's vertices.\n"
    "\n"
    "- coherence: what is in the result comes from the input. Root mean square distance from each "
    "patch of the result to the nearest patch of the input; "
    "patches of 5, 9 and 15 vertices.\n"
    "- completeness: what is in the input is in the result. The other way round.\n"
    "- time: coherence of patches of 7 vertices that last 5 frames; only of 5 frames or more.\n"
    "- mean, worst: of all figures before.\n"
    "- flicker: second difference in time per mass, as a share of the input's own; only of 3 "
    "frames or more.\n"
    "- jagged: second difference along the carved axis per mass, as a share of the input's own.\n"
    "- mass: the sum of all samples, as a share of even scaling's.\n"
    "- resized: by how much what is visible became narrower or wider, as a share of what scaling "
    "all of the lattice would do. A carve that takes only "
    "empty space looks perfect and resizes nothing.\n"
    "- form: how much of the shape of details is kept. 1: they are as long along the carved axis, "
    "by their correlation, relative to the other axes, as "
    "before; 0: they changed as much as under even scaling.\n"
    "- repeated: patches of 7 vertices that have their like beside them, as a share of those under "
    "even scaling. A comb of copies has many.\n"
    "- lost: patches of 9 vertices of the input that have nothing near to them in the result, as a "
    "share of those under even scaling. A crop has many.\n"
    "\n"
    "Visible is what exceeds 0.02 of the value that one sample in a thousand exceeds. Where seams "
    "come in pairs the lattice keeps its size: even scaling then "
    "stretches one window evenly and presses the other together, and nothing is resized. `river` "
    "is not measured: its paper method would need particles, "
    "surface and banks to be carved and read again for each seam.\n";

std::string number(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? fmt::format("{:.2f}", *value) : "-";
}

std::string numbers(const std::vector<double>& values) {
    std::vector<std::string> out;
    for (const double value : values) out.push_back(number(value));
    return fmt::format("{}", fmt::join(out, " "));
}

/// A mean of what there is.
class Mean {
public:
    void add(const std::optional<double>& value) {
        if (!value || !std::isfinite(*value)) return;
        sum_ += *value;
        ++count_;
    }
    std::optional<double> value() const {
        return count_ > 0 ? std::optional(sum_ / count_) : std::nullopt;
    }

private:
    double sum_ = 0;
    int count_ = 0;
};

class Table {
public:
    explicit Table(const std::string& path) : page_(path) {
        page_ << "# How carves look beside even scaling\n\n" << about << "\n";
        page_ << "| scene | count | | coherence | completeness | time | mean | worst | flicker | "
                 "jagged | mass | resized | form | repeated | lost |\n"
                 "|---|--:|---|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";
        print("scene", "count", "", "coherence", "completeness", "time", "mean", "worst", "flicker",
              "jagged", "mass", "resized", "form", "repeated", "lost");
    }

    void add(const std::string& scene, int count, const std::string& contender,
             const Looks& looks) {
        const std::vector<double> space(looks.coherence.begin(), looks.coherence.begin() + 3);
        const auto time =
            looks.coherence.size() > 3 ? std::optional(looks.coherence[3]) : std::nullopt;
        const Figures figures{time,           looks.mean(), looks.worst(), looks.flicker,
                              looks.jagged,   looks.mass,   looks.resized, looks.form,
                              looks.repeated, looks.lost};
        row(scene, fmt::format("{:+}", count), contender, numbers(space),
            numbers(looks.completeness), figures);
        auto means = std::ranges::find(means_, contender, &Means::contender);
        if (means == means_.end()) means = means_.insert(means_.end(), {contender, {}});
        for (std::size_t n = 0; n < figures.size(); ++n) means->figures[n].add(figures[n]);
    }

    void add_means() {
        for (const auto& [contender, means] : means_) {
            Figures figures;
            std::ranges::transform(means, figures.begin(), &Mean::value);
            row("mean of all", "", contender, "", "", figures);
        }
    }

    bool good() const { return page_.good(); }

private:
    static constexpr std::size_t count_of_figures = 10;
    using Figures = std::array<std::optional<double>, count_of_figures>;

    template <class... Texts>
    static void print(const Texts&... texts) {
        fmt::print(
            "{:<17} {:>5} {:<16} {:<15} {:<15} {:>5} {:>5} {:>5} {:>7} {:>6} {:>5} {:>7} {:>5} "
            "{:>8} {:>5}\n",
            texts...);
        std::fflush(stdout);
    }
    void row(const std::string& scene, const std::string& count, const std::string& contender,
             const std::string& coherence, const std::string& completeness,
             const Figures& figures) {
        std::array<std::string, count_of_figures> texts;
        std::ranges::transform(figures, texts.begin(), number);
        page_ << fmt::format("| {} | {} | {} | {} | {} | {} |\n", scene, count, contender,
                             coherence, completeness, fmt::join(texts, " | "));
        std::apply(
            [&](const auto&... text) {
                print(scene, count, contender, coherence, completeness, text...);
            },
            texts);
    }

    struct Means {
        std::string contender;
        std::array<Mean, count_of_figures> figures;
    };
    std::ofstream page_;
    std::vector<Means> means_;
};

/// @param width  vertices along u
int count_of(const std::string& stated, int width) {
    return fluidcarve::Count{std::stod(stated), stated.ends_with('%')}.of(width);
}

/// Even scaling until as much is visible along u as in a result.
Samples even_until(const Shot& shot, double wanted, const Samples& source) {
    const float visible = visible_from(source);
    const double before = visible_width(source, visible),
                 most = static_cast<double>(source.shape[0]) - 2;
    const auto scaled = [&](double amount) {
        return samples_after(shot.scene, scale_evenly(shot, amount),
                             static_cast<int>(std::ceil(amount)));
    };
    double amount = (wanted / before - 1) * static_cast<double>(source.shape[0] - 1);
    auto out = scaled(amount);
    // What is thin fades as it is pressed together, and a rim holds what is near it: so the width
    // is no exact share of the amount.
    constexpr int most_steps = 6;
    constexpr double close = 0.02;  // vertices
    for (int step = 0; step < most_steps; ++step) {
        const double changed = visible_width(out, visible) - before;
        if (std::abs(before + changed - wanted) < close || changed * (wanted - before) <= 0) break;
        amount = std::clamp(amount * (wanted - before) / changed, -most, most);
        out = scaled(amount);
    }
    return out;
}

/// Even scaling to the visible width of a result. Of seam pairs: the first window evenly stretched
/// to its new size, the second to what is left for it.
Samples even_for(const Shot& shot, const Samples& result, const Samples& source,
                 const Carved& carved, int count) {
    if (!carved.windows)
        return even_until(shot, visible_width(result, visible_from(source)), source);
    const auto [first, last, pair_first, pair_last] = *carved.windows;
    return stretched(source, source.shape[0], [=](double i) {
        if (i <= first || i >= pair_last) return i;
        if (i <= last + count) return first + (i - first) * (last - first) / (last - first + count);
        if (i <= pair_first + count) return i - count;
        return pair_last -
               (pair_last - i) * (pair_last - pair_first) / (pair_last - pair_first - count);
    });
}

/// What is seen of a shot at one count.
struct Seen {
    LookRow contenders;          ///< in the middle frame
    std::vector<LookRow> pairs;  ///< before, scaled evenly, shipped: frame by frame
};

constexpr std::size_t most_frames = 6;

LookRow frame_by_frame(const std::string& title, const Samples& samples, const Shot& shot) {
    LookRow out{title, {}, {}};
    const auto shown = std::min(samples.frames, most_frames), first = (samples.frames - shown) / 2;
    for (auto t = first; t < first + shown; ++t) {
        out.samples.push_back(frame_of(samples, t));
        out.names.push_back(shot.range
                                ? fmt::format("frame {}", shot.range->first + static_cast<int>(t))
                                : std::string());
    }
    return out;
}

/// Measures a shot at one count.
Seen measure(const Shot& shot, const std::string& stated, bool loop, Table& table) {
    const auto& scene = shot.scene;
    const auto shipped = carve_as_shipped(shot, stated);
    const auto source = samples_before(scene, shipped);
    const int count = count_of(stated, static_cast<int>(source.shape[0])),
              grown = shipped.windows ? 0 : count;
    const auto middle = source.frames / 2;
    const auto title = fmt::format("{}, {:+}", shot.name, count);
    LookRow out{title, {frame_of(source, middle)}, {"before"}};
    const auto add = [&](const std::string& contender, const Samples& result) {
        const auto even = even_for(shot, result, source, shipped, count);
        table.add(shot.name, count, contender, looks_of(result, source, even, std::abs(count)));
        out.samples.push_back(frame_of(result, middle));
        out.names.push_back(contender);
        return even;
    };
    if (loop)
        add("the paper's",
            samples_after(scene, carve_as_paper(shot, count, shipped.lattices), grown));
    if (scene.pipeline == "image")
        add("liblqr's", carve_by_lqr(source, source.shape[0] + static_cast<std::size_t>(grown)));
    add("warp", samples_after(scene, carve_by_warp(shot, stated), grown));
    if (const auto both = carve_by_both(shot, stated))
        add("both", samples_after(scene, *both, grown));
    const auto result = samples_after(scene, shipped, grown);
    const auto even = add("shipped", result);
    out.samples.insert(out.samples.begin() + 1, frame_of(even, middle));
    out.names.insert(out.names.begin() + 1, "scaled evenly");
    return {std::move(out),
            {frame_by_frame(title + ": before", source, shot),
             frame_by_frame(title + ": scaled evenly", even, shot),
             frame_by_frame(title + ": shipped", result, shot)}};
}

void look(const std::vector<std::string>& wanted, bool loop, const std::string& folder,
          const std::string& out) {
    if (const auto above = std::filesystem::path(out).parent_path(); !above.empty())
        std::filesystem::create_directories(above);
    Table table(out + ".md");
    std::vector<LookRow> rows, pairs;
    for (const auto& scene : scenes) {
        if (!wanted.empty() && std::ranges::find(wanted, scene.pipeline) == wanted.end()) continue;
        const auto shots = find_shots(scene, folder);
        if (shots.empty())
            fmt::print(stderr, "{} is left out: there is no {} in {}\n", scene.pipeline,
                       scene.files, folder);
        for (const auto& shot : shots)
            for (const auto* const count : scene.counts) {
                auto seen = measure(shot, count, loop, table);
                if (count == scene.counts.front()) rows.push_back(std::move(seen.contenders));
                if (count == scene.counts.back() || count == scene.counts.rbegin()[1])
                    std::ranges::move(seen.pairs, std::back_inserter(pairs));
            }
    }
    if (rows.empty()) throw std::runtime_error("there is nothing to look at");
    table.add_means();
    if (!table.good()) throw std::runtime_error(out + ".md can't be written");
    draw_looks(rows, out + ".png");
    draw_looks(pairs, out + "_pairs.png");
    fmt::print("\nwritten: {0}.md, {0}.png, {0}_pairs.png\n", out);
}

}  // namespace

int main(int argc, char** argv) {
    openvdb::initialize();
    std::vector<std::string> words(argv + 1, argv + argc), wanted;
    const bool loop = std::erase(words, "--no-loop") == 0;
    for (auto at = words.begin();
         (at = std::find(at, words.end(), "--scene")) != words.end() && at + 1 != words.end();) {
        wanted.push_back(at[1]);
        at = words.erase(at, at + 2);
    }
    const auto known = [](const std::string& name) {
        return std::ranges::find(scenes, name, &Scene::pipeline) != scenes.end();
    };
    const bool option_left =
        std::ranges::any_of(words, [](const std::string& word) { return word.starts_with("-"); });
    if (words.size() > 2 || option_left || !std::ranges::all_of(wanted, known)) {
        std::vector<std::string> names;
        std::ranges::transform(scenes, std::back_inserter(names), &Scene::pipeline);
        fmt::print(stderr, "look [--no-loop] [--scene NAME]... [FOLDER] [OUT]\nscenes: {}\n",
                   fmt::join(names, ", "));
        return 2;
    }
    try {
        look(wanted, loop, words.empty() ? SOURCE_ROOT "/tests/data" : words[0],
             words.size() < 2 ? "out/look" : words[1]);
    } catch (const std::exception& failure) {
        fmt::print(stderr, "{}\n", failure.what());
        return 1;
    }
    return 0;
}
