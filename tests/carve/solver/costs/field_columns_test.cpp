#include "carve/solver/costs/field_columns.h"
#include "carve/solver/costs/energy_volume.h"
#include "tests/support/brute_force.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <random>
#include <vector>

using namespace fluidcarve;
using namespace fluidcarve::test;

// The field of an energy, which is held only where it is not 0.

namespace {

using Codes = std::vector<std::uint16_t>;

/// Columns with content in a part of each, in all of it, or in none.
Codes random_field(std::mt19937& random, std::size_t columns, int width) {
    Codes out;
    for (std::size_t c = 0; c < columns; ++c) {
        const auto bound = [&] {
            return static_cast<int>(random() % static_cast<unsigned>(width + 1));
        };
        const int first = bound(), last = bound();
        for (int entry = 0; entry < width; ++entry)
            out.push_back(entry < first || entry > last
                              ? 0
                              : encode_field(static_cast<float>(random() % 4) - 1));
    }
    return out;
}

/// A volume with energies in multiples of 1/4.
EnergyVolume random_energy(std::mt19937& random, std::size_t columns, int width,
                           std::size_t frames) {
    EnergyVolume out({{width, static_cast<int>(columns), 1}, Axis::u, frames});
    for (std::size_t t = 0; t < frames; ++t)
        for (auto& code : out.codes(t))
            code = random() % 8 == 0 ? protected_code
                                     : encode_energy(static_cast<float>(random() % 64) / 4);
    return out;
}

}  // namespace

TEST_CASE("a field reads the same as if all of it were held, while entries are deleted") {
    std::mt19937 random(1);
    constexpr std::size_t columns = 300, frames = 2;
    constexpr int width = 21;
    const Scratch scratch;
    for (const std::uint64_t budget : {~std::uint64_t{0}, std::uint64_t{0}}) {
        FieldColumns field(frames, columns, width, {budget, scratch.path()});
        std::vector<Codes> want;
        for (std::size_t t = 0; t < frames; ++t) {
            const auto codes = random_field(random, columns, width);
            // A frame that is set again holds what it was given last.
            field.set(t, random_field(random, columns, width));
            field.set(t, codes);
            for (std::size_t c = 0; c < columns; ++c)
                want.emplace_back(codes.begin() + static_cast<std::ptrdiff_t>(c * width),
                                  codes.begin() + static_cast<std::ptrdiff_t>((c + 1) * width));
        }
        for (int left = width; left > 0; --left) {
            for (std::size_t c = 0; c < want.size(); ++c) {
                const auto& run = field.runs()[c];
                const auto value = [&](int entry) {
                    return entry >= 0 && entry < left
                               ? decode_field(want[c][static_cast<std::size_t>(entry)])
                               : 0;
                };
                std::vector<float> many(width + 4), few(6);
                run.read(-2, many);
                for (int entry = -2; entry < width + 2; ++entry) {
                    INFO("column " << c << ", entry " << entry << " of " << left);
                    REQUIRE(run.value(entry) == value(entry));
                    REQUIRE(many[static_cast<std::size_t>(entry + 2)] == value(entry));
                    for (int n = 0; n < lane_count; ++n)
                        REQUIRE(run.values(entry)[n] == value(entry + n));
                    run.read(entry, few);
                    for (int n = 0; n < 6; ++n)
                        REQUIRE(few[static_cast<std::size_t>(n)] == value(entry + n));
                }
            }
            for (std::size_t c = 0; c < want.size(); ++c) {
                const auto entry = static_cast<int>(random() % static_cast<unsigned>(left));
                field.runs()[c].remove(entry, left - 1, nullptr);
                want[c].erase(want[c].begin() + entry);
            }
        }
    }
}

TEST_CASE(
    "deleted entries hand on their energy, and edges are counted anew, as if all of the field were "
    "held") {
    std::mt19937 random(2);
    constexpr std::size_t columns = 200, frames = 2;
    constexpr int width = 16;
    constexpr float weight = 0.5f;
    for (const int spread : {0, 1, 3}) {
        auto energy = random_energy(random, columns, width, frames);
        const auto last = columns * frames;
        // What the volume holds, column by column: energies without edges, and the field.
        std::vector<Codes> energies(last), field(last);
        energy.set_step_prices({.edge = weight});
        for (std::size_t t = 0; t < frames; ++t) {
            const auto codes = random_field(random, columns, width);
            energy.set_field(t, codes);
            REQUIRE(energy.field_codes(t) == codes);
            for (std::size_t n = 0; n < codes.size(); ++n) {
                energies[t * columns + n / width].push_back(energy.codes(t)[n]);
                field[t * columns + n / width].push_back(codes[n]);
            }
        }
        energy.count_edges({});
        energy.set_spread(spread, false);
        const Window window = spread == 3 ? Window{1, width - 2} : Window{0, width - 1};
        for (int left = width; left > 5; --left) {
            const Window now{window.first, window.last - (width - left)};
            Codes at;
            for (std::size_t c = 0; c < last; ++c) {
                const auto entry =
                    now.first + static_cast<int>(random() % static_cast<unsigned>(now.size()));
                at.push_back(static_cast<std::uint16_t>(entry));
                auto& codes = energies[c];
                const auto taken = codes.begin() + entry;
                std::vector<Codes::iterator> receivers;
                for (int e = std::max(entry - spread, now.first);
                     e <= std::min(entry + spread, now.last); ++e)
                    if (e != entry && codes[static_cast<std::size_t>(e)] < protected_code)
                        receivers.push_back(codes.begin() + e);
                if (*taken < protected_code)
                    for (const auto receiver : receivers)
                        *receiver = encode_energy(decode_energy(*receiver) +
                                                  decode_energy(*taken) /
                                                      static_cast<float>(receivers.size()));
                codes.erase(taken);
                field[c].erase(field[c].begin() + entry);
            }
            energy.remove(at, now);
            for (std::size_t c = 0; c < last; ++c)
                for (int entry = 0; entry < left - 1; ++entry) {
                    INFO("spread " << spread << ", column " << c << ", entry " << entry << " of "
                                   << left - 1);
                    const auto code = energies[c][static_cast<std::size_t>(entry)];
                    const auto value = [&](int e) {
                        return decode_field(
                            field[c][static_cast<std::size_t>(std::clamp(e, 0, left - 2))]);
                    };
                    const auto want =
                        code >= protected_code
                            ? code
                            : encode_energy(decode_energy(code) +
                                            weight * std::abs(value(entry + 1) - value(entry - 1)));
                    REQUIRE(
                        energy.codes(
                            c / columns)[c % columns * width + static_cast<std::size_t>(entry)] ==
                        want);
                }
        }
    }
}

TEST_CASE("a field that is not set is 0") {
    const FieldColumns field(2, 3, 10, {});
    for (const auto& run : field.runs()) {
        std::vector<float> values(10, 1.0f), few(4, 1.0f);
        run.read(0, values);
        run.read(-2, few);
        CHECK(std::ranges::count(values, 0.0f) == 10);
        CHECK(std::ranges::count(few, 0.0f) == 4);
        CHECK(run.value(9) == 0);
    }
}

TEST_CASE("a field takes memory where it is not 0") {
    constexpr std::size_t columns = 64;
    constexpr int width = 1000;
    FieldColumns field(1, columns, width, {});
    Codes codes(columns * width, 0);
    field.set(0, codes);
    const auto empty = field.bytes();
    CHECK(empty < codes.size() * sizeof(std::uint16_t) / 16);
    for (std::size_t c = 0; c < columns; ++c)
        codes[c * width + 500] = codes[c * width + 509] = encode_field(1);
    field.set(0, codes);
    // From one entry before to one behind.
    CHECK(field.bytes() == empty + columns * 12 * sizeof(std::uint16_t));
}
