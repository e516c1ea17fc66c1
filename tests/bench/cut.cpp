#include "tests/bench/cut.h"

#include "carve/solver/cut/cut.h"
#include "tests/bench/measure.h"
#include "tests/support/synthetic_energy.h"

#include <fmt/ranges.h>

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>

#include <jemalloc/jemalloc.h>
#include <cmath>
#include <stdexcept>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {

/// Bytes that this process has asked for and not given back.
double bytes_held() {
    std::uint64_t epoch = 1;
    std::size_t held = 0, size = sizeof held;
    mallctl("epoch", nullptr, nullptr, &epoch, sizeof epoch);
    mallctl("stats.allocated", &held, &size, nullptr, 0);
    return static_cast<double>(held);
}

/// Energies as whole numbers, a column after the other.
struct WholeCosts {
    Columns columns;
    int width;
    std::vector<std::int32_t> costs;

    explicit WholeCosts(const EnergyVolume& energy) : columns(energy), width(energy.width()) {
        for (std::size_t t = 0; t < energy.frames(); ++t)
            for (std::size_t n = 0; n < energy.columns_per_frame() * energy.stride(); ++n)
                costs.push_back(
                    static_cast<std::int32_t>(std::ldexp(decode_energy(energy.codes(t)[n]), 20)));
    }
    const std::int32_t* of(std::size_t column) const {
        return costs.data() + column * static_cast<std::size_t>(width);
    }
};

struct Solved {
    std::int64_t flow;
    double bytes;  ///< of the graph
};

Solved cut(const WholeCosts& given) {
    const auto band = Band::whole(given.columns.count(), {0, given.width - 1});
    const double before = bytes_held();
    Cut cut(given.columns, band, [&](std::size_t c, Band::Column range, std::int32_t* costs) {
        std::copy_n(given.of(c) + range.first, range.last - range.first + 1, costs);
    });
    const double held = bytes_held() - before;
    if (!cut.solve(0, [] {})) throw std::runtime_error("the costs are too high for the cut");
    return {cut.flow(), held};
}

using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
using Graph = boost::adjacency_list<
    boost::vecS, boost::vecS, boost::directedS,
    boost::property<boost::vertex_index_t, long,
                    boost::property<boost::vertex_color_t, boost::default_color_type,
                                    boost::property<boost::vertex_distance_t, long,
                                                    boost::property<boost::vertex_predecessor_t,
                                                                    Traits::edge_descriptor>>>>,
    boost::property<
        boost::edge_capacity_t, std::int64_t,
        boost::property<boost::edge_residual_capacity_t, std::int64_t,
                        boost::property<boost::edge_reverse_t, Traits::edge_descriptor>>>>;

/// The same graph in a general library.
Solved boykov_kolmogorov(const WholeCosts& given) {
    constexpr std::int64_t endless = std::int64_t{1} << 40;
    const auto inner = static_cast<std::size_t>(given.width - 1),
               source = given.columns.count() * inner, sink = source + 1;
    const double before = bytes_held();
    Graph graph(sink + 1);
    const auto capacity = get(boost::edge_capacity, graph);
    const auto reverse = get(boost::edge_reverse, graph);
    const auto join = [&](std::size_t from, std::size_t to, std::int64_t there, std::int64_t back) {
        const auto forth = add_edge(from, to, graph).first, home = add_edge(to, from, graph).first;
        capacity[forth] = there;
        capacity[home] = back;
        reverse[forth] = home;
        reverse[home] = forth;
    };
    for (std::size_t c = 0; c < given.columns.count(); ++c) {
        const auto* const costs = given.of(c);
        const auto first = c * inner;
        join(source, first, costs[0], 0);
        for (std::size_t n = 0; n + 1 < inner; ++n)
            join(first + n, first + n + 1, costs[n + 1], endless);
        join(first + inner - 1, sink, costs[inner], 0);
        for (const auto other : given.columns.neighbours(c, given.columns.place(c)))
            if (other != Columns::none)
                for (std::size_t n = 1; n < inner; ++n)
                    join(first + n, other * inner + n - 1, endless, 0);
    }
    const double held = bytes_held() - before;
    return {boykov_kolmogorov_max_flow(graph, source, sink), held};
}

}  // namespace

void bench_cut() {
    struct Case {
        std::string name;
        Synthetic kind;
        std::array<int, 3> shape;
        std::size_t frames;
    };
    // Boost takes minutes for noise of the same size.
    for (const auto& [name, kind, shape, frames] :
         {Case{"smoke", Synthetic::smoke, {64, 48, 64}, 10},
          Case{"noise", Synthetic::noise, {24, 16, 20}, 4}}) {
        const WholeCosts given(SyntheticEnergy(kind, 1)(shape, frames));
        Solved ours{}, theirs{};
        const auto solve = [&] { return seconds(3, [&] { ours = cut(given); }); };
        const double one = with_threads(1, solve), two = with_threads(2, solve);
        const double general = seconds(1, [&] { theirs = boykov_kolmogorov(given); });
        if (ours.flow != theirs.flow)
            throw std::runtime_error(
                fmt::format("the cut's flow is {}, Boost's {}", ours.flow, theirs.flow));
        const auto nodes = static_cast<double>(given.columns.count()) * (given.width - 1);
        const auto of = fmt::format("{} {} x {}: ", name, fmt::join(shape, "x"), frames);
        const auto what = of + "Boost's max flow / seam.graph_cut";
        line(what + ", 1 thread", general / one, fmt::format("{:.2f} s, {:.3f} s", general, one));
        line(what + ", 2 threads", general / two, fmt::format("{:.3f} s", two));
        line(of + "memory for a node: Boost's / ours", theirs.bytes / ours.bytes,
             fmt::format("{:.0f} bytes, {:.1f} bytes with its share of a column",
                         theirs.bytes / nodes, ours.bytes / nodes));
    }
}
