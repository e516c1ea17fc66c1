#include "carve/solver/search/kept_memory.h"

#include <catch2/catch.hpp>

#include <cstdint>
#include <optional>

using namespace fluidcarve;

TEST_CASE("an array that is given back is taken again") {
    const KeptMemory memory;
    const float* before = nullptr;
    {
        const auto array = memory.array<float>(1000);
        REQUIRE(array.size() == 1000);
        before = array.data();
    }
    CHECK(memory.array<float>(1000).data() == before);
    // Seams of a narrower window need a little less.
    CHECK(memory.array<float>(900).data() == before);
    const auto taken = memory.array<float>(1000);
    CHECK(memory.array<float>(1000).data() != taken.data());
}

TEST_CASE("a small array leaves a large block to those that need it") {
    const KeptMemory memory;
    const auto* const large = memory.array<float>(1000).data();
    const auto small = memory.array<float>(100);
    CHECK(small.data() != large);
    CHECK(memory.array<float>(1000).data() == large);
}

TEST_CASE(
    "an array takes the smallest block that fits, so that each block is found again by those that "
    "need all of it") {
    const KeptMemory memory;
    const float *larger = nullptr, *smaller = nullptr;
    {
        const auto one = memory.array<float>(1100), other = memory.array<float>(1000);
        larger = one.data();
        smaller = other.data();
    }
    const auto first = memory.array<float>(1000), second = memory.array<float>(1100);
    CHECK(first.data() == smaller);
    CHECK(second.data() == larger);
}

TEST_CASE("copies of kept memory share it") {
    const KeptMemory memory;
    const auto copy = memory;
    const auto* const before = memory.array<std::uint16_t>(5000).data();
    CHECK(copy.array<std::uint16_t>(5000).data() == before);
}

TEST_CASE("an array outlives the memory that it was taken from") {
    std::optional<KeptMemory> memory(std::in_place);
    auto array = memory->array<int>(10);
    memory.reset();
    array[9] = 7;
    CHECK(array[9] == 7);
    CHECK(reinterpret_cast<std::uintptr_t>(array.data()) % 64 == 0);
}

TEST_CASE("an empty array is an array") { CHECK(KeptMemory().array<float>(0).size() == 0); }
