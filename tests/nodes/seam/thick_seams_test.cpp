#include "carve/solver/costs/eddies.h"
#include "carve/solver/costs/slab_prices.h"
#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "formats/seam_file/seam_file.h"
#include "nodes/seam.h"
#include "nodes/solving/declare_solver.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

// Thick seams: slabs of several vertices, and what they pay.

namespace {

constexpr std::array<int, 3> slab_lattice{40, 4, 5};
constexpr std::size_t slab_frames = 3;
const CoordBBox slab_voxels(Coord(0),
                            Coord(slab_lattice[0] - 1, slab_lattice[1] - 1, slab_lattice[2] - 1));

/// Waves that move through a broad hump, with some noise.
FloatGrid::Ptr moving_waves(std::size_t t, double length = 6) {
    std::mt19937 random(static_cast<unsigned>(t) + 7);
    return energy_grid(slab_voxels, [&](const Coord& at) {
        const double x = at.x() + 0.6 * at.y() - 0.3 * static_cast<double>(t),
                     inside = at.x() > 3 && at.x() < 36 ? 1 : 0;
        return static_cast<float>(inside * (2 + std::sin(2 * M_PI * x / length) +
                                            0.1 * static_cast<double>(random() % 16) / 16));
    });
}

std::vector<FloatGrid::Ptr> random_energies() {
    std::vector<FloatGrid::Ptr> out;
    for (std::size_t t = 0; t < slab_frames; ++t) {
        std::mt19937 random(static_cast<unsigned>(t));
        out.push_back(energy_grid(
            slab_voxels, [&](const Coord&) { return static_cast<float>(random() % 64) / 64; }));
    }
    return out;
}

Grids wave_fields(double length = 6) {
    Grids out;
    for (std::size_t t = 0; t < slab_frames; ++t) out["field"].push_back(moving_waves(t, length));
    return out;
}

Solved solved_slabs(NodeType type, const std::string& yaml, const Grids& grids = wave_fields(),
                    const Otherwise& otherwise = {}) {
    return solve(std::move(type), yaml, random_energies(), {box(slab_lattice)}, grids, slab_frames,
                 {}, otherwise);
}

void require_slabs(const Seams& set, int thickness, std::size_t count) {
    REQUIRE(set.thickness == thickness);
    REQUIRE(set.seams.size() == count);
    const int step = set.kind == Seams::Kind::insert ? 1 : 0;
    for (std::size_t n = 0; n < count; ++n) {
        const auto first = n - n % static_cast<std::size_t>(thickness);
        for (std::size_t c = 0; c < set.seams[n].at.size(); ++c) {
            REQUIRE(set.seams[n].at[c] ==
                    set.seams[first].at[c] + step * static_cast<int>(n - first));
            REQUIRE(set.seams[n].at[c] <
                    slab_lattice[0] - (set.kind == Seams::Kind::remove ? static_cast<int>(n) : 1));
        }
    }
}

EnergyVolume slab_volume(std::size_t frames,
                         const std::function<float(int i, int j, int k, std::size_t t)>& field) {
    EnergyVolume out({slab_lattice, Axis::u, frames});
    std::mt19937 random(3);
    for (std::size_t t = 0; t < frames; ++t) {
        std::vector<std::uint16_t> codes;
        for (int k = 0; k < slab_lattice[2]; ++k)
            for (int j = 0; j < slab_lattice[1]; ++j)
                for (int i = 0; i < slab_lattice[0]; ++i)
                    codes.push_back(encode_field(field(i, j, k, t)));
        for (auto& code : out.codes(t))
            code = encode_energy(static_cast<float>(random() % 64) / 64);
        out.set_field(t, codes);
    }
    return out;
}

}  // namespace

TEST_CASE(
    "a slab pays for the difference of both its sides, for the energy in it, and for outlines") {
    const auto field = [](int i, int j, int k, std::size_t t) {
        return i < 4 || i > 33 ? 0.0f
                               : static_cast<float>(2 + std::sin(0.9 * i + 0.5 * j - 0.2 * k +
                                                                 0.3 * static_cast<double>(t)));
    };
    const auto volume = slab_volume(3, field);
    constexpr int thickness = 5, half = 3;
    const auto value = [&](int i, int j, int k, std::size_t t) {
        return i < 0 || i >= slab_lattice[0] ? 0.0 : static_cast<double>(field(i, j, k, t));
    };
    double most = 0, sum = 0, energies = 0, joins = 0;
    int contents = 0, slabs = 0;
    const auto each = [&](const auto& visit) {
        for (std::size_t t = 0; t < 3; ++t)
            for (int k = 0; k < slab_lattice[2]; ++k)
                for (int j = 0; j < slab_lattice[1]; ++j) visit(j, k, t);
    };
    each([&](int j, int k, std::size_t t) {
        for (int i = 0; i < slab_lattice[0]; ++i) most = std::max(most, value(i, j, k, t));
    });
    const auto content = [&](int i, int j, int k, std::size_t t) {
        return value(i, j, k, t) > 0.02 * most;
    };
    each([&](int j, int k, std::size_t t) {
        for (int i = 0; i < slab_lattice[0]; ++i)
            if (content(i, j, k, t)) sum += value(i, j, k, t), ++contents;
    });
    const double level = 0.5 * sum / contents;
    const auto seen = [&](int i, int j, int k, std::size_t t) {
        return value(i, j, k, t) / (value(i, j, k, t) + level);
    };
    const auto slope = [&](int i, int j, int k, std::size_t t) {
        return 0.5 * (seen(i + 1, j, k, t) - seen(i - 1, j, k, t));
    };
    const auto join = [&](int i, int j, int k, std::size_t t) {
        double out = 0;
        for (int n = i - half; n <= i + half; ++n)
            out += std::pow(seen(n, j, k, t) - seen(n + thickness, j, k, t), 2) +
                   4 * std::pow(slope(n, j, k, t) - slope(n + thickness, j, k, t), 2);
        return std::sqrt(out / (2 * half + 1));
    };
    const auto energy = [&](int i, int j, int k, std::size_t t) {
        double out = 0;
        for (int n = i; n < i + thickness; ++n)
            out += decode_energy(volume.codes(t)[(k * slab_lattice[1] + j) * slab_lattice[0] + n]);
        return out / thickness;
    };
    const auto outlines = [&](int i, int j, int k, std::size_t t) {
        const auto around = [&](int n) {
            return (content(n - 1, j, k, t) + content(n, j, k, t) + content(n + 1, j, k, t)) / 3.0;
        };
        double out = 0;
        for (int n = i; n < i + thickness; ++n) out += std::abs(around(n + 1) - around(n));
        return out;
    };
    const auto shows = [&](int i, int j, int k, std::size_t t) {
        for (int n = i - half; n <= i + thickness + half; ++n)
            if (content(n, j, k, t)) return true;
        return false;
    };
    each([&](int j, int k, std::size_t t) {
        for (int i = 0; i + thickness <= slab_lattice[0]; ++i)
            if (shows(i, j, k, t))
                joins += join(i, j, k, t), energies += energy(i, j, k, t), ++slabs;
    });
    const double weight = 0.7, unit = weight + 1;
    const auto price = [&](int i, int j, int k, std::size_t t) {
        return weight * join(i, j, k, t) / (joins / slabs) +
               energy(i, j, k, t) / (energies / slabs) + unit * outlines(i, j, k, t);
    };
    const SlabPrices prices(volume, thickness, {0.7f, 1.5f, {0.1f, 0.2f}});
    const auto got = prices.priced(volume, thickness, 1.5f, {}, {});
    CHECK(got.width() == slab_lattice[0] - thickness + 1);
    CHECK(got.step_prices().rigidity[1] == Approx(0.2 * unit));
    each([&](int j, int k, std::size_t t) {
        for (int i = 0; i + thickness <= slab_lattice[0]; ++i) {
            double wanted = 1.5 * unit;
            if (shows(i, j, k, t)) {
                wanted = 0;
                // The mean over the columns and frames around.
                for (int n = -1; n <= 1; ++n)
                    for (int m = -1; m <= 1; ++m)
                        for (int f = -1; f <= 1; ++f)
                            wanted += price(i, std::clamp(j + n, 0, slab_lattice[1] - 1),
                                            std::clamp(k + m, 0, slab_lattice[2] - 1),
                                            static_cast<std::size_t>(
                                                std::clamp(static_cast<int>(t) + f, 0, 2))) /
                                      27;
            }
            INFO(i << ' ' << j << ' ' << k << ' ' << t);
            REQUIRE(decode_energy(got.codes(t)[(k * slab_lattice[1] + j) * got.width() + i]) ==
                    Approx(wanted).epsilon(4e-3).margin(1e-3));
        }
    });
}

TEST_CASE(
    "a slab where another was taken is four times as dear, and less so up to three thicknesses "
    "away") {
    const auto volume = slab_volume(
        1, [](int i, int, int, std::size_t) { return static_cast<float>(2 + std::sin(0.9 * i)); });
    const SlabPrices prices(volume, 4, {1, 1.5f, {}});
    const auto columns = static_cast<std::size_t>(slab_lattice[1] * slab_lattice[2]);
    const SlabPrices::Taken taken{SeamEntries(std::vector<std::uint16_t>(columns, 20)), 4};
    const auto before = prices.priced(volume, 4, 1.5f, {}, {}),
               behind = prices.priced(volume, 4, 1.5f, {&taken, 1}, {});
    const auto times = [&](int entry) {
        return decode_energy(behind.codes(0)[entry]) / decode_energy(before.codes(0)[entry]);
    };
    CHECK(times(20) == Approx(4).epsilon(2e-3));
    CHECK(times(14) == Approx(2.5).epsilon(2e-3));
    CHECK(times(26) == Approx(2.5).epsilon(2e-3));
    CHECK(times(8) == Approx(1).epsilon(2e-3));
    CHECK(times(33) == Approx(1).epsilon(2e-3));
    // Where a slab was removed, one lies that has as much before the join as behind it.
    const SlabPrices::Taken removed{SeamEntries(std::vector<std::uint16_t>(columns, 22)), 0};
    const auto without = prices.priced(volume, 4, 1.5f, {&removed, 1}, {});
    for (int entry = 0; entry < without.width(); ++entry)
        REQUIRE(without.codes(0)[entry] == behind.codes(0)[entry]);
}

TEST_CASE("what is empty can be given another price, and all else keeps its own") {
    auto volume = slab_volume(3, [](int i, int j, int, std::size_t t) {
        const bool seen = i > 6 + j && i < 20 + static_cast<int>(t);
        return seen ? static_cast<float>(2 + std::sin(0.9 * i)) : 0.0f;
    });
    volume.codes(0)[3] = protected_code;
    volume.codes(1)[60] = attracted_code;
    volume.find_marks();
    const SlabPrices prices(volume, 4, {1, {}, {}});
    const auto columns = static_cast<std::size_t>(slab_lattice[1] * slab_lattice[2]);
    const SlabPrices::Taken taken{SeamEntries(std::vector<std::uint16_t>(3 * columns, 20)), 4};
    const auto at = [&](float empty) { return prices.priced(volume, 4, empty, {&taken, 1}, {}); };
    auto given = at(1.3f);
    const auto wanted = at(3.5f);
    prices.set_empty(given, volume, 4, 3.5f, {&taken, 1});
    const auto codes = [](const EnergyVolume& of) {
        return std::vector(of.codes(0), of.codes(0) + 3 * of.columns_per_frame() * of.stride());
    };
    CHECK(codes(given) == codes(wanted));
}

TEST_CASE("removed slabs keep away from each other, even where energy is low in one place only") {
    const auto valley = [](const Coord& at) { return at.x() >= 18 && at.x() < 26 ? 0.25f : 1.0f; };
    const std::vector<FloatGrid::Ptr> energies(slab_frames, energy_grid(slab_voxels, valley));
    const auto found = solve(seam_pyramid(), "{count: -8, thickness: 4, empty: 1}", energies,
                             {box(slab_lattice)}, wave_fields(), slab_frames);
    const auto &first = found.seams->seams[0].at, &second = found.seams->seams[4].at;
    for (std::size_t c = 0; c < first.size(); ++c) {
        REQUIRE(first[c] >= 17);
        REQUIRE(first[c] <= 23);
        REQUIRE(std::abs(second[c] + 2 - first[c]) >= 6);
    }
}

TEST_CASE(
    "all solvers find slabs, whose vertices run side by side, whatever the number of threads") {
    const std::vector<std::function<NodeType()>> solvers{seam_pyramid, seam_greedy, seam_graph_cut};
    for (std::size_t n = 0; n < solvers.size(); ++n)
        for (const int count : {-10, 10}) {
            INFO(n << ", " << count);
            const auto found =
                solved_slabs(solvers[n](), "{count: " + std::to_string(count) + ", thickness: 4}");
            require_slabs(*found.seams, 4, 10);
            CHECK(found.listener.entry.at("thickness") == 4);
            CHECK(found.listener.entry.at("energy").size() == 10);
        }
}

TEST_CASE(
    "the first slabs do not depend on how many are asked for, and a search goes on in the middle "
    "of one") {
    for (const int sign : {-1, 1}) {
        const auto yaml = [&](int count) {
            return "{count: " + std::to_string(sign * count) + ", thickness: 4}";
        };
        const auto whole = solved_slabs(seam_pyramid(), yaml(11));
        for (const int count : {3, 4, 6, 9}) {
            INFO(sign * count);
            const auto some = solved_slabs(seam_pyramid(), yaml(count));
            require_slabs(*some.seams, 4, static_cast<std::size_t>(count));
            for (std::size_t n = 0; n < some.seams->seams.size(); ++n)
                REQUIRE(some.seams->seams[n].at == whole.seams->seams[n].at);
            Otherwise before;
            before.before = some.seams;
            before.reported = some.listener.entry;
            const auto gone_on = solved_slabs(seam_pyramid(), yaml(11), wave_fields(), before);
            CHECK(seams_from_volume(seams_to_volume(*gone_on.seams)).seams.size() == 11);
            for (std::size_t n = 0; n < 11; ++n) {
                REQUIRE(gone_on.seams->seams[n].at == whole.seams->seams[n].at);
                REQUIRE(gone_on.seams->seams[n].energy == whole.seams->seams[n].energy);
            }
        }
    }
}

TEST_CASE(
    "seams of no stated thickness are as thick as the eddies are wide, and thin where the content "
    "is one smooth thing") {
    const auto eddies = [](double length) {
        return Eddies::of(slab_volume(1, [&](int i, int, int, std::size_t) {
            return static_cast<float>(2 + 1.8 * std::sin(2 * M_PI * i / length));
        }));
    };
    // The correlation of a wave falls to a half at a sixth of its length.
    CHECK(eddies(6).width == 2);  // 1.5 of a sixth is rounded
    CHECK(eddies(12).width == 3);
    CHECK(eddies(12).across > 2);
    CHECK(
        solved_slabs(seam_pyramid(), "{count: -4, spread: auto, thickness: auto}", wave_fields(12))
            .seams->thickness > 1);
    Grids hump;
    hump["field"].push_back(energy_grid(slab_voxels, [](const Coord& at) {
        return static_cast<float>(std::exp(-0.01 * std::pow(at.x() - 20, 2)));
    }));
    CHECK(solved_slabs(seam_pyramid(), "{count: -4, spread: auto, thickness: auto}", hump)
              .seams->thickness == 1);
    CHECK(solved_slabs(seam_pyramid(), "{count: -4, spread: auto, thickness: auto}", {})
              .seams->thickness == 1);
}

TEST_CASE(
    "slabs stay in their windows, come in pairs, may be the same in all frames, and pass no "
    "protected vertex") {
    SECTION("a window") {
        const auto found =
            solved_slabs(seam_pyramid(), "{count: -9, thickness: 4, window: [8, 19]}");
        require_slabs(*found.seams, 4, 9);
        for (std::size_t n = 0; n < 9; ++n)
            for (const auto entry : found.seams->seams[n].at) {
                REQUIRE(entry >= 8);
                REQUIRE(entry <= 19 - static_cast<int>(n));
            }
    }
    SECTION("pairs") {
        const auto found = solved_slabs(
            seam_pyramid(), "{count: -6, thickness: 3, window: [3, 15], pair_window: [20, 36]}");
        require_slabs(*found.seams, 3, 6);
        REQUIRE(found.seams->pairs.size() == 6);
        for (const auto& pair : found.seams->pairs)
            for (const auto entry : pair.at) REQUIRE(entry >= 20);
    }
    SECTION("the same in all frames") {
        const auto found = solved_slabs(seam_pyramid(), "{count: -6, thickness: 3, static: true}");
        require_slabs(*found.seams, 3, 6);
        const auto columns = static_cast<std::ptrdiff_t>(found.seams->columns_per_frame());
        for (const auto& seam : found.seams->seams)
            REQUIRE(std::equal(seam.at.begin() + columns, seam.at.end(), seam.at.begin()));
    }
    SECTION("protected vertices") {
        auto grids = wave_fields();
        std::vector<Coord> voxels;
        for (int j = 0; j < slab_lattice[1]; ++j)
            for (int k = 0; k < slab_lattice[2]; ++k) voxels.emplace_back(17, j, k);
        grids["protect"] = {mask_grid(voxels)};
        const auto found = solved_slabs(seam_pyramid(), "{count: -8, thickness: 4}", grids);
        require_slabs(*found.seams, 4, 8);
        // Vertex 17 and those before it that are left stay: no slab holds both sides of it.
        for (std::size_t c = 0; c < found.seams->seams[0].at.size(); ++c) {
            int at = 17;
            for (std::size_t n = 0; n < 8; ++n) {
                const int entry = found.seams->seams[n].at[c];
                REQUIRE(entry != at);
                if (entry < at) --at;
            }
        }
    }
}

TEST_CASE("a thickness that does not fit is refused, with what to do") {
    const auto faults = [](const std::string& yaml, int field) {
        return NodeBench(seam_pyramid(), yaml, {{"field", field}}).faults();
    };
    CHECK(faults("{count: -4, thickness: 4}", 0) ==
          "thickness: thick seams need a `field`: they run where it looks alike on both sides\n");
    CHECK(faults("{count: -4, thickness: 9, window: [4, 10]}", 1) ==
          "thickness: thickness 9 is wider than window [4, 10], which has 7 vertices; lower it, or "
          "widen the window\n");
    CHECK(faults("{count: -4, thickness: 4, spread: 2}", 1) ==
          "spread: parameter 'spread' serves thin seams: leave it out, or set `thickness: 1`\n");
    CHECK(
        failure_of([&] { solved_slabs(seam_pyramid(), "{count: -4, thickness: 50}"); }) ==
        "thickness 50 is wider than the lattice, which has 40 vertices along u: 0 to 39; lower it");
    Grids nothing;
    nothing["field"].push_back(energy_grid(slab_voxels, [](const Coord&) { return 0.0f; }));
    CHECK(failure_of([&] {
              solved_slabs(seam_pyramid(), "{count: -4, thickness: 4}", nothing);
          }).find("is 0 at all vertices") != std::string::npos);
}

TEST_CASE(
    "a seam file keeps the thickness, and refuses slabs whose seams do not run side by side") {
    const auto found = solved_slabs(seam_pyramid(), "{count: 6, thickness: 3}");
    auto volume = seams_to_volume(*found.seams);
    const auto back = seams_from_volume(volume);
    CHECK(back.thickness == 3);
    for (std::size_t n = 0; n < 6; ++n) CHECK(back.seams[n].at == found.seams->seams[n].at);
    auto wrong = *found.seams;
    std::swap(wrong.seams[1], wrong.seams[4]);
    CHECK(failure_of([&] { seams_from_volume(seams_to_volume(wrong)); }) ==
          "grid 'seam.0001' is part of a slab of 3 seams ('fluidcarve_thickness'), but does not "
          "run beside 'seam.0000'");
    volume.metadata.insertMeta("fluidcarve_thickness", openvdb::StringMetadata("0"));
    CHECK(failure_of([&] { seams_from_volume(volume); }) ==
          "'fluidcarve_thickness' must be a number of vertices from 1 to 40, not '0'");
}
