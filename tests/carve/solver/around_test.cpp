#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "carve/solver/search/find_seams.h"
#include "carve/solver/search/strip.h"
#include "tests/support/brute_force.h"
#include "tests/support/searches.h"
#include "tests/support/synthetic_energy.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {}  // namespace

TEST_CASE("greedy seams around a rig close across it, along it and in both, in any window") {
    std::mt19937 random(1);
    for (int n = 0; n < 1500; ++n) {
        const std::array<int, 3> size{1 + static_cast<int>(random() % 12),
                                      1 + static_cast<int>(random() % 8),
                                      1 + static_cast<int>(random() % 3)};
        const ColumnGraph graph(size, n % 2 == 0, true);
        const int width = 1 + static_cast<int>(random() % 12);
        auto energy = random_volume(random, graph, width, n % 5 == 0 ? 3 : 1024);
        if (n % 3 == 0) energy.set_step_prices({.rigidity = {2, 1}});
        const auto window = random_window(random, width);
        const auto seam =
            greedy_seam(energy, window, n, 3, nobody, n % 4 == 0 ? Guide::gaussian : Guide::cone);
        INFO("case " << n << ": " << size[0] << " x " << size[1] << " x " << size[2]);
        REQUIRE(is_seam(graph, Band::whole(graph.count(), window), seam.at));
        REQUIRE(seam.energy == Approx(energy_of(energy, seam.at)));
    }
}

TEST_CASE(
    "a pyramid of a volume too large for an exact cut closes around a rig, and is no dearer than "
    "greedy seams",
    "[long]") {
    for (const auto& size :
         {std::array{36, 20, 30}, std::array{37, 21, 30}, std::array{4001, 1, 20}}) {
        for (const bool closed : {false, true}) {
            const ColumnGraph graph(size, closed, true);
            const auto smoke = SyntheticEnergy(Synthetic::smoke, 4)(
                {24, size[0], size[1]}, static_cast<std::size_t>(size[2]));
            const auto energy = volume_of(graph, 24, energies_of(smoke));
            const Window window{1, 23};
            const auto seam = Pyramid(Quality::normal, 4)(energy, window, 0, nobody);
            INFO(size[0] << " x " << size[1] << " x " << size[2]);
            REQUIRE(is_seam(graph, Band::whole(graph.count(), window), seam.at));
            REQUIRE(seam.energy <= greedy_seam(energy, window, 0, 4, nobody).energy);
        }
    }
}
