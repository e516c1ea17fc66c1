#include "nodes/seam/solve/gathered_energy.h"
#include "tests/support/solver_bench.h"

#include <catch2/catch.hpp>

#include <algorithm>

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
    Listener listener;
    GatheredEnergy gathered;
    Context context = Context(listener, frames);

    /// @param first  the lowest active voxel; all energies are 2
    void add(std::size_t t, const Lattice& lattice, const SolverParams& params, const Coord& first = Coord(0), const openvdb::GridBase* protect = nullptr) {
        const auto energy = energy_grid(CoordBBox(first, first.offsetBy(9)), [](const Coord&) { return 2.0f; });
        gathered.add(params, sample_frame({*energy, nullptr, protect, nullptr}, std::make_shared<Lattice>(lattice), Axis::u, Measure::vertex), context.at(t));
    }
    EnergyVolume taken(const SolverParams& params, const std::vector<Ref<Seams>>& after = {}) {
        return gathered.take(params, CarvedSpace(gathered.lattices(), after, frames), context);
    }
};

}  // namespace

TEST_CASE("an energy that is gathered once is that of all frames, as far as earlier seams leave it") {
    const auto lattice = box({6, 3, 2});
    const auto params = params_of(-1);
    Seams removal;
    removal.shape = lattice.shape;
    removal.frames = frames;
    removal.lattice_hash = lattice.hash;
    removal.seams = {{std::vector<std::uint16_t>(18, 1)}};
    for (const auto& after : {std::vector<Ref<Seams>>{}, std::vector<Ref<Seams>>{std::make_shared<Seams>(removal)}}) {
        Sequence sequence;
        sequence.add(0, lattice, params);
        auto energy = sequence.taken(params, after);
        CHECK(energy.width() == (after.empty() ? 6 : 5));
        REQUIRE(energy.frames() == 3);
        for (std::size_t t = 0; t < 3; ++t) {
            const auto slab = energy.slab(t);
            CHECK(std::count(slab.begin(), slab.end(), encode_energy(2)) == static_cast<std::ptrdiff_t>(slab.size()));
        }
    }
}

TEST_CASE("marks are counted over all frames") {
    const auto params = params_of(-1);
    const auto mask = mask_grid({Coord(0), Coord(1, 2, 1)});
    Sequence sequence;
    for (std::size_t t = 0; t < 3; ++t) sequence.add(t, box({6, 3, 2}), params, Coord(0), mask.get());
    CHECK(sequence.gathered.marks().protect == std::size_t{6});
    CHECK(!sequence.gathered.marks().attract);
    CHECK(sequence.taken(params).protects());
}

TEST_CASE("frames that do not go together, or lattices beside the energy, are told") {
    const auto params = params_of(-1);
    Sequence beside;
    beside.add(0, box({6, 3, 2}), params, Coord(100));
    CHECK(failure_of([&] { beside.gathered.require_met(); }).find("the lattice misses the energy: its ") == 0);
    CHECK(failure_of([&] { beside.add(1, box({6, 3, 3}), params); }) == "the lattice has 6 x 3 x 3 vertices here, but 6 x 3 x 2 in the first frame");
    beside.add(1, box({6, 3, 2}), params);
    CHECK_NOTHROW(beside.gathered.require_met());
    // Nobody misses it if no seams are wanted.
    Sequence unwanted;
    unwanted.add(0, box({6, 3, 2}), params_of(0), Coord(100));
    CHECK_NOTHROW(unwanted.gathered.require_met());
    CHECK(unwanted.gathered.lattices().size() == 1);
}
