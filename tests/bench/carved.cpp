#include "tests/bench/carved.h"

#include "graph/document.h"
#include "graph/pipeline.h"
#include "graph/types/file_fields.h"
#include "nodes/catalogue.h"
#include "tests/bench/bench_run.h"
#include "tests/support/scratch.h"

#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <thread>

using namespace fluidcarve;
using openvdb::Vec3d;

namespace {

Carved recorded;
std::vector<Ref<Lattice>> given;  ///< of each frame

/// Keeps what comes by.
struct Record {
    struct Ports {
        Ref<Volume> before, after;
        Ref<Lattice> lattice;
    };
    void add(const detail::NoParams&, const Ports& io, Context&) {
        recorded.before.push_back(io.before);
        recorded.after.push_back(io.after);
        recorded.lattices.push_back(io.lattice);
    }
    void finish(const detail::NoParams&, Ports&, Context&) {}
};

/// In place of a lattice's own node.
struct Given {
    struct Ports {
        Ref<Lattice> lattice;
    };
    static NodeTraits traits(const detail::NoParams&) {
        return {.animates = std::ranges::any_of(given, [](const auto& lattice) {
                    return lattice->hash != given.front()->hash;
                })};
    }
    static void run(const detail::NoParams&, Ports& io, Context& context) {
        io.lattice = given.at(context.t());
    }
};

Registry registry_of_looks() {
    auto out = builtin_registry();
    out.add(Declare<Record>("look.record", "Keeps what comes by.")
                .input("before", &Record::Ports::before, "The input.")
                .input("after", &Record::Ports::after, "The result.")
                .input("lattice", &Record::Ports::lattice, "What was carved."));
    out.add(Declare<Given>("look.lattice", "A lattice from elsewhere.")
                .output("lattice", &Given::Ports::lattice, "The lattice."));
    return out;
}

void set(Value& map, const std::string& name, Value value) {
    map.kind = Value::Kind::map;
    if (auto* const field = map.find(name)) field->value = std::move(value);
    else map.fields.push_back({name, map.mark, std::move(value)});
}

void set(Value& map, const std::string& name, const std::string& text) {
    set(map, name, Value::scalar(map.mark, text));
}

Value& node_of(Document& document, const std::string& name) {
    auto* const field = document.nodes.find(name);
    if (!field) throw std::runtime_error(fmt::format("{} has no node '{}'", document.name, name));
    return field->value;
}

const std::string& to_text(Value& node, const std::string& field) {
    const auto* const found = node.find(field);
    if (!found)
        throw std::runtime_error(fmt::format("a node without '{}' where one is looked for", field));
    return found->value.text;
}

Document document_of(const Shot& shot, const std::string& input, const std::string& count,
                     const std::string& out) {
    std::vector<std::string> settings{shot.scene.input + "=" + input, "count=" + count};
    if (!out.empty()) settings.push_back("out=" + out);
    if (shot.range)
        settings.push_back(fmt::format("frames={}-{}", shot.range->first, shot.range->second));
    return document_in(fmt::format("{}/pipelines/{}.yaml", SOURCE_ROOT, shot.scene.pipeline),
                       settings);
}

/// Runs a document up to one of its nodes.
void run(const Document& document, const Registry& registry, const std::string& to,
         const Scratch& scratch) {
    auto request = quiet_request(std::uint64_t{1} << 33);
    request.options.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    request.options.in_flight = request.options.threads + 1;
    request.options.work_folder = scratch / "work";
    request.target.to = to;
    run_to_end(pipeline_of(document, registry), registry, request);
}

/// Runs a document up to its carve, and keeps what that made.
Carved record(Document document, const Registry& registry, const std::string& input,
              const Scratch& scratch) {
    recorded = {};
    Value node;
    node.mark = document.mark;
    set(node, "type", "look.record");
    set(node, "before", input);
    set(node, "after", "carved");
    set(node, "lattice", to_text(node_of(document, "seams"), "lattice"));
    set(document.nodes, "look_record", std::move(node));
    run(document, registry, "look_record", scratch);
    return std::exchange(recorded, {});
}

/// First and last vertex of both windows, if seams come in pairs.
std::optional<std::array<double, 4>> windows_of(Document& document) {
    auto& seams = node_of(document, "seams");
    const auto *const window = seams.find("window"), *const pair = seams.find("pair_window");
    if (!window || !pair) return std::nullopt;
    const auto number = [](const Value& value) { return std::stod(value.text); };
    return std::array{number(window->value.items.at(0)), number(window->value.items.at(1)),
                      number(pair->value.items.at(0)), number(pair->value.items.at(1))};
}

Value list_value(const std::vector<std::string>& texts, const Mark& mark) {
    Value out;
    out.kind = Value::Kind::list;
    out.mark = mark;
    for (const auto& text : texts) out.items.push_back(Value::scalar(mark, text));
    return out;
}

/// Gives empty space a price by a mask over the energy, as the paper's pipelines do, where the
/// shipped solver's own (`empty`) does: without one, all seams would pass beside the smoke.
/// @param field  what is looked at
/// @param seams  the solver, which gets the new energy
void price_empty_space(Document& document, Value& seams, const std::string& field) {
    Value seen, energy;
    seen.mark = energy.mark = document.mark;
    set(seen, "type", "mask.threshold");
    set(seen, "field", field);
    set(seen, "above", "0.02");
    set(energy, "type", "mask.weight");
    set(energy, "energy", to_text(seams, "energy"));
    set(energy, "masks", list_value({"look_seen"}, document.mark));
    set(energy, "weights", list_value({"0.3"}, document.mark));
    set(energy, "outside", "0.5");
    set(seams, "energy", "look_energy");
    set(document.nodes, "look_seen", std::move(seen));
    set(document.nodes, "look_energy", std::move(energy));
}

/// Takes away what a node's type does not have.
void keep_what_is_of(const NodeType& type, Value& node) {
    std::erase_if(node.fields, [&](const Value::Field& field) {
        return !find_field(common_fields, field.name) && !type.input(field.name) &&
               !type.param(field.name);
    });
}

/// Gives each solver and each carve the settings of classical seam carving, of those that its type
/// has.
void make_classical(Document& document, const Registry& registry) {
    auto& seams = node_of(document, "seams");
    set(seams, "type", "seam.greedy");
    const auto* const field = seams.find("field");
    const auto seen = field ? field->value.text : std::string();
    std::erase_if(seams.fields, [&](const Value::Field& field) {
        return field.name == "field" || field.name == "field_weight" || field.name == "empty";
    });
    keep_what_is_of(*registry.node("seam.greedy"), seams);
    if (!seen.empty()) price_empty_space(document, node_of(document, "seams"), seen);
    for (auto& [name, mark, node] : document.nodes.fields) {
        const auto type = to_text(node, "type");
        const auto* const known = registry.node(type);
        if (!known || !(type.starts_with("seam.") || type.starts_with("remap."))) continue;
        for (const auto& [param, value] :
             {std::pair("cost", "backward"), std::pair("rigidity", "0"),
              std::pair("rigidity_time", "0"), std::pair("spread", "0"), std::pair("soft", "0")})
            if (known->param(param)) set(node, param, value);
    }
}

/// Windows after the first seams: they, and the space between them, are as large as those left
/// them.
void move_windows(Value& seams, int grown) {
    const auto shift = [&](const char* name, std::size_t end) {
        if (auto* const window = seams.find(name); window && window->value.items.size() == 2) {
            auto& text = window->value.items[end].text;
            text = fmt::format("{}", std::stoi(text) + grown);
        }
    };
    shift("window", 1);
    shift("pair_window", 0);
}

/// Runs a shot's pipeline with another solver.
/// @param change  changes the node
template <class Change>
Carved carve_otherwise(const Shot& shot, const Change& change) {
    const Scratch scratch;
    auto document = document_of(shot, shot.files, "0", "");
    const auto registry = registry_of_looks();
    auto& seams = node_of(document, "seams");
    change(seams);
    keep_what_is_of(*registry.node(to_text(seams, "type")), seams);
    auto out = record(document, registry, shot.scene.input, scratch);
    out.windows = windows_of(document);
    return out;
}

/// Puts the lattices that the first carves left in place of the document's own.
/// @param grown  vertices along u, unless seams come in pairs
void give_what_is_left(Document& document, const std::vector<Ref<Lattice>>& lattices, int grown) {
    const bool pairs = windows_of(document).has_value();
    given.clear();
    for (const auto& lattice : lattices) {
        auto left = std::make_shared<Lattice>(*lattice);
        if (!pairs) left->shape[0] += grown;
        left->hash = lattice_hash(*left);
        given.push_back(std::move(left));
    }
    Value node;
    node.mark = document.mark;
    set(node, "type", "look.lattice");
    set(document.nodes, to_text(node_of(document, "seams"), "lattice"), std::move(node));
}

/// What is seen in a frame.
class Sampler {
public:
    Sampler(const Scene& scene, const Volume& volume) {
        auto names = scene.grids;
        if (names.empty())
            for (const auto& grid : volume.grids) names.push_back(grid->getName());
        for (const auto& name : names) {
            const auto grid = openvdb::GridBase::grid<FloatGrid>(volume.find(name));
            if (!grid)
                throw std::runtime_error(
                    fmt::format("{} has no grid '{}' of floats", scene.pipeline, name));
            grids_.push_back(grid);
        }
    }
    /// The mean of the grids at a world position, trilinear.
    float operator()(const Vec3d& world) const {
        float sum = 0;
        for (const auto& grid : grids_)
            sum += openvdb::tools::BoxSampler::sample(grid->tree(), grid->worldToIndex(world));
        return sum / static_cast<float>(grids_.size());
    }

private:
    std::vector<FloatGrid::ConstPtr> grids_;
};

/// @param first  along u
Samples sampled(const Scene& scene, const std::vector<Ref<Volume>>& volumes,
                const std::vector<Ref<Lattice>>& lattices, int first, int width) {
    const auto& lattice = *lattices.at(0);
    const auto laterals = static_cast<std::size_t>(lattice.shape[1]),
               slices = static_cast<std::size_t>(lattice.shape[2]);
    Samples out(volumes.size(), {static_cast<std::size_t>(width), laterals, slices}, lattice.closed,
                lattice.around);
    for (std::size_t t = 0; t < volumes.size(); ++t) {
        const Sampler value(scene, *volumes[t]);
        tbb::parallel_for(std::size_t{0}, slices, [&](std::size_t k) {
            for (std::size_t j = 0; j < laterals; ++j)
                for (int i = 0; i < width; ++i)
                    out.row(j + laterals * (k + slices * t))[i] = value(lattices[t]->position(
                        Vec3d(first + i, static_cast<double>(j), static_cast<double>(k))));
        });
    }
    return out;
}

Samples part_of(const Samples& wide, std::size_t first, std::size_t width) {
    return stretched(wide, width, [&](double i) { return i + static_cast<double>(first); });
}

}  // namespace

std::vector<Shot> find_shots(const Scene& scene, const std::string& folder) {
    namespace fs = std::filesystem;
    const auto path = fs::absolute(folder) / scene.files;
    const auto title =
        scene.data.empty() ? scene.pipeline : fmt::format("{} {}", scene.pipeline, scene.data);
    const auto name = path.filename().string();
    if (name.find('#') == name.npos && name != "*")
        return fs::exists(path) ? std::vector{Shot{scene, title, path.string(), std::nullopt}}
                                : std::vector<Shot>{};
    std::error_code missing;
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(path.parent_path(), missing))
        files.push_back(entry.path().filename().string());
    std::ranges::sort(files);
    std::vector<Shot> out;
    if (name == "*") {
        for (const auto& file : files)
            if (const auto kind = fs::path(file).extension(); kind == ".png" || kind == ".jpg")
                out.push_back({scene, fmt::format("{} {}", title, fs::path(file).stem().string()),
                               path.parent_path() / file, std::nullopt});
        return out;
    }
    const auto token = name.find("####");
    for (const auto& file : files) {
        if (file.size() != name.size() || !file.starts_with(name.substr(0, token)) ||
            !file.ends_with(name.substr(token + 4)))
            continue;
        const int frame = std::atoi(file.c_str() + token);
        if (out.empty()) out.push_back({scene, title, path.string(), std::pair(frame, frame)});
        out.front().range->second = frame;
    }
    return out;
}

Carved carve_as_shipped(const Shot& shot, const std::string& count) {
    const Scratch scratch;
    auto document = document_of(shot, shot.files, count, "");
    auto out = record(document, registry_of_looks(), shot.scene.input, scratch);
    out.windows = windows_of(document);
    return out;
}

Carved carve_as_paper(const Shot& shot, int count, const std::vector<Ref<Lattice>>& lattices) {
    const Scratch scratch;
    const auto registry = registry_of_looks();
    const int step = count < 0 ? -1 : count;
    auto from = shot.files;
    for (int done = 0;; done += step) {
        const auto to =
            scratch / (done % 2 == 0 ? "even" : "odd") + (shot.range ? ".####.vdb" : ".png");
        auto document = document_of(shot, from, std::to_string(step), to);
        give_what_is_left(document, lattices, done);
        make_classical(document, registry);
        move_windows(node_of(document, "seams"), done);
        if (done + step == count) {
            auto out = record(document, registry, shot.scene.input, scratch);
            out.lattices = lattices;
            return out;
        }
        run(document, registry, "out", scratch);
        from = to;
    }
}

Carved carve_by_warp(const Shot& shot, const std::string& count) {
    return carve_otherwise(shot, [&](Value& seams) {
        set(seams, "type", "warp.solve");
        set(seams, "amount", count);
    });
}

std::optional<Carved> carve_by_both(const Shot& shot, const std::string& count) {
    const Scratch scratch;
    auto document = document_of(shot, shot.files, count, "");
    if (windows_of(document)) return std::nullopt;
    const auto registry = registry_of_looks();
    auto rest = node_of(document, "seams");
    const auto* const field = rest.find("field");
    if (!field) return std::nullopt;
    Value chosen;
    chosen.mark = document.mark;
    set(chosen, "type", "seams.choose");
    set(chosen, "seams", "seams");
    set(chosen, "field", field->value.text);
    set(chosen, "lattice", to_text(rest, "lattice"));
    set(rest, "type", "warp.solve");
    set(rest, "amount", count);
    set(rest, "rest", "true");
    set(rest, "after", list_value({"look_chosen"}, document.mark));
    // A window would count what the seams leave.
    std::erase_if(rest.fields, [](const Value::Field& each) { return each.name == "window"; });
    keep_what_is_of(*registry.node("warp.solve"), rest);
    set(node_of(document, "carved"), "seams",
        list_value({"look_chosen", "look_rest"}, document.mark));
    set(document.nodes, "look_chosen", std::move(chosen));
    set(document.nodes, "look_rest", std::move(rest));
    return record(std::move(document), registry, shot.scene.input, scratch);
}

Carved scale_evenly(const Shot& shot, double amount) {
    return carve_otherwise(shot, [&](Value& seams) {
        std::erase_if(seams.fields, [](const Value::Field& field) {
            return field.name != "energy" && field.name != "lattice" && field.name != "anchor";
        });
        set(seams, "type", "warp.solve");
        set(seams, "amount", fmt::format("{:.6f}", amount));
        // So even that neither energies nor edges count.
        set(seams, "evenness", "1e4");
        set(seams, "empty", "1");
    });
}

Samples samples_before(const Scene& scene, const Carved& carved) {
    return sampled(scene, carved.before, carved.lattices, 0, carved.lattices.at(0)->shape[0]);
}

Samples samples_after(const Scene& scene, const Carved& carved, int grown) {
    // Around a rig there is nothing before the low end.
    const auto& lattice = *carved.lattices.at(0);
    const int before = lattice.shape[0], low = lattice.around ? 0 : std::min(0, -grown);
    const auto width = static_cast<std::size_t>(before + grown);
    const auto wide =
        sampled(scene, carved.after, carved.lattices, low, before + std::max(0, grown) - low);
    std::vector<double> along(wide.shape[0]);
    for (std::size_t r = 0; r < wide.rows(); ++r)
        for (std::size_t i = 0; i < along.size(); ++i) along[i] += wide.row(r)[i];
    const auto held = [&](std::size_t first) {
        const auto begin = along.begin() + static_cast<std::ptrdiff_t>(first);
        return std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(width), 0.0);
    };
    auto best = static_cast<std::size_t>(-low);
    for (std::size_t first = 0; first + width <= along.size(); ++first)
        if (held(first) > 1.01 * held(best)) best = first;
    return part_of(wide, best, width);
}
