#include "carve/warp/find_warp.h"

#include "carve/solver/costs/code.h"
#include "carve/warp/weights.h"

#include <tbb/global_control.h>
#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <vector>

using namespace fluidcarve;

namespace {

const Tick nobody = [](double) {};

/// A lattice with weights, and the warp that is found in it.
struct Found {
    /// @param weight  of (u, lateral, k, t)
    Found(const std::array<int, 4>& size, const std::function<double(int, int, int, int)>& weight,
          const Warp::Rings& rings = {})
        : size(size),
          warp({size[0], size[1], size[2]}, rings, 1, static_cast<std::size_t>(size[3])),
          weights(warp.frames(), warp.values(0).size()) {
        task.window = {0, size[0] - 1};
        task.factors.assign(static_cast<std::size_t>(size[2] * size[3]), 1.0f);
        for (int t = 0; t < size[3]; ++t)
            for (std::size_t n = 0; n < warp.values(0).size(); ++n) {
                const int u = static_cast<int>(n) % size[0],
                          lateral = static_cast<int>(n) / size[0] % size[1],
                          k = static_cast<int>(n) / size[0] / size[1];
                weights.entries(static_cast<std::size_t>(t))[n] =
                    encode_energy(static_cast<float>(weight(u, lateral, k, t)));
            }
    }

    void find(double amount) {
        task.amount = amount;
        find_warp(task, warp, weights, nobody);
        warp.find_bounds();
    }
    std::size_t place(int u, int lateral, int k) const {
        return static_cast<std::size_t>(u + size[0] * (lateral + size[1] * k));
    }
    double weight(int u, int lateral, int k, int t) const {
        return static_cast<double>(
            decode_energy(weights.entries(static_cast<std::size_t>(t))[place(u, lateral, k)]));
    }
    double at(int u, int lateral = 0, int k = 0, int t = 0) const {
        return warp.scale() *
               static_cast<double>(warp.values(static_cast<std::size_t>(t))[place(u, lateral, k)]);
    }
    template <class Visit>
    void each(const Visit& visit) const {
        for (int t = 0; t < size[3]; ++t)
            for (int k = 0; k < size[2]; ++k)
                for (int lateral = 0; lateral < size[1]; ++lateral)
                    for (int u = 0; u < size[0]; ++u) visit(u, lateral, k, t);
    }

    std::array<int, 4> size;
    Warp warp;
    FrameStore weights;
    WarpTask task;
};

/// The solution of the same equations by Gaussian elimination, `[t][k][lateral][u]`, for an amount
/// of 1 everywhere.
std::vector<double> dense(const Found& found) {
    const auto& size = found.size;
    const auto count = static_cast<std::size_t>(size[0] * size[1] * size[2] * size[3]);
    const auto index = [&](std::array<int, 4> at) {
        return static_cast<std::size_t>(at[0] +
                                        size[0] * (at[1] + size[1] * (at[2] + size[2] * at[3])));
    };
    std::vector<std::vector<double>> rows(count, std::vector<double>(count + 1, 0.0));
    found.each([&](int u, int lateral, int k, int t) {
        const std::array at{u, lateral, k, t};
        auto& row = rows[index(at)];
        if (u == 0 || u == size[0] - 1) {
            row[index(at)] = 1;
            row[count] = u == 0 ? 0 : 1;
            return;
        }
        const std::array stiffness{1.0, found.task.stiffness.space, found.task.stiffness.space,
                                   found.task.stiffness.time};
        for (std::size_t d = 0; d < 4; ++d)
            for (const int step : {-1, 1}) {
                auto beside = at;
                beside[d] += step;
                if ((d == 1 && found.warp.rings().lateral) || (d == 2 && found.warp.rings().w))
                    beside[d] = (beside[d] + size[d]) % size[d];
                if (beside[d] < 0 || beside[d] >= size[d]) continue;
                const double link = 0.5 * stiffness[d] *
                                    (found.weight(u, lateral, k, t) +
                                     found.weight(beside[0], beside[1], beside[2], beside[3]));
                row[index(at)] += link;
                row[index(beside)] -= link;
            }
    });
    for (std::size_t n = 0; n < count; ++n)
        for (std::size_t other = 0; other < count; ++other) {
            if (other == n || rows[other][n] == 0) continue;
            const double times = rows[other][n] / rows[n][n];
            for (std::size_t column = n; column <= count; ++column)
                rows[other][column] -= times * rows[n][column];
        }
    std::vector<double> out;
    for (std::size_t n = 0; n < count; ++n) out.push_back(rows[n][count] / rows[n][n]);
    return out;
}

/// Weights from 0.3 to 30, without order.
std::function<double(int, int, int, int)> noise(unsigned seed) {
    auto random = std::make_shared<std::mt19937>(seed);
    return [random](int, int, int, int) {
        return 0.3 * std::pow(10.0, 2.0 * static_cast<double>((*random)() % 1000) / 1000);
    };
}

}  // namespace

TEST_CASE(
    "a warp solves its equations, in open and closed lattices, and around rigs, of any number of "
    "columns") {
    for (const auto& rings : {Warp::Rings{}, {false, true}, {true, false}, {true, true}})
        for (const auto& [laterals, slices] : {std::pair(3, 1), {3, 3}, {4, 3}, {3, 4}, {5, 5}}) {
            if (rings.w && slices < 3) continue;
            Found found({7, laterals, slices, 3}, noise(static_cast<unsigned>(slices)), rings);
            found.task.stiffness = {0.4, 1.5};
            found.find(-0.25);
            const auto want = dense(found);
            double error = 0;
            std::size_t n = 0;
            found.each([&](int u, int lateral, int k, int t) {
                error = std::max(error, std::abs(found.at(u, lateral, k, t) + 0.25 * want[n++]));
            });
            CHECK(error < 2e-5);
        }
}

TEST_CASE("with even weights a warp is even scaling") {
    Found found({41, 6, 5, 4}, [](int, int, int, int) { return 0.37; });
    for (const double amount : {-12.0, -7.25, 0.5, 30.0}) {
        found.find(amount);
        double error = 0;
        found.each([&](int u, int lateral, int k, int t) {
            error = std::max(error, std::abs(found.at(u, lateral, k, t) - amount * u / 40));
        });
        CHECK(error < 1e-4);
    }
}

TEST_CASE("layers in series share an amount by how soft they are") {
    // Between equal weights the slope is in proportion to 1 / weight.
    Found found({21, 3, 3, 2}, [](int u, int, int, int) { return u < 10 ? 1.0 : 4.0; });
    found.find(-5);
    CHECK(found.at(5) - found.at(4) == Approx(4 * (found.at(16) - found.at(15))).epsilon(1e-3));
    CHECK(found.at(20) == -5);
    CHECK(found.at(0) == 0);
}

TEST_CASE("mirrored weights make a mirrored warp") {
    const auto weight = [](int u, int lateral, int k, int t) {
        return 1 + u * 0.5 + (u * 7 + lateral * 3 + k * 5 + t) % 4;
    };
    Found one({16, 4, 5, 3}, weight), other({16, 4, 5, 3}, [&](int u, int lateral, int k, int t) {
        return weight(15 - u, lateral, k, t);
    });
    one.find(-4);
    other.find(-4);
    double error = 0;
    one.each([&](int u, int lateral, int k, int t) {
        error = std::max(error,
                         std::abs(-4 - one.at(u, lateral, k, t) - other.at(15 - u, lateral, k, t)));
    });
    CHECK(error < 1e-4);
}

TEST_CASE("as long as it is monotone, one warp answers all amounts by its scale") {
    Found one({24, 5, 4, 3}, noise(5)), other({24, 5, 4, 3}, noise(5));
    one.find(-1.5);
    REQUIRE(one.warp.linear());
    for (const double amount : {-0.25, 7.2}) {
        other.find(amount);
        REQUIRE(other.warp.linear());
        one.warp.set_scale(amount);
        one.each([&](int u, int lateral, int k, int t) {
            REQUIRE(one.at(u, lateral, k, t) == other.at(u, lateral, k, t));
        });
    }
    CHECK(most_linear(one.warp, -1) < 24);
    CHECK(most_linear(one.warp, 1) > 1e5);
}

TEST_CASE(
    "nothing moves below a window, and all moves alike above it, and a second window undoes that") {
    Found found({30, 4, 3, 2}, noise(7));
    found.task.window = {5, 12};
    found.find(-2);
    found.each([&](int u, int lateral, int k, int t) {
        if (u <= 5) REQUIRE(found.at(u, lateral, k, t) == 0);
        if (u >= 12) REQUIRE(found.at(u, lateral, k, t) == -2);
    });
    found.task.pair_window = Window{17, 26};
    found.find(2.5);
    found.each([&](int u, int lateral, int k, int t) {
        if (u <= 5 || u >= 26) REQUIRE(found.at(u, lateral, k, t) == 0);
        if (u >= 12 && u <= 17) REQUIRE(found.at(u, lateral, k, t) == 2.5);
    });
    CHECK(found.at(20) > 0);
    CHECK(found.at(20) < 2.5);
}

TEST_CASE("between two windows that give one half each, the middle stays") {
    Found found({31, 4, 3, 2}, [](int, int, int, int) { return 1.0; });
    found.task.pair_below = Window{2, 8};
    found.task.window = {10, 20};
    found.task.pair_window = Window{22, 28};
    found.find(-4);
    const auto wanted = [](int u) {
        if (u <= 2 || u >= 28) return 0.0;
        if (u <= 8) return 2.0 * (u - 2) / 6;
        if (u <= 10) return 2.0;
        if (u <= 20) return 2.0 - 4.0 * (u - 10) / 10;
        return u <= 22 ? -2.0 : -2.0 * (28 - u) / 6;
    };
    found.each([&](int u, int lateral, int k, int t) {
        REQUIRE(found.at(u, lateral, k, t) == Approx(wanted(u)).margin(1e-4));
    });
    // Each of them has room for one half: 5.4 of 6 intervals.
    found.task.amount = 10.7;
    CHECK_FALSE(no_room(found.task, found.warp, found.weights));
    found.task.amount = 10.9;
    const auto none = no_room(found.task, found.warp, found.weights);
    REQUIRE(none);
    CHECK(none->possible == Approx(10.8));
    CHECK(none->pair);
    CHECK(none->window.first == 2);
}

TEST_CASE("columns whose share is 0 do not move at all, others by their share") {
    Found found({20, 4, 6, 2}, noise(9));
    for (std::size_t t = 0; t < 2; ++t)
        for (std::size_t k = 0; k < 6; ++k)
            found.task.factors[t * 6 + k] = k < 3 ? 0.0f : static_cast<float>(k - 2) / 3;
    found.find(-3);
    found.each([&](int u, int lateral, int k, int t) {
        if (k < 3) REQUIRE(found.at(u, lateral, k, t) == 0);
        else if (u == 19) REQUIRE(found.at(u, lateral, k, t) == Approx(-(k - 2)));
    });
}

TEST_CASE("what is protected moves rigidly") {
    Found found({30, 5, 5, 3}, [](int u, int lateral, int, int) {
        return u >= 10 && u <= 18 && lateral < 3 ? static_cast<double>(rigid_weight) : 1.0;
    });
    found.find(-6);
    double most = 0;
    for (int t = 0; t < 3; ++t)
        for (int lateral = 0; lateral < 3; ++lateral)
            most =
                std::max(most, std::abs(found.at(18, lateral, 2, t) - found.at(10, lateral, 2, t)));
    CHECK(most < 5e-3);
    CHECK(found.at(29) == -6);
}

TEST_CASE(
    "space is squeezed by nine tenths at most: where it is softer than that, the rest gives too") {
    Found found({30, 4, 4, 3}, [](int u, int, int, int) {
        return u >= 10 && u <= 14 ? static_cast<double>(soft_weight) : 1.0;
    });
    found.find(-12);
    CHECK_FALSE(found.warp.linear());
    double least = 0;
    found.each([&](int u, int lateral, int k, int t) {
        if (u > 0)
            least = std::min(least, found.at(u, lateral, k, t) - found.at(u - 1, lateral, k, t));
        if (u == 29) REQUIRE(found.at(u, lateral, k, t) == -12);
    });
    CHECK(least > -most_squeezed - 1e-4);
    CHECK(found.at(14) - found.at(10) < -3.2);
}

TEST_CASE("an amount for which a column has no room is refused, with what is possible and where") {
    // Column (2, 1) of frame 1 has but 4 free intervals.
    Found found({21, 3, 2, 2}, [](int u, int lateral, int k, int t) {
        return lateral == 2 && k == 1 && t == 1 && u > 4 ? static_cast<double>(rigid_weight) : 1.0;
    });
    found.task.amount = -3.5;
    CHECK_FALSE(no_room(found.task, found.warp, found.weights));
    found.task.amount = -7.2;
    const auto none = no_room(found.task, found.warp, found.weights);
    REQUIRE(none);
    CHECK(none->possible == Approx(-3.6));
    CHECK(none->lateral == 2);
    CHECK(none->k == 1);
    CHECK(none->t == 1);
    CHECK(none->free == 4);
    CHECK(none->intervals == 20);
    found.task.amount = 7.2;
    CHECK_FALSE(no_room(found.task, found.warp, found.weights));
    Found all({21, 3, 2, 2}, [](int, int, int, int) { return static_cast<double>(rigid_weight); });
    all.task.amount = 7.2;
    REQUIRE(no_room(all.task, all.warp, all.weights));
    CHECK(no_room(all.task, all.warp, all.weights)->possible == 0);
}

TEST_CASE("a warp has the same bytes for any number of threads") {
    const auto found = [](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        auto out =
            std::make_unique<Found>(std::array{40, 17, 13, 5}, noise(11), Warp::Rings{false, true});
        out->find(-20);
        return out;
    };
    const auto one = found(1), four = found(4);
    for (std::size_t t = 0; t < 5; ++t)
        CHECK(std::memcmp(one->warp.values(t).data(), four->warp.values(t).data(),
                          one->warp.values(t).size_bytes()) == 0);
}
