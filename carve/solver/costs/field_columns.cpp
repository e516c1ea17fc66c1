#include "carve/solver/costs/field_columns.h"

#include "carve/base/each_in_parallel.h"
#include "carve/solver/costs/decode.h"

#include <algorithm>
#include <utility>

namespace fluidcarve {

namespace {

/// Columns that one thread takes at a time.
constexpr std::size_t columns_at_once = 1024;

/// Up to this many entries are decoded four by four, without a check for the end of the run.
constexpr std::size_t most_by_lanes = 4 * lane_count;

/// The range from the first to the last entry that is not 0, with one more entry at each end if it
/// exists.
FieldRun run_in(std::span<const std::uint16_t> codes) {
    std::size_t first = 0, end = codes.size();
    while (first < end && codes[first] == 0) ++first;
    if (first == end) return {};
    while (codes[end - 1] == 0) --end;
    FieldRun out;
    out.first = static_cast<int>(first > 0 ? first - 1 : first);
    out.end = static_cast<int>(std::min(end + 1, codes.size()));
    return out;
}

}  // namespace

void FieldRun::read(int entry, std::span<float> out) const {
    if (out.size() >= lane_count && out.size() <= most_by_lanes) {
        const auto last = out.size() - lane_count;
        for (std::size_t n = 0; n < last; n += lane_count)
            store_values(values(entry + static_cast<int>(n)), &out[n]);
        store_values(values(entry + static_cast<int>(last)), &out[last]);
        return;
    }
    const int from = std::max(entry, first),
              to = std::min(entry + static_cast<int>(out.size()), end);
    if (from >= to) {
        std::ranges::fill(out, 0.0f);
        return;
    }
    const auto before = static_cast<std::size_t>(from - entry),
               count = static_cast<std::size_t>(to - from);
    std::ranges::fill(out.first(before), 0.0f);
    decode_fields({codes + (from - first), count}, out.subspan(before));
    std::ranges::fill(out.subspan(before + count), 0.0f);
}

void FieldRun::remove(int entry, int width, const std::uint16_t* column) {
    if (entry >= end) return;
    const bool before = entry < first, at_begin = entry == first && first > 0,
               at_end = entry == end - 1 && end <= width;
    // The removed entry was an end of the run: the next entry, which is 0, takes its place.
    if (before || at_begin) {
        --first;
        --end;
    } else if (!at_end) {
        for (auto* const values : {codes, energies})
            if (values)
                std::copy(values + (entry - first) + 1, values + (end - first),
                          values + (entry - first));
        --end;
    }
    if (!energies) return;
    if (at_begin) energy(first) = column[first];
    if (at_end) energy(end - 1) = column[end - 1];
}

FieldColumns::FieldColumns(std::size_t frames, std::size_t columns, int width, const Limits& limits)
    : columns_(columns),
      width_(static_cast<std::size_t>(width)),
      fields_(frames, limits),
      nothing_(2 * margin()),
      runs_(frames * columns, FieldRun{.codes = nothing_.data() + margin()}) {}

void FieldColumns::set(std::size_t t, std::span<const std::uint16_t> codes) {
    const auto runs = std::span(runs_).subspan(t * columns_, codes.size() / width_);
    const auto for_columns = [&](const auto& call) {
        each_in_parallel(runs.size(), columns_at_once,
                         [&](std::size_t c) { call(runs[c], codes.subspan(c * width_, width_)); });
    };
    for_columns([](FieldRun& run, std::span<const std::uint16_t> column) { run = run_in(column); });
    for (const auto end = t + runs.size() / columns_; t < end; ++t)
        make(fields_, t, &FieldRun::codes);
    for_columns([](const FieldRun& run, std::span<const std::uint16_t> column) {
        std::copy(column.begin() + run.first, column.begin() + run.end, run.codes);
    });
}

void FieldColumns::make(Codes& codes, std::size_t t, std::uint16_t* FieldRun::*of) {
    const auto runs = std::span(runs_).subspan(t * columns_, columns_);
    std::size_t count = 0;
    for (const auto& run : runs) count += static_cast<std::size_t>(run.end - run.first);
    auto* room = codes.make(t, count + 2 * margin()) + margin();
    for (auto& run : runs) {
        run.*of = room;
        room += run.end - run.first;
    }
}

void FieldColumns::add_energies(const Limits& limits) {
    const auto frames = runs_.size() / columns_;
    energies_.emplace(frames, limits);
    for (std::size_t t = 0; t < frames; ++t) make(*energies_, t, &FieldRun::energies);
}

std::uint64_t FieldColumns::bytes() const {
    return runs_.size() * sizeof(FieldRun) + fields_.bytes() + (energies_ ? energies_->bytes() : 0);
}

FieldColumns::Codes::Codes(std::size_t frames, Limits limits) : limits_(std::move(limits)) {
    for (std::size_t t = 0; t < frames; ++t) stores_.emplace_back(1, 0);
}

std::uint16_t* FieldColumns::Codes::make(std::size_t t, std::size_t count) {
    stores_[t] = FrameStore(1, 0);
    const auto taken = bytes();
    stores_[t] =
        FrameStore(1, count, {taken < limits_.memory ? limits_.memory - taken : 0, limits_.folder});
    return stores_[t].entries(0).data();
}

std::uint64_t FieldColumns::Codes::bytes() const {
    std::uint64_t out = 0;
    for (const auto& store : stores_) out += store.entries(0).size_bytes();
    return out;
}

}  // namespace fluidcarve
