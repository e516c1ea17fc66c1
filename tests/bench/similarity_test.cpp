#include "tests/bench/similarity.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

namespace {

/// Eddies of about four vertices, in 64 x 24 x 12 vertices and one frame.
Samples eddies(unsigned seed = 1) {
    Samples out(1, {64, 24, 12}, false, false);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> phase(0, 6.28f), turns(1.0f, 1.7f), sign(-1, 1);
    struct Wave {
        float phase, u, v, w;
    };
    std::vector<Wave> waves;
    for (int n = 0; n < 40; ++n) {
        const float a = phase(random), b = sign(random), length = turns(random),
                    flat = std::sqrt(1 - b * b);
        waves.push_back(
            {phase(random), length * flat * std::cos(a), length * flat * std::sin(a), length * b});
    }
    std::size_t n = 0;
    for (int k = 0; k < 12; ++k)
        for (int j = 0; j < 24; ++j)
            for (int i = 0; i < 64; ++i) {
                float sum = 8;
                for (const auto& wave : waves)
                    sum +=
                        std::sin(wave.phase + wave.u * static_cast<float>(i) +
                                 wave.v * static_cast<float>(j) + wave.w * static_cast<float>(k));
                out.values[n++] = std::max(0.0f, sum);
            }
    return out;
}

Samples scaled(const Samples& source, std::size_t width) {
    const double step = static_cast<double>(source.shape[0] - 1) / static_cast<double>(width - 1);
    return stretched(source, width, [=](double i) { return i * step; });
}

/// A place of so many vertices doubled so many times side by side.
Samples comb(const Samples& source, std::size_t first, std::size_t size, std::size_t copies) {
    return stretched(source, source.shape[0] + copies * size, [=](double i) {
        const auto at = static_cast<std::size_t>(i);
        return static_cast<double>(at < first + size                  ? at
                                   : at < first + (copies + 1) * size ? first + (at - first) % size
                                                                      : at - copies * size);
    });
}

}  // namespace

TEST_CASE("form is 0 under even scaling, and 1 where whole vertices are taken out at one place") {
    const auto source = eddies();
    for (const std::size_t width : {48u, 85u}) {
        const auto even = scaled(source, width);
        CHECK(looks_of(even, source, even, 16).form.value() == Approx(0).margin(1e-9));
    }
    const auto cut = stretched(source, 48, [](double i) { return i < 24 ? i : i + 16; });
    CHECK(looks_of(cut, source, scaled(source, 48), 16).form.value() > 0.8);
}

TEST_CASE(
    "a comb of copies is told by what is repeated, though each of its patches comes from the "
    "input") {
    const auto source = eddies();
    const auto three = comb(source, 20, 8, 3), even = scaled(source, three.shape[0]);
    const auto of_comb = looks_of(three, source, even, 24);
    CHECK(of_comb.coherence[0] < 0.9);
    CHECK(of_comb.repeated > 2.5);
    CHECK(looks_of(even, source, even, 24).repeated == Approx(1).epsilon(0.05));
}

TEST_CASE("a crop is told by what is lost, and even scaling loses what it is measured by") {
    const auto source = eddies();
    const auto even = scaled(source, 44);
    const auto crop = stretched(source, 44, [](double i) { return i + 20; });
    CHECK(looks_of(even, source, even, 20).lost == Approx(1).epsilon(0.05));
    CHECK(looks_of(crop, source, even, 20).lost > 2);
}
