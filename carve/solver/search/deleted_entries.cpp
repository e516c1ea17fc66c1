#include "carve/solver/search/deleted_entries.h"

#include "carve/base/each_in_parallel.h"

#include <bit>

namespace fluidcarve {

namespace {

void mark(std::uint16_t& word, int bit) { word = static_cast<std::uint16_t>(word | (1u << bit)); }

}  // namespace

template <class Visit>
void DeletedEntries::each(std::span<std::uint16_t> at, const Visit& visit) {
    each_in_parallel(at.size(), 4096, [&](std::size_t c) {
        visit(store_.entries(0).subspan(c * words_, words_), at[c]);
    });
}

void DeletedEntries::to_original(std::span<std::uint16_t> at) {
    each(at, [](std::span<std::uint16_t> words, std::uint16_t& entry) {
        int left = entry;  // remaining entries before it
        std::size_t w = 0;
        const auto there_are = [&] { return 16 - std::popcount(words[w]); };
        for (; left >= there_are(); ++w) left -= there_are();
        auto there = static_cast<std::uint16_t>(~words[w]);
        for (; left > 0; --left) there = static_cast<std::uint16_t>(there & (there - 1));
        const int bit = std::countr_zero(there);
        mark(words[w], bit);
        entry = static_cast<std::uint16_t>(w * 16 + static_cast<std::size_t>(bit));
    });
}

void DeletedEntries::from_original(std::span<std::uint16_t> at) {
    each(at, [](std::span<std::uint16_t> words, std::uint16_t& entry) {
        const std::size_t w = entry / 16u;
        const int bit = entry % 16;
        int before = std::popcount(static_cast<std::uint16_t>(words[w] & ((1u << bit) - 1)));
        for (const auto word : words.first(w)) before += std::popcount(word);
        mark(words[w], bit);
        entry = static_cast<std::uint16_t>(entry - before);
    });
}

}  // namespace fluidcarve
