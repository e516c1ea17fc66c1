#include "carve/seam/column_grid.h"
#include "carve/seam/seams.h"

#include <catch2/catch.hpp>

#include <numeric>
#include <vector>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::Vec3d;

namespace {

constexpr Warp::Rings both{.lateral = true, .w = true}, lateral{.lateral = true}, w{.w = true};

/// Columns of seams along u: laterals along v, slices along w.
ColumnGrid grid_of(int laterals, int slices, const Warp::Rings& rings = {},
                   const std::array<int, 3>& origin = {}) {
    Seams seams;
    seams.axis = Axis::u;
    seams.shape = {9, laterals, slices};
    seams.around = rings.lateral;
    seams.closed = rings.w;
    return {seams, origin};
}

}  // namespace

TEST_CASE("a point between columns has the four around it, and at the last ones these") {
    const auto cell = grid_of(4, 3).cell({2, 1.25, 0.5});
    CHECK(cell.columns == std::array<std::size_t, 4>{1, 2, 5, 6});
    CHECK(cell.lateral == 0.25);
    CHECK(cell.slice == 0.5);
    const auto last = grid_of(4, 3).cell({0, 3, 2});
    CHECK(last.columns == std::array<std::size_t, 4>{6, 7, 10, 11});
    CHECK(last.lateral == 1);
    CHECK(last.slice == 1);
    const auto beyond = grid_of(4, 3).cell({0, -0.25, 2.5});
    CHECK(beyond.columns == std::array<std::size_t, 4>{4, 5, 8, 9});
    CHECK(beyond.lateral == -0.25);
    CHECK(beyond.slice == 1.5);
    CHECK(grid_of(1, 1).cell({0, 0, 0}).columns == std::array<std::size_t, 4>{0, 0, 0, 0});
}

TEST_CASE("columns begin where their space begins") {
    const auto columns = grid_of(4, 3, {}, {-1, -2, 0});
    CHECK(columns.index(-2, 0) == 0);
    CHECK(columns.cell({0, -0.5, 1}).columns == std::array<std::size_t, 4>{5, 6, 9, 10});
    CHECK(columns.has(Coord(7, -2, 2)));
    CHECK_FALSE(columns.has(Coord(0, 2, 0)));
    CHECK_FALSE(columns.holds({0, 1.5, 0}));
}

TEST_CASE("in a ring, the first column is behind the last one") {
    const auto columns = grid_of(4, 3, both);
    const auto cell = columns.cell({0, 3.5, 2.25});
    CHECK(cell.columns == std::array<std::size_t, 4>{11, 8, 3, 0});
    CHECK(columns.index_within(-1, 3) == 3);
    CHECK(columns.index_within(4, 0) == 0);
    CHECK(columns.holds({0, 3.5, 2.5}));
    CHECK_FALSE(grid_of(4, 3).holds({0, 3.5, 1}));
    CHECK(grid_of(4, 3).index_within(4, 0) == 3);
    CHECK(grid_of(4, 3, w).index_within(4, 3) == 3);
    CHECK(grid_of(4, 3, lateral).index_within(4, 3) == 8);
}

TEST_CASE("a mean over columns goes round a ring, and repeats the outer columns of an open grid") {
    const auto mean_of_three = [](const float* const* rows, float* to) {
        *to = (*rows[0] + *rows[1] + *rows[2]) / 3;
    };
    std::vector<float> rows(4);
    std::iota(rows.begin(), rows.end(), 0.0f);
    auto ring = rows;
    grid_of(4, 1).average(rows.data(), 1, 3, mean_of_three);
    CHECK(rows == std::vector<float>{1.0f / 3, 1, 2, 8.0f / 3});
    grid_of(4, 1, both).average(ring.data(), 1, 3, mean_of_three);
    CHECK(ring == std::vector<float>{4.0f / 3, 1, 2, 5.0f / 3});
    std::vector<float> over_slices{0, 0, 3, 0};
    grid_of(1, 4).average(over_slices.data(), 1, 3, mean_of_three);
    CHECK(over_slices == std::vector<float>{0, 1, 1, 1});

    std::vector<float> of_both{0, 10, 1, 11, 2, 12, 3, 13, 4, 14, 5, 15};
    const auto mean_of_pairs = [](const float* const* from, float* to) {
        for (int n = 0; n < 2; ++n) to[n] = (from[0][n] + from[1][n] + from[2][n]) / 3;
    };
    grid_of(3, 2, lateral).average(of_both.data(), 2, 3, mean_of_pairs);
    CHECK(of_both == std::vector<float>{2, 12, 2, 12, 2, 12, 3, 13, 3, 13, 3, 13});
}
