#include "carve/solver/costs/frame_energy.h"
#include "carve/solver/dynamic.h"
#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "carve/volume/volume.h"
#include "nodes/payload/add_payloads.h"
#include "nodes/seam.h"
#include "nodes/solving/declare_solver.h"
#include "tests/support/reference_carve.h"
#include "tests/support/scratch.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

#include <random>
#include <sstream>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// What solvers keep of a frame, and of a search: more seams are found from fewer, and fewer are a
// part of more.

namespace {

using Frames = std::vector<FloatGrid::Ptr>;

Frames noise_in_quarters(std::mt19937& random, const std::array<int, 3>& shape,
                         std::size_t frames) {
    Frames out;
    for (std::size_t t = 0; t < frames; ++t)
        out.push_back(
            energy_grid(CoordBBox(Coord(0), Coord(shape[0] - 1, shape[1] - 1, shape[2] - 1)),
                        [&](const Coord&) { return static_cast<float>(random() % 256) / 4; }));
    return out;
}

/// Waves that drift, so that seams from coarse to fine have something to follow.
Frames waves(const std::array<int, 3>& shape, std::size_t frames) {
    Frames out;
    for (std::size_t t = 0; t < frames; ++t)
        out.push_back(energy_grid(
            CoordBBox(Coord(0), Coord(shape[0] - 1, shape[1] - 1, shape[2] - 1)),
            [&](const Coord& at) {
                const double phase =
                    0.31 * at.x() + 0.17 * at.y() - 0.23 * at.z() + 0.4 * static_cast<double>(t);
                return static_cast<float>(2 + std::sin(phase) + std::sin(0.7 * at.x() * phase));
            }));
    return out;
}

MaskGrid::Ptr cube(const Coord& low, const Coord& high) {
    std::vector<Coord> voxels;
    for (auto at = CoordBBox(low, high).begin(); at; ++at) voxels.push_back(*at);
    return mask_grid(voxels);
}

/// A task for a solver, but for the count.
struct Task {
    std::string name;
    NodeType (*solver)();
    std::string params;  ///< ", window: [1, 6]"
    Frames energy;
    Lattice lattice;
    Grids grids = {};
    std::vector<Ref<Seams>> after = {};
    int most = 4;
    std::vector<int> counts{0, 1, 3};  ///< of which `most` are continued
};

constexpr std::size_t frame_count = 3;

Solved solve(const Task& task, int count, const Otherwise& otherwise = {}) {
    return fluidcarve::test::solve(task.solver(),
                                   fmt::format("{{count: {}{}}}", count, task.params), task.energy,
                                   {task.lattice}, task.grids, frame_count, task.after, otherwise);
}

Solved go_on(const Task& task, int count, const Ref<Seams>& before,
             const nlohmann::ordered_json& reported) {
    Otherwise otherwise;
    otherwise.before = before;
    otherwise.reported = reported;
    return solve(task, count, otherwise);
}

void require_same_bounds(const std::vector<Seams::Seam>& got,
                         const std::vector<Seams::Seam>& want) {
    REQUIRE(got.size() == want.size());
    for (std::size_t n = 0; n < got.size(); ++n) {
        REQUIRE(got[n].at == want[n].at);
        CHECK(got[n].energy == want[n].energy);
        CHECK(got[n].lower_bound == want[n].lower_bound);
    }
}

void require_same_bounds(const Seams& got, const Seams& want) {
    require_same_bounds(got.seams, want.seams);
    require_same_bounds(got.pairs, want.pairs);
    CHECK(got.axis == want.axis);
    CHECK(got.kind == want.kind);
    CHECK(got.closed == want.closed);
    CHECK(got.shape == want.shape);
    CHECK(got.frames == want.frames);
    CHECK(got.lattice == want.lattice);
    CHECK(got.lattice_hash == want.lattice_hash);
}

/// But for how long it took.
void check_same_report(nlohmann::ordered_json got, nlohmann::ordered_json want) {
    CHECK(got.at("wall_s").size() == want.at("wall_s").size());
    got.erase("wall_s");
    want.erase("wall_s");
    CHECK(got.dump() == want.dump());
}

const Growth& growth_of(const Task& task) {
    static std::map<NodeType (*)(), NodeType> types;
    return *types.try_emplace(task.solver, task.solver()).first->second.growth;
}

/// Holds what is there after each seam.
struct Eager : SeamNode {
    Eager() { checkpoint_after_ = std::chrono::milliseconds(0); }
    void finish(const Params& params, Ports& io, Context& context) {
        solve(params, io, context,
              [](const EnergyVolume& energy, Window window, int number, const Tick& tick) {
                  return greedy_seam(energy, window, number, 4, tick);
              });
    }
};

NodeType eager() {
    Declare<Eager> node("seam.eager", "");
    return declare_solver(node);
}

/// Seams that depend on nothing but the last.
class Walker {
public:
    Seams::Seam operator()(const EnergyVolume& energy, Window window, int number, const Tick&) {
        const auto columns = energy.columns_per_frame() * energy.frames();
        if (number == 0) last_.assign(columns, static_cast<std::uint16_t>(window.last));
        else
            for (std::size_t c = 0; c < columns; ++c)
                last_.at(c) = static_cast<std::uint16_t>(
                    window.first + (last_[c] * 3 + static_cast<int>(c) + 1) % window.size());
        return {last_, 0};
    }
    void start_from(std::span<const std::uint16_t> last) { last_.assign(last.begin(), last.end()); }

private:
    std::vector<std::uint16_t> last_;
};

struct Walking : SeamNode {
    void finish(const Params& params, Ports& io, Context& context) {
        Walker walker;
        solve(params, io, context, std::ref(walker),
              [&](std::span<const std::uint16_t> last) { walker.start_from(last); });
    }
};

NodeType walking() {
    Declare<Walking> node("seam.walking", "");
    return declare_solver(node);
}

std::vector<Task> tasks() {
    std::mt19937 random(1);
    const std::array<int, 3> shape{17, 5, 4};
    std::vector<Task> out;
    for (const auto& [name, solver] :
         {std::pair("greedy", &seam_greedy), std::pair("pyramid", &seam_pyramid),
          std::pair("graph_cut", &seam_graph_cut)}) {
        const auto add = [&, name = name, solver = solver](
                             const std::string& what, const std::string& params,
                             const Grids& grids = {}, const std::vector<Ref<Seams>>& after = {},
                             std::size_t energies = 3) {
            out.push_back({fmt::format("{}, {}", name, what), solver, params,
                           noise_in_quarters(random, shape, energies), box(shape), grids, after});
        };
        add("alone", "");
        add("a window, bounds", ", window: [2, 12], bound_passes: 3");
        add("pairs", ", window: [1, 7], pair_window: [9, 16]");
        add("static", ", static: true");
        add("one of a pair static", ", window: [1, 7], pair_window: [9, 16], pair_static: true");
        add("one energy for all frames", "", {}, {}, 1);
        add("rigid", ", rigidity: 3.5, rigidity_time: 2");
        const Grids masks{{"protect", {cube(Coord(2, 0, 0), Coord(3, 1, 3))}},
                          {"attract", {cube(Coord(8, 1, 0), Coord(11, 3, 2))}}};
        add("masks", "", masks);
        add("masks, static", ", static: true", masks);
        const auto field = noise_in_quarters(random, shape, 3);
        const Grids seen{{"field", {field.begin(), field.end()}}};
        add("forward", ", cost: forward", seen);
        add("forward pairs", ", cost: forward, window: [1, 7], pair_window: [9, 16]", seen);
        std::vector<Ref<Seams>> after;
        const std::vector<int> frames{5, 6, 7};
        after.push_back(std::make_shared<Seams>(
            random_seams(random, box(shape), shape, Axis::u, Seams::Kind::remove, 2, frames)));
        after.push_back(
            std::make_shared<Seams>(random_seams(random, box(shape), after[0]->shape_after(2),
                                                 Axis::v, Seams::Kind::insert, 2, frames)));
        add("after others", ", window: [2, 13]", masks, after);
        add("after others, forward", ", cost: forward", seen, after);
    }
    Lattice ring = box({12, 4, 6});
    ring.closed = true;
    for (const auto* params : {"", ", static: true", ", window: [1, 7], pair_window: [9, 16]",
                               ", window: [1, 7], pair_window: [9, 16], pair_static: true"})
        out.push_back({fmt::format("walking{}", params), walking, params,
                       noise_in_quarters(random, shape, 3), box(shape)});
    for (const auto* guide : {"cone", "gaussian"})
        out.push_back({fmt::format("greedy, {}", guide), seam_greedy,
                       fmt::format(", guide: {}", guide), noise_in_quarters(random, ring.shape, 3),
                       ring});
    for (const auto* kind : {", static: true", ", rigidity: 2, static: true"})
        out.push_back({"dynamic", seam_dynamic, kind, noise_in_quarters(random, {17, 9, 1}, 3),
                       box({17, 9, 1})});
    // Too large to be cut as a whole.
    for (const auto* params : {"", ", quality: draft, window: [3, 58]"})
        out.push_back({fmt::format("pyramid, coarse to fine{}", params),
                       &seam_pyramid,
                       params,
                       waves({60, 40, 40}, 3),
                       box({60, 40, 40}),
                       {},
                       {},
                       2,
                       {1}});
    return out;
}

Registry registry() {
    Registry out;
    add_grid_payloads(out);
    add_lattice_payloads(out);
    add_seams_payload(out);
    add_frame_energy_payload(out);
    return out;
}

std::string bytes_of(const Payload& payload) {
    std::ostringstream out;
    registry().payload(payload.type()).write(payload, out);
    return out.str();
}

}  // namespace

TEST_CASE(
    "more seams are found from fewer as they are from none, and fewer are the first of more") {
    for (const auto& task : tasks())
        for (const int sign : {-1, 1}) {
            const int most = task.most;
            const auto all = solve(task, sign * most);
            REQUIRE(all.seams->seams.size() == static_cast<std::size_t>(most));
            const auto& growth = growth_of(task);
            CHECK(growth.item_count(Payload(all.seams)).count == static_cast<std::size_t>(most));
            CHECK(growth.item_count(Payload(all.seams)).all_items ==
                  static_cast<std::size_t>(all.seams->before()));
            for (const int count : task.counts) {
                INFO(task.name << ", " << sign * count << " of " << sign * most);
                const auto some = solve(task, sign * count);
                auto entry = all.listener.entry;
                require_same_bounds(
                    *growth.first(Payload(all.seams), static_cast<std::size_t>(count), entry)
                         .as<Seams>(),
                    *some.seams);
                check_same_report(entry, some.listener.entry);
                const auto resumed = go_on(task, sign * most, some.seams, some.listener.entry);
                require_same_bounds(*resumed.seams, *all.seams);
                check_same_report(resumed.listener.entry, all.listener.entry);
                CHECK(resumed.listener.warnings == all.listener.warnings);
                const auto &walls = resumed.listener.entry.at("wall_s"),
                           &before = some.listener.entry.at("wall_s");
                CHECK(std::equal(before.begin(), before.end(), walls.begin()));
            }
        }
}

TEST_CASE("what is wished for of a result that grows") {
    const auto growth = *seam_greedy().growth;
    const auto of = [&](const std::string& yaml) {
        const NodeBench bench(seam_greedy(), yaml);
        return std::pair(growth.rest(bench.params()), growth.wanted(bench.params(), 40));
    };
    CHECK(growth.param == "count");
    CHECK(of("{count: -3}") == std::pair(std::string("remove"), std::size_t{3}));
    CHECK(of("{count: 3}") == std::pair(std::string("insert"), std::size_t{3}));
    CHECK(of("{count: -20%}") == std::pair(std::string("remove"), std::size_t{8}));
    CHECK(of("{count: 0}") == std::pair(std::string("remove"), std::size_t{0}));
}

TEST_CASE("a solver hands over what it has found while it looks for more") {
    std::mt19937 random(2);
    const std::array<int, 3> shape{17, 5, 4};
    const Grids masks{{"attract", {cube(Coord(8, 1, 0), Coord(11, 3, 2))}}};
    for (const std::string params :
         {"", ", static: true", ", window: [1, 7], pair_window: [9, 16]"})
        for (const int sign : {-1, 1}) {
            INFO(params << ", " << sign);
            const Task task{"",         eager, params, noise_in_quarters(random, shape, 3),
                            box(shape), masks};
            const bool paired = params.find("pair") != std::string::npos;
            const auto all = solve(task, sign * 4);
            REQUIRE(all.listener.checkpoints.size() == (paired ? 7 : 3));
            for (std::size_t n = 0; n < all.listener.checkpoints.size(); ++n) {
                const auto& [part, reported] = all.listener.checkpoints[n];
                // All pairs come before the first seam of the window.
                CHECK(part->pairs.size() == (paired ? std::min<std::size_t>(n + 1, 4) : 0));
                CHECK(part->seams.size() == (paired ? std::max<std::size_t>(n, 3) - 3 : n + 1));
                CHECK(reported.at("energy").size() == part->seams.size());
                auto want = all.listener.entry, got = reported;
                const auto first =
                    growth_of(task).first(Payload(all.seams), part->seams.size(), want).as<Seams>();
                require_same_bounds(
                    *growth_of(task).first(Payload(part), part->seams.size(), got).as<Seams>(),
                    *first);
                check_same_report(got, want);
                const auto resumed = go_on(task, sign * 4, part, reported);
                require_same_bounds(*resumed.seams, *all.seams);
                check_same_report(resumed.listener.entry, all.listener.entry);
                if (!part->seams.empty()) continue;
                const auto fewer = go_on(task, sign * 2, part, reported),
                           two = solve(task, sign * 2);
                require_same_bounds(*fewer.seams, *two.seams);
                check_same_report(fewer.listener.entry, two.listener.entry);
            }
            // What an earlier run found is not lost while pairs are looked for.
            const auto two = solve(task, sign * 2);
            const auto resumed = go_on(task, sign * 4, two.seams, two.listener.entry);
            require_same_bounds(*resumed.seams, *all.seams);
            for (const auto& [part, reported] : resumed.listener.checkpoints) {
                CHECK(part->seams.size() >= 2);
                CHECK(reported.at("energy").size() == part->seams.size());
                require_same_bounds(*go_on(task, sign * 4, part, reported).seams, *all.seams);
            }
        }
}

TEST_CASE("seams are the same in memory, on disk, and continued on disk") {
    std::mt19937 random(3);
    const std::array<int, 3> shape{20, 5, 4};
    const Scratch scratch;
    const std::vector<Ref<Seams>> after{std::make_shared<Seams>(random_seams(
        random, box(shape), shape, Axis::u, Seams::Kind::remove, 2, std::vector<int>{5, 6, 7}))};
    for (const auto& before : {std::vector<Ref<Seams>>{}, after})
        for (const int sign : {-1, 1}) {
            const Task task{"",         seam_greedy, "",    noise_in_quarters(random, shape, 3),
                            box(shape), {},          before};
            const auto all = solve(task, sign * 4);
            Otherwise on_disk;
            on_disk.limits = {0, scratch.path()};
            const auto some = solve(task, sign * 2, on_disk);
            REQUIRE(some.seams->seams[1].at.on_disk());
            on_disk.before = some.seams;
            on_disk.reported = some.listener.entry;
            require_same_bounds(*solve(task, sign * 4, on_disk).seams, *all.seams);
            require_same_bounds(some.seams->seams,
                                {all.seams->seams.begin(), all.seams->seams.begin() + 2});
        }
}

TEST_CASE("a search is told of the last seam before it goes on, as it was found") {
    for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert})
        for (const bool still : {false, true}) {
            const auto find = [&](int count, SearchOptions continued = {}) {
                EnergyVolume energy({{40, 7, 3}, Axis::u, 2});
                Walker walker;
                continued.start_from = [&](std::span<const std::uint16_t> last) {
                    walker.start_from(last);
                };
                return find_seams(
                           energy, {kind, {2, 37}, still}, count, std::ref(walker), [](double) {},
                           continued)
                    .seams;
            };
            const auto all = find(20);
            for (std::size_t count = 1; count < 20; count += 3) {
                SearchOptions continued;
                continued.before.assign(all.begin(),
                                        all.begin() + static_cast<std::ptrdiff_t>(count));
                require_same_bounds(find(20, continued), all);
                require_same_bounds(find(static_cast<int>(count)), continued.before);
            }
        }
}

TEST_CASE("a pyramid of very many columns goes on as if it had never stopped") {
    const auto find = [&](int count, const SearchOptions& continued = {}) {
        EnergyVolume energy({{4, 1025, 1024}, Axis::u, 1});
        std::mt19937 random(6);
        for (auto& code : energy.codes(0))
            code = static_cast<std::uint16_t>(20000 + random() % 16384);
        return find_seams(
                   energy, {Seams::Kind::insert, {0, 3}}, count, Pyramid(Quality::draft, 1),
                   [](double) {}, continued)
            .seams;
    };
    const auto all = find(2);
    SearchOptions continued;
    continued.before = {all.front()};
    require_same_bounds(find(2, continued), all);
}

TEST_CASE("what a solver keeps of a frame depends on nothing that is asked of the seams") {
    std::mt19937 random(4);
    const auto energy = noise_in_quarters(random, {9, 4, 4}, 1)[0],
               field = noise_in_quarters(random, {9, 4, 4}, 1)[0];
    auto bent = box({8, 4, 4});
    bent.planes[1].origin.z() += 0.25;
    bent.hash = lattice_hash(bent);
    const auto digest = [&](const std::string& yaml) {
        return NodeBench(seam_pyramid(), yaml, {{"field", 1}})
            .digest({{"energy", {Payload(energy)}},
                     {"field", {Payload(field)}},
                     {"lattice", {Payload(std::make_shared<Lattice>(bent))}}});
    };
    const auto bytes = [&](const std::string& params) {
        return bytes_of(digest("{cost: forward, " + params + "}"));
    };
    const auto plain = bytes("count: -1");
    for (const auto* params :
         {"count: 3", "count: 0", "count: -25%", "count: -1, window: [1, 3], pair_window: [5, 7]",
          "count: -1, rigidity: 3", "count: -1, rigidity_time: 3", "count: -1, field_weight: 2",
          "count: -1, bound_passes: 4", "count: -1, quality: best, starts: 3"})
        CHECK((bytes(params) == plain));
    CHECK((bytes("count: -1, axis: v") != plain));
    CHECK((bytes("count: -1, measure: volume") != plain));
    CHECK((bytes("count: -1, finest: 2") != plain));

    const auto fields = seam_pyramid().digest_fields;
    CHECK(std::set<std::string>(fields.begin(), fields.end()) ==
          std::set<std::string>{"energy", "lattice", "field", "protect", "attract", "axis",
                                "measure", "finest"});
    for (const auto& field_name : fields)
        CHECK((seam_pyramid().input(field_name) || seam_pyramid().param(field_name)));
}

TEST_CASE("what a solver keeps of a frame goes to a file and comes back to the last bit") {
    std::mt19937 random(5);
    const std::array<int, 3> shape{9, 4, 4};
    const auto field = noise_in_quarters(random, shape, 3);
    auto energy = noise_in_quarters(random, shape, 3);
    for (auto& grid : energy)
        grid->setTransform(openvdb::math::Transform::createLinearTransform(1.0 / 3));
    const auto lattice = make_box(Vec3d(0), shape, 1.0 / 3, {0, 1, 2});
    auto seen = field;
    for (auto& grid : seen)
        grid->setTransform(openvdb::math::Transform::createLinearTransform(0.7));
    const Task task{"",
                    seam_greedy,
                    ", cost: forward",
                    energy,
                    lattice,
                    {{"field", {seen.begin(), seen.end()}},
                     {"protect", {cube(Coord(0), Coord(1))}},
                     {"attract", {cube(Coord(2), Coord(2, 2, 2))}}}};
    const auto types = registry();
    std::size_t taken = 0;
    Otherwise filed;
    filed.digest = [&](const Payload& digest) {
        ++taken;
        const auto& type = types.payload(digest.type());
        CHECK(type.name == "frame_energy");
        const auto bytes = bytes_of(digest);
        std::istringstream in(bytes);
        auto back = type.read(in);
        CHECK(in.peek() == std::istringstream::traits_type::eof());
        CHECK((bytes_of(back) == bytes));
        CHECK(type.bytes(back) == type.bytes(digest));
        const auto &want = *digest.as<FrameEnergy>(), &got = *back.as<FrameEnergy>();
        CHECK(got.energy == want.energy);
        CHECK(got.field == want.field);
        CHECK(got.protect == want.protect);
        CHECK(got.attract == want.attract);
        CHECK(*got.transform == *want.transform);
        CHECK(*got.field_transform == *want.field_transform);
        CHECK(*got.active == *want.active);
        CHECK(got.content.voxels == want.content.voxels);
        CHECK(got.content.inside == want.content.inside);
        CHECK(got.lattice->hash == lattice_hash(*got.lattice));
        for (const std::size_t end : {bytes.size() / 3, bytes.size() - 1}) {
            std::istringstream cut(bytes.substr(0, end));
            CHECK_THROWS_AS(type.read(cut), Failure);
        }
        return back;
    };
    require_same_bounds(*solve(task, -3, filed).seams, *solve(task, -3).seams);
    CHECK(taken == 3);
}
