#include "carve/solver/search/skewed_messages.h"
#include "tests/support/brute_force.h"
#include "tests/support/searches.h"

#include <catch2/catch.hpp>

#include <vector>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {

constexpr int entries = ColumnMessages::most_entries;
using Place = std::array<int, 3>;

/// The same messages, column by column.
class Plain {
public:
    Plain(const Strip& strip, std::array<int, 3> size)
        : strip_(strip), size_(size), messages_(strip.columns().count()) {}

    /// @param tile   columns along each dimension
    /// @param turns  in each tile
    void pass(bool forward, const Place& tile, int turns) {
        const auto tiles = [&](std::size_t d) { return (size_[d] + tile[d] - 1) / tile[d]; };
        for (int t = 0; t < tiles(2); ++t)
            for (int k = 0; k < tiles(1); ++k) {
                Place begin{0, k * tile[1], t * tile[2]},
                    end{size_[0], std::min(begin[1] + tile[1], size_[1]),
                        std::min(begin[2] + tile[2], size_[2])};
                // Slices are grouped from the first one on, frames from the one that is visited
                // first.
                if (!forward) {
                    begin[1] = (tiles(1) - 1 - k) * tile[1];
                    end[1] = std::min(begin[1] + tile[1], size_[1]);
                    const int last = size_[2] - begin[2];
                    begin[2] = size_[2] - end[2];
                    end[2] = last;
                }
                for (int turn = 0; turn < turns; ++turn)
                    visit(begin, end, forward == (turn % 2 == 0), turn + 1 == turns);
            }
    }

    const std::array<float, entries>& message(std::size_t column, std::size_t d) const {
        return messages_[column][d];
    }

private:
    std::size_t column(const Place& at) const {
        return strip_.columns().at(static_cast<std::size_t>(at[0]), static_cast<std::size_t>(at[1]),
                                   static_cast<std::size_t>(at[2]));
    }

    void visit(const Place& begin, const Place& end, bool forward, bool leaves) {
        Place at, from = begin, to = end;
        const auto place = [&](std::size_t d, int n) {
            return forward ? n : from[d] + to[d] - 1 - n;
        };
        for (int t = begin[2]; t < end[2]; ++t)
            for (int k = begin[1]; k < end[1]; ++k)
                for (int l = begin[0]; l < end[0]; ++l) {
                    at = {place(0, l), place(1, k), place(2, t)};
                    visit(at, forward, [&](std::size_t d, int there) {
                        return leaves || (there >= begin[d] && there < end[d]);
                    });
                }
    }

    template <class Sends>
    void visit(const Place& at, bool forward, const Sends& sends) {
        const auto here = column(at);
        std::array<float, entries> sum;
        for (int e = 0; e < entries; ++e)
            sum[static_cast<std::size_t>(e)] = strip_.energies(here)[e];
        int lines = 0;
        const auto beside = [&](std::size_t d, int by) {
            auto other = at;
            other[d] += by;
            return other;
        };
        const auto is = [&](std::size_t d, int by) {
            return at[d] + by >= 0 && at[d] + by < size_[d];
        };
        for (std::size_t d = 0; d < 3; ++d) {
            lines += size_[d] > 1 ? 1 : 0;
            for (std::size_t e = 0; e < entries; ++e) {
                if (is(d, 1)) sum[e] += messages_[here][d][e];
                if (is(d, -1)) sum[e] += messages_[column(beside(d, -1))][d][e];
            }
        }
        const int by = forward ? 1 : -1;
        for (std::size_t d = 0; d < 3; ++d) {
            if (!is(d, by) || !sends(d, at[d] + by)) continue;
            const auto there = column(beside(d, by));
            auto& message = messages_[forward ? here : there][d];
            std::array<float, entries> part, sent;
            for (std::size_t e = 0; e < entries; ++e)
                part[e] = sum[e] / static_cast<float>(lines) - message[e];
            for (int f = 0; f < entries; ++f) {
                float least = std::numeric_limits<float>::infinity();
                for (int e = 0; e < entries; ++e) {
                    const int entry = strip_[here].first + e, other = strip_[there].first + f;
                    if (std::abs(entry - other) > 1) continue;
                    const float step =
                        entry == other ? 0 : strip_.steps()(here, entry, there, other, d == 2);
                    least = std::min(least,
                                     part[static_cast<std::size_t>(e)] - part[entries / 2] + step);
                }
                sent[static_cast<std::size_t>(f)] = least;
            }
            message = sent;
        }
    }

    const Strip& strip_;
    std::array<int, 3> size_;
    std::vector<std::array<std::array<float, entries>, 3>> messages_;
};

}  // namespace

TEST_CASE(
    "messages of eight slices at once are those of column after column, whatever steps cost, in "
    "tiles or not") {
    std::mt19937 random(1);
    struct Case {
        std::array<int, 3> size;
        Place tile;
    };
    // Few columns are one tile; many are divided into tiles of eight slices and eight frames.
    for (const auto& [size, tile] :
         {Case{{5, 8, 1}, {5, 8, 1}}, Case{{1, 9, 3}, {1, 16, 3}}, Case{{13, 19, 4}, {13, 24, 4}},
          Case{{21, 23, 19}, {21, 8, 8}}})
        for (const auto stepping : {Stepping::free, Stepping::rigid, Stepping::field})
            for (const int turns : {1, 3}) {
                const ColumnGraph graph(size);
                const Window window{1, 14};
                auto energy = random_volume(random, graph, 16);
                if (stepping != Stepping::free) energy.set_rigidity({0.1f, 0.2f});
                if (stepping == Stepping::field)
                    add_field(energy, 0.5f,
                              [&](auto, auto) { return static_cast<float>(random() % 100) / 50; });
                const Strip strip(
                    energy, Band::around(random_seam(random, graph, window), entries / 2, window));
                REQUIRE(SkewedMessages::fits(strip));
                std::vector<ColumnMessages> messages(strip.columns().count());
                SkewedMessages skewed(strip, messages.data(), {});
                skewed.to_and_fro(turns, quiet);
                Plain plain(strip, size);
                for (const bool forward : {true, false}) plain.pass(forward, tile, turns);
                skewed.write(messages.data());
                INFO(size[0] << " x " << size[1] << " x " << size[2] << ", stepping "
                             << static_cast<int>(stepping) << ", turns " << turns);
                double worst = 0;
                for (std::size_t c = 0; c < messages.size(); ++c)
                    for (std::size_t d = 0; d < 3; ++d)
                        for (std::size_t e = 0; e < entries; ++e)
                            worst = std::max<double>(
                                worst, std::abs(messages[c].along[d][e] - plain.message(c, d)[e]));
                CHECK(worst < 1e-4);
            }
}

TEST_CASE("messages of eight slices that are not passed are written as they were given") {
    std::mt19937 random(2);
    const ColumnGraph graph({6, 11, 3});
    const auto energy = random_volume(random, graph, 12);
    const Strip strip(energy,
                      Band::around(random_seam(random, graph, {0, 11}), entries / 2, {0, 11}));
    std::vector<ColumnMessages> given(strip.columns().count()), written = given;
    for (auto& each : given)
        for (auto& message : each.along)
            for (int e = 0; e < entries; ++e) message[e] = static_cast<float>(random() % 100);
    SkewedMessages(strip, given.data(), {}).write(written.data());
    for (std::size_t c = 0; c < given.size(); ++c) {
        const auto place = strip.columns().place(c);
        const std::array next{place.lateral + 1 < 6, place.k + 1 < 11, place.t + 1 < 3};
        for (std::size_t d = 0; d < 3; ++d)
            for (int e = 0; e < entries; ++e)
                REQUIRE(written[c].along[d][e] == (next[d] ? given[c].along[d][e] : 0));
    }
}

TEST_CASE(
    "messages of rings, past protected vertices and in few slices or narrow strips are passed one "
    "column at a time") {
    std::mt19937 random(3);
    const auto fits = [&](const ColumnGraph& graph, Window window, bool guarded) {
        auto energy = random_volume(random, graph, 12);
        if (guarded) {
            energy.codes(0)[0] = protected_code;
            energy.find_marks();
        }
        return SkewedMessages::fits(
            {energy, Band::around(random_seam(random, graph, window), entries / 2, window)});
    };
    const Window wide{2, 10};
    CHECK(fits(ColumnGraph({4, 8, 2}), wide, false));
    CHECK_FALSE(fits(ColumnGraph({4, 7, 2}), wide, false));
    CHECK_FALSE(fits(ColumnGraph({4, 8, 2}), {0, 5}, false));
    CHECK_FALSE(fits(ColumnGraph({4, 8, 2}), wide, true));
    CHECK_FALSE(fits(ColumnGraph({4, 8, 2}, true), wide, false));
    CHECK_FALSE(fits(ColumnGraph({4, 8, 2}, false, true), wide, false));
}
