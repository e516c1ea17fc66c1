#include "carve/solver/costs/frame_energy.h"
#include "carve/solver/costs/half.h"
#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "carve/solver/task/params.h"
#include "nodes/seam.h"
#include "tests/support/searches.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

// Solving at half size: `finest: 2`.

namespace {

using Codes = std::vector<std::uint16_t>;

/// Entries along the axis, columns beside each other, planes.
using ColumnShape = std::array<std::size_t, 3>;

std::size_t size_of(const ColumnShape& shape) { return shape[0] * shape[1] * shape[2]; }

/// Random energies in quarters, some of them marked.
Codes random_codes(std::mt19937& random, std::size_t size) {
    Codes out(size);
    for (auto& code : out) {
        const auto draw = random() % 40;
        code = draw == 0   ? protected_code
               : draw == 1 ? attracted_code
                           : encode_energy(static_cast<float>(random() % 256) / 4);
    }
    return out;
}

/// Calls `visit(code)` for the fine vertices of a coarse one.
template <class Visit>
void visit_fine(const Codes& codes, const ColumnShape& shape, std::size_t entry,
                std::size_t lateral, std::size_t k, const Visit& visit) {
    for (auto fk = 2 * k; fk < std::min(2 * k + 2, shape[2]); ++fk)
        for (auto fl = 2 * lateral; fl < std::min(2 * lateral + 2, shape[1]); ++fl) {
            const auto first = (fl + shape[1] * fk) * shape[0] + 2 * entry;
            visit(codes[first], 2 * entry + 1 < shape[0] ? codes[first + 1] : codes[first]);
        }
}

/// Restricts codes of one frame, whole columns, to half the size.
template <class Mean>
Codes halves(const Codes& codes, const ColumnShape& shape) {
    const auto [width, laterals, planes] = shape;
    Mean mean(width);
    Codes out(halved(width) * halved(laterals) * halved(planes));
    for (std::size_t c = 0; c < out.size() / halved(width); ++c) {
        const auto lateral = 2 * (c % halved(laterals)), k = 2 * (c / halved(laterals));
        for (auto fk = k; fk < std::min(k + 2, planes); ++fk)
            for (auto fl = lateral; fl < std::min(lateral + 2, laterals); ++fl)
                mean.add(std::span(codes).subspan((fl + laterals * fk) * width, width));
        mean.end(std::span(out).subspan(c * halved(width), halved(width)));
    }
    return out;
}

std::vector<FloatGrid::Ptr> hills(std::mt19937& random, const std::array<int, 3>& shape,
                                  std::size_t frames) {
    std::vector<FloatGrid::Ptr> out;
    for (std::size_t t = 0; t < frames; ++t)
        out.push_back(energy_grid(
            CoordBBox(Coord(0), Coord(shape[0] - 1, shape[1] - 1, shape[2] - 1)),
            [&](const Coord& at) {
                return static_cast<float>(3 +
                                          2 * std::sin(0.7 * at.x() + 0.3 * at.y() - 0.2 * at.z() +
                                                       0.1 * static_cast<double>(t))) +
                       static_cast<float>(random() % 64) / 64;
            }));
    return out;
}

/// What each column holds, as seams take from it or add to it: its original vertices.
std::vector<std::vector<int>> contents(const Seams& seams) {
    std::vector<std::vector<int>> out(seams.columns_per_frame() * seams.frames.size());
    for (auto& column : out) {
        column.resize(static_cast<std::size_t>(seams.before()));
        std::iota(column.begin(), column.end(), 0);
    }
    return out;
}

/// Requires seams of full size that can be carved, in a window.
/// @return the vertices that they take from each column, or double
std::vector<std::vector<int>> taken_by(const Seams& seams, Window window) {
    const ColumnGraph graph(
        {seams.laterals(), seams.shape[2], static_cast<int>(seams.frames.size())}, seams.closed,
        seams.around);
    auto left = contents(seams);
    std::vector<std::vector<int>> out(left.size());
    for (const auto& seam : seams.seams) {
        SeamVector now(left.size());
        for (std::size_t c = 0; c < left.size(); ++c) {
            auto& column = left[c];
            const auto place = seams.kind == Seams::Kind::remove
                                   ? column.begin() + seam.at[c]
                                   : std::ranges::find(column, int{seam.at[c]});
            REQUIRE(place < column.end());
            now[c] = static_cast<std::uint16_t>(place - column.begin());
            CHECK(*place >= window.first);
            CHECK(*place <= window.last);
            out[c].push_back(*place);
            column.erase(place);
        }
        CHECK(is_seam(graph, Band::whole(left.size(), {0, seams.before() - 1}), now));
    }
    return out;
}

std::string stated(const std::string& count, const std::string& more = "") {
    return fmt::format("{{count: {}, finest: 2{}}}", count, more);
}

}  // namespace

TEST_CASE("a coarse entry has the mean cost of its columns, and the marks in and beside it") {
    std::mt19937 random(1);
    for (const auto& shape :
         {ColumnShape{8, 4, 6}, ColumnShape{7, 5, 3}, ColumnShape{9, 1, 1}, ColumnShape{1, 2, 3}}) {
        const auto codes = random_codes(random, size_of(shape));
        const ColumnShape coarse{halved(shape[0]), halved(shape[1]), halved(shape[2])};
        const auto out = halves<MeanEnergy>(codes, shape);
        std::vector<bool> guarded(out.size()), wanted(out.size());
        const auto at = [&](std::size_t entry, std::size_t lateral, std::size_t k) {
            return entry + coarse[0] * (lateral + coarse[1] * k);
        };
        for (std::size_t k = 0; k < coarse[2]; ++k)
            for (std::size_t lateral = 0; lateral < coarse[1]; ++lateral) {
                for (std::size_t entry = 0; entry < coarse[0]; ++entry)
                    visit_fine(codes, shape, entry, lateral, k,
                               [&](std::uint16_t a, std::uint16_t b) {
                                   if (a == protected_code || b == protected_code)
                                       guarded[at(entry, lateral, k)] = true;
                                   if (a == attracted_code || b == attracted_code)
                                       wanted[at(entry, lateral, k)] = true;
                               });
                for (std::size_t entry = 0; entry < coarse[0]; ++entry) {
                    const bool near = guarded[at(entry, lateral, k)] ||
                                      (entry > 0 && guarded[at(entry - 1, lateral, k)]) ||
                                      (entry + 1 < coarse[0] && guarded[at(entry + 1, lateral, k)]);
                    const auto got = out[at(entry, lateral, k)];
                    CHECK((got == protected_code) == near);
                    CHECK((got == attracted_code) == (!near && wanted[at(entry, lateral, k)]));
                    if (got >= protected_code) continue;
                    double sum = 0;
                    int columns = 0;
                    visit_fine(codes, shape, entry, lateral, k,
                               [&](std::uint16_t a, std::uint16_t b) {
                                   const double one = decode_energy(a), other = decode_energy(b);
                                   sum += 0.15 * (one + other) / 2 + 0.85 * std::min(one, other);
                                   ++columns;
                               });
                    CHECK(decode_energy(got) == Approx(sum / columns).epsilon(1e-3));
                }
            }
        Codes field(size_of(shape));
        for (auto& code : field) code = encode_field(static_cast<float>(random() % 256) / 16 - 8);
        const auto mean = halves<MeanField>(field, shape);
        for (std::size_t n = 0; n < mean.size(); ++n) {
            double sum = 0;
            int count = 0;
            visit_fine(field, shape, n % coarse[0], n / coarse[0] % coarse[1],
                       n / coarse[0] / coarse[1], [&](std::uint16_t a, std::uint16_t b) {
                           sum += decode_field(a) + decode_field(b);
                           count += 2;
                       });
            CHECK(decode_field(mean[n]) == Approx(sum / count).margin(1e-2));
        }
    }
}

TEST_CASE("two frames become their mean in either order, and a mark in one of them stays") {
    const Codes one{encode_energy(1), protected_code, attracted_code, encode_energy(3)},
        other{encode_energy(3), attracted_code, encode_energy(5), encode_energy(3)};
    for (const bool swapped : {false, true}) {
        auto out = swapped ? one : other;
        average_energy(swapped ? other : one, out);
        CHECK(out == Codes{encode_energy(2), protected_code, attracted_code, encode_energy(3)});
    }
    Codes field{encode_field(-1)};
    average_field(Codes{encode_field(4)}, field);
    CHECK(field == Codes{encode_field(1.5f)});
}

TEST_CASE("a frame sampled at half size is the halved frame, also where most of it is empty") {
    const auto on = [](float background, const CoordBBox& box) {
        auto grid = FloatGrid::create(background);
        auto values = grid->getAccessor();
        for (auto at = box.begin(); at; ++at)
            values.setValue(*at, static_cast<float>((*at).x() * (*at).y() % 17 + (*at).z()));
        return grid;
    };
    const CoordBBox content(Coord(0, 0, 0), Coord(40, 30, 6)),
        far(Coord(61, 33, 3), Coord(62, 34, 4));
    const auto mask = mask_grid({Coord(3, 4, 2), Coord(20, 9, 6), Coord(68, 35, 1)});
    const auto empty = FloatGrid::create(), tile = on(0, far);
    tile->tree().addTile(1, Coord(16, 16, 0), 3, true);
    const auto tilted = make_box(openvdb::Vec3d(-3.3, 0.2, 0.4), {71, 37, 9}, 0.9, {1, 0, 2});
    for (const auto& grid : {on(0, content), on(2, content), on(0, far), empty, tile})
        for (const auto& lattice : {box({42, 31, 7}), box({71, 37, 9}), tilted})
            for (const auto axis : {Axis::u, Axis::v, Axis::w})
                for (const auto& set : {mask, mask_grid({})}) {
                    const auto shared = std::make_shared<Lattice>(lattice);
                    const FrameGrids grids{*grid, &*grid, set.get(), nullptr};
                    const auto fine = sample_frame(grids, shared, axis, Measure::vertex),
                               coarse = sample_frame(grids, shared, axis, Measure::vertex, 2);
                    const ColumnShape shape{std::size_t(lattice.shape[dimension(axis)]),
                                            std::size_t(lattice.shape[lateral_dimension(axis)]),
                                            std::size_t(lattice.shape[slice_dimension(axis)])};
                    CHECK(coarse.energy == halves<MeanEnergy>(fine.energy, shape));
                    CHECK(coarse.field == halves<MeanField>(fine.field, shape));
                    CHECK(coarse.finest == 2);
                    CHECK(coarse.protect == fine.protect);
                    CHECK(coarse.content.inside == fine.content.inside);
                }
}

TEST_CASE("at half size, too, the first vertex without an energy is named") {
    auto grid = energy_grid(CoordBBox(Coord(0), Coord(9)), [](const Coord& at) {
        return at.z() == 7 && at.y() > 4 && at.x() > 2 ? -1.0f : 1.0f;
    });
    const auto lattice = std::make_shared<Lattice>(box({10, 10, 10}));
    for (const int finest : {1, 2})
        CHECK(
            failure_of([&] { sample_frame({*grid}, lattice, Axis::u, Measure::vertex, finest); }) ==
            "the energy is -1 at (3, 5, 7), vertex (3, 5, 7); energies must be from 0 to 4.29e+09");
}

TEST_CASE(
    "seams of half size become twice as many of full size, which can be carved and stay in their "
    "window") {
    std::mt19937 random(3);
    for (const auto& shape : {std::array{20, 6, 8}, std::array{21, 5, 7}, std::array{22, 7, 1}})
        for (const std::size_t frames : {1, 4, 5})
            for (const char* const count : {"-6", "-3", "5", "-1"})
                for (const bool closed : {false, true}) {
                    auto lattice = box(shape);
                    lattice.closed = closed && shape[2] > 2;
                    const auto energy = hills(random, shape, frames);
                    const auto solved = solve(seam_pyramid(), stated(count, ", window: [3, 18]"),
                                              energy, {lattice}, {}, frames);
                    CHECK(static_cast<int>(solved.seams->seams.size()) ==
                          std::abs(std::stoi(count)));
                    CHECK(solved.seams->shape == shape);
                    CHECK(solved.listener.entry["finest"] == 2);
                    taken_by(*solved.seams, {3, 18});
                }
}

TEST_CASE(
    "energies at half size are stated by column: close to those of full size where these are "
    "smooth") {
    const std::array<int, 3> shape{24, 12, 10};
    std::vector<FloatGrid::Ptr> energy;
    for (int t = 0; t < 4; ++t)
        energy.push_back(energy_grid(CoordBBox(Coord(0), Coord(23, 11, 9)), [&](const Coord& at) {
            return static_cast<float>(2 + std::cos(0.26 * at.x()) + 0.01 * at.y() + 0.01 * t);
        }));
    const auto fine = solve(seam_pyramid(), "{count: -2, finest: 1}", energy, {box(shape)}, {}, 4),
               coarse = solve(seam_pyramid(), stated("-2"), energy, {box(shape)}, {}, 4);
    CHECK(!fine.listener.entry.contains("finest"));
    CHECK(coarse.seams->seams[0].energy == Approx(fine.seams->seams[0].energy).epsilon(0.05));
    CHECK(*coarse.seams->seams[0].lower_bound <= coarse.seams->seams[0].energy);
    CHECK(coarse.listener.entry["wall_s"].size() == 2);
}

TEST_CASE("at half size no seam passes a protected vertex") {
    std::mt19937 random(5);
    const std::array<int, 3> shape{40, 9, 7};
    for (int turn = 0; turn < 8; ++turn) {
        std::vector<openvdb::GridBase::ConstPtr> masks;
        for (int t = 0; t < 3; ++t) {
            std::vector<Coord> voxels;
            for (int n = 0; n < 6; ++n)
                voxels.emplace_back(int(random() % 40), int(random() % 9), int(random() % 7));
            masks.push_back(mask_grid(voxels));
        }
        for (const char* const count : {"-9", "4"}) {
            const auto solved =
                solve(seam_greedy(), stated(count, ", best_effort: true"), hills(random, shape, 3),
                      {box(shape)}, {{"protect", masks}}, 3);
            CHECK(!solved.seams->seams.empty());
            const auto taken = taken_by(*solved.seams, {0, 39});
            std::size_t passed = 0;
            for (std::size_t c = 0; c < taken.size(); ++c)
                for (const int x : taken[c]) {
                    const Coord at(x, int(c % 9), int(c / 9 % 7));
                    passed +=
                        static_cast<const MaskGrid&>(*masks[c / 63]).tree().isValueOn(at) ? 1 : 0;
                }
            CHECK(passed == 0);
        }
    }
}

TEST_CASE(
    "at half size, fewer seams are the first of more, and a search that goes on finds the same") {
    std::mt19937 random(7);
    const std::array<int, 3> shape{24, 6, 6};
    const auto energy = hills(random, shape, 3);
    const auto run = [&](const char* count, const Otherwise& otherwise = {}) {
        return solve(seam_pyramid(), stated(count), energy, {box(shape)}, {}, 3, {}, otherwise);
    };
    const auto four = run("-4"), three = run("-3");
    Otherwise on;
    on.before = three.seams;
    on.reported = three.listener.entry;
    const auto again = run("-4", on);
    REQUIRE(again.seams->seams.size() == 4);
    for (std::size_t n = 0; n < 4; ++n) {
        CHECK(again.seams->seams[n].at == four.seams->seams[n].at);
        if (n < 3) CHECK(three.seams->seams[n].at == four.seams->seams[n].at);
    }
}

TEST_CASE(
    "at half size, static seams stay, pairs keep their windows, and seams come after others") {
    std::mt19937 random(9);
    const std::array<int, 3> shape{24, 8, 6};
    const auto energy = hills(random, shape, 4);
    const auto still =
        solve(seam_greedy(), stated("-4", ", static: true"), energy, {box(shape)}, {}, 4);
    const auto columns = static_cast<std::ptrdiff_t>(still.seams->columns_per_frame());
    for (const auto& seam : still.seams->seams)
        CHECK(std::equal(seam.at.begin(), seam.at.end() - columns, seam.at.begin() + columns));
    const auto pairs = solve(seam_greedy(), stated("-2", ", window: [2, 9], pair_window: [12, 21]"),
                             energy, {box(shape)}, {}, 4);
    CHECK(pairs.seams->pairs.size() == 2);
    for (const auto& seam : pairs.seams->pairs) {
        CHECK(*std::ranges::min_element(seam.at.all()) >= 12);
        CHECK(*std::ranges::max_element(seam.at.all()) <= 21);
    }
    // What lies behind the first set is moved by it, along either axis.
    for (const char* const axis : {"u", "v"}) {
        const auto first = solve(seam_greedy(), stated("-4", fmt::format(", axis: {}", axis)),
                                 energy, {box(shape)}, {}, 4);
        const auto second =
            solve(seam_greedy(), stated("-2"), energy, {box(shape)}, {}, 4, {first.seams});
        CHECK(second.seams->shape ==
              (axis == std::string("u") ? std::array{20, 8, 6} : std::array{24, 4, 6}));
        taken_by(*second.seams, {0, second.seams->before() - 1});
    }
}

TEST_CASE("seams after others at half size see what those leave") {
    // A cheap valley at vertices 20 and 21; the set before takes the four vertices 2 to 5, so that
    // it lies at 16 and 17.
    const std::array<int, 3> shape{28, 4, 4};
    const auto valley = energy_grid(CoordBBox(Coord(0), Coord(27, 3, 3)),
                                    [](const Coord& at) { return at.x() / 2 == 10 ? 0.0f : 8.0f; });
    Seams before;
    before.shape = shape;
    before.frames = {5, 6};
    before.lattice_hash = box(shape).hash;
    for (int n = 0; n < 4; ++n) before.seams.push_back({std::vector<std::uint16_t>(32, 2)});
    const auto solved = solve(seam_greedy(), stated("-2"), {valley}, {box(shape)}, {}, 2,
                              {std::make_shared<Seams>(before)});
    for (const auto& seam : solved.seams->seams)
        for (const auto entry : seam.at) CHECK(entry == 16);
}

TEST_CASE("half size is for volumes of more than 12 million vertices, unless stated") {
    SolverParams params;
    Lattice lattice;
    const auto chosen = [&](const std::array<int, 3>& shape) {
        lattice.shape = shape;
        return finest_for(params, lattice);
    };
    CHECK(chosen({300, 200, 200}) == 1);
    CHECK(chosen({301, 200, 200}) == 2);
    CHECK(chosen({5000, 5000, 1}) == 1);
    params.finest = 2;
    CHECK(chosen({8, 8, 8}) == 2);
    params.finest = 1;
    CHECK(chosen({1000, 600, 600}) == 1);
}

TEST_CASE("a window without room at half size is refused with a remedy") {
    const std::array<int, 3> shape{12, 4, 4};
    std::mt19937 random(11);
    const auto energy = hills(random, shape, 2);
    CHECK_THROWS_WITH(
        solve(seam_greedy(), stated("-2", ", window: [3, 4]"), energy, {box(shape)}, {}, 2),
        "2 seams do not fit: window [3, 4] has room to remove none at half size; at full size "
        "(`finest: 1`) for 2");
    const auto some = solve(seam_greedy(), stated("-5", ", window: [3, 7], best_effort: true"),
                            energy, {box(shape)}, {}, 2);
    CHECK(some.seams->seams.size() == 4);
    CHECK(some.listener.warnings ==
          std::vector<std::string>{"finds 4 of 5 seams, as many as there is room for in window [3, "
                                   "7]: it has room to remove 4"});
    CHECK(solve(seam_greedy(), "{count: -2, window: [3, 4]}", energy, {box(shape)}, {}, 2)
              .seams->seams.size() == 2);
}
