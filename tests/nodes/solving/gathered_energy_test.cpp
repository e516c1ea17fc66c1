#include "carve/solver/task/gathered_energy.h"
#include "graph/types/node_type.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

const std::vector<int> frames{5, 6, 7};

SolverParams params_of(double count) {
    SolverParams out;
    out.count = {count, false};
    return out;
}

/// A sequence that is gathered.
struct Sequence {
    GatheredEnergy gathered;

    /// @param first  the lowest active voxel; all energies are 2
    void add(std::size_t t, const Lattice& lattice, const SolverParams& params,
             const Coord& first = Coord(0), const openvdb::GridBase* protect = nullptr) {
        const auto energy =
            energy_grid(CoordBBox(first, first.offsetBy(9)), [](const Coord&) { return 2.0f; });
        gathered.add(params,
                     sample_frame({*energy, nullptr, protect, nullptr},
                                  std::make_shared<Lattice>(lattice), Axis::u, Measure::vertex),
                     {frames[t], t, frames.size()}, {});
    }
    EnergyVolume taken(const SolverParams& params, const std::vector<Ref<Seams>>& after = {}) {
        return gathered.take_priced(params, CarvedSpace(gathered.lattices(), after, frames), {})
            .energy;
    }
};

}  // namespace

TEST_CASE(
    "an energy that is gathered once is that of all frames, as far as earlier seams leave it") {
    const auto lattice = box({6, 3, 2});
    const auto params = params_of(-1);
    Seams removal;
    removal.shape = lattice.shape;
    removal.frames = frames;
    removal.lattice_hash = lattice.hash;
    removal.seams = {{std::vector<std::uint16_t>(18, 1)}};
    for (const auto& after :
         {std::vector<Ref<Seams>>{}, std::vector<Ref<Seams>>{std::make_shared<Seams>(removal)}}) {
        Sequence sequence;
        sequence.add(0, lattice, params);
        auto energy = sequence.taken(params, after);
        CHECK(energy.width() == (after.empty() ? 6 : 5));
        REQUIRE(energy.frames() == 3);
        for (std::size_t t = 0; t < 3; ++t) {
            const auto codes = energy.codes(t);
            CHECK(std::ranges::count(codes, encode_energy(2)) ==
                  static_cast<std::ptrdiff_t>(codes.size()));
        }
    }
}

TEST_CASE("marks are counted over all frames") {
    const auto params = params_of(-1);
    const auto mask = mask_grid({Coord(0), Coord(1, 2, 1)});
    Sequence sequence;
    for (std::size_t t = 0; t < 3; ++t)
        sequence.add(t, box({6, 3, 2}), params, Coord(0), mask.get());
    CHECK(sequence.gathered.marks().protect == std::size_t{6});
    CHECK(!sequence.gathered.marks().attract);
    CHECK(sequence.taken(params).protects());
}

TEST_CASE(
    "content that is mostly beside the lattice is told before the search, once for all frames") {
    const auto warnings = [](const std::array<int, 3>& shape) {
        Sequence sequence;
        for (std::size_t t = 0; t < 3; ++t) sequence.add(t, box(shape), params_of(-1));
        return std::pair(*sequence.gathered.content_share(), sequence.gathered.warnings());
    };
    // The energy is the same everywhere, which is told, too.
    const auto [small, told] = warnings({6, 3, 2});
    CHECK(small == Approx(0.036));
    REQUIRE(told.size() == 2);
    CHECK(told[0] ==
          "3.6 % of the active voxels of `energy` lie in the lattice, and nothing else will "
          "change: if that is not meant, move the lattice (its rig, or `min` "
          "and `max`) or make it larger");
    CHECK(told[1] ==
          "`energy` is 2 at all vertices of the lattice in all frames: a seam costs the same "
          "wherever it goes, and will go anywhere; connect an energy that is "
          "high where the look must stay, such as energy.gradient");
    const auto [enough, same] = warnings({6, 3, 3});
    CHECK(enough == Approx(0.054));
    CHECK(same == std::vector<std::string>{told[1]});

    // A single tile of 128^3 voxels.
    const auto tile = FloatGrid::create();
    tile->tree().addTile(2, Coord(0), 1.0f, true);
    GatheredEnergy least;
    least.add(
        params_of(-1),
        sample_frame({*tile}, std::make_shared<Lattice>(box({4, 4, 4})), Axis::u, Measure::vertex),
        {}, {});
    CHECK(least.warnings().at(0).starts_with(
        "less than 0.01 % of the active voxels of `energy` lie in the lattice, and "));
}

TEST_CASE("masks that mark nothing say what values they wanted, if they are empty in all frames") {
    const auto params = params_of(-1);
    const auto empty = [](double low, double high) {
        auto out = MaskGrid::create();
        note_missed_range(*out, {{2, std::numeric_limits<double>::infinity()}, {low, high}});
        return out;
    };
    const auto warning = [&](const std::vector<MaskGrid::Ptr>& masks) {
        Sequence sequence;
        for (std::size_t t = 0; t < masks.size(); ++t)
            sequence.add(t, box({8, 8, 8}), params, Coord(0), masks[t].get());
        const auto out = sequence.gathered.warnings();
        return out.size() == 1 ? out[0] : std::string();
    };
    const std::string all =
        "`protect` is set around no vertex of the lattice: nothing is protected";
    CHECK(warning({empty(0.5, 1), empty(0, 0.75)}) ==
          all + "; its mask.threshold marks values from 2, but the field has 0 to 1 only");
    CHECK(warning({empty(0.5, 1), mask_grid({Coord(20)})}) == all);
    CHECK(warning({mask_grid({Coord(20)}), empty(0.5, 1)}) == all);
}

TEST_CASE("frames that do not go together, or lattices beside the energy, are told") {
    const auto params = params_of(-1);
    Sequence beside;
    beside.add(0, box({6, 3, 2}), params, Coord(100));
    CHECK(failure_of([&] { beside.gathered.require_met(); }) ==
          "the lattice misses the energy: its box of 6 x 3 x 2 vertices from (0, 0, 0) to (5, 2, "
          "1), spacing 1, axes xyz, but the active voxels span (100, 100, "
          "100) to (109, 109, 109); move the lattice (its rig, or `min` and `max`) or the data "
          "(`translate` and `scale` of its reader)");
    CHECK(failure_of([&] {
              beside.add(1, box({6, 3, 3}), params);
          }) == "the lattice has 6 x 3 x 3 vertices here, but 6 x 3 x 2 in the first frame");
    beside.add(1, box({6, 3, 2}), params);
    CHECK_NOTHROW(beside.gathered.require_met());
    // Nobody misses it if no seams are wanted.
    Sequence unwanted;
    unwanted.add(0, box({6, 3, 2}), params_of(0), Coord(100));
    CHECK_NOTHROW(unwanted.gathered.require_met());
    CHECK(unwanted.gathered.lattices().size() == 1);
}
