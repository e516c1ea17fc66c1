#include "carve/solver/search/bound.h"

#include "carve/base/frame_store.h"
#include "carve/simd/wide.h"
#include "carve/solver/costs/decode.h"
#include "carve/solver/search/bound_column.h"
#include "carve/solver/search/bound_messages.h"
#include "carve/solver/search/coarse.h"
#include "carve/solver/search/columns.h"
#include "carve/solver/search/wavefront.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

/// Passes to and fro at half the resolution; and how many times more at each coarser one, up to the
/// most.
constexpr int passes_at_half = 2, times_more = 2, most_passes = 64;

/// Frames in a block, and entries in it, at most; but at least two frames.
constexpr std::size_t frames_per_block = 8, entries_per_block = std::size_t{1} << 26;

/// Columns along each dimension that a thread visits one after the other.
constexpr std::array<std::size_t, 3> box_of_columns{16, 4, 2};

/// Share of a column's costs that is left out of the bound, since sums of floats are rounded. In
/// each column some ten roundings, each by at most 2^-24 of a sum of terms above 0, could divide
/// more among the lines than there is.
constexpr float rounding = 0x1p-19f;

/// By how much a message may be larger than its upper half, as a share of that.
constexpr double largest_cut = 0x1p-7;

/// The dimension of lines through the frames.
constexpr std::size_t time = 2;

Sizes sizes(const Columns& columns) {
    return {columns.laterals(), columns.slices(), columns.frames()};
}

/// The dimensions of more than one column; the first if there is none.
std::vector<std::size_t> dimensions_of_lines(const Columns& columns) {
    std::vector<std::size_t> out;
    for (std::size_t d = 0; d < 3; ++d)
        if (sizes(columns)[d] > 1) out.push_back(d);
    if (out.empty()) out.push_back(0);
    return out;
}

/// How messages are passed for a bound.
struct Ways {
    bool forward = true;  ///< the first and the last of them
    bool first = true;    ///< there are no messages yet; must be forward
    bool kept = false;    ///< those of the last way are kept, too
};

/// Frames in which messages are passed to and fro, before the next ones are.
struct Block {
    std::size_t begin, frames;
};

/// Passes messages through blocks of frames (sequential tree-reweighted message passing, Kolmogorov
/// 2006). A column waits for those before it along each dimension.
template <class Cell>
class MessagePassing {
public:
    /// @param coarse            at half the resolution, or null
    /// @param frames_per_block  at most
    /// @param messages          for the columns of a block
    MessagePassing(const EnergyVolume& energy, Window window, const CoarseMessages* coarse,
                   std::size_t frames_per_block, Messages& messages)
        : energy_(energy),
          coarse_(coarse),
          columns_(energy),
          first_(static_cast<std::size_t>(window.first)),
          width_(static_cast<std::size_t>(window.size())),
          whole_(whole_eights(width_)),
          dimensions_(dimensions_of_lines(columns_)),
          size_(sizes(columns_)),
          frames_(std::min(size_[2], frames_per_block)),
          messages_(messages),
          fronts_{std::vector<float>(size_[1] * frames_ * whole_),
                  std::vector<float>(size_[0] * frames_ * whole_),
                  std::vector<float>(columns_.per_frame() * whole_)},
          from_block_before_(fronts_[2].size()) {}

    /// The bound, after a way through each block and `passes` more to and fro.
    /// @return what each frame adds to it
    std::vector<double> bound(int passes, const Tick& tick, const Ways& ways = {}) {
        // In a single line the first pass is exact.
        const int turns = dimensions_.size() > 1 ? 1 + 2 * passes : 1;
        std::vector<double> out;
        for (Block block{0, frames_}; block.begin < size_[2]; block.begin += frames_) {
            block.frames = std::min(frames_, size_[2] - block.begin);
            for (int n = 0; n < turns; ++n) {
                const bool last = n + 1 == turns;
                const Turn turn{block, (n % 2 == 0) == ways.forward, ways.first && n == 0,
                                !last || ways.kept};
                const auto of_frames = pass(turn, [&](double fraction) {
                    tick((static_cast<double>(block.begin) +
                          (n + fraction) / turns * static_cast<double>(block.frames)) /
                         static_cast<double>(size_[2]));
                });
                if (last) out.insert(out.end(), of_frames.begin(), of_frames.end());
            }
            std::swap(from_block_before_, fronts_[2]);
        }
        return out;
    }
    /// Passes messages to and fro in a single block of all frames.
    void to_and_fro(int passes, const Tick& tick) {
        for (int n = 0; n < 2 * passes; ++n)
            pass({{0, size_[2]}, n % 2 == 0, n == 0, true}, [&](double) { tick(0); });
    }

private:
    /// Buffers of a thread.
    struct Work {
        std::vector<float> costs, coarse;
        ColumnValues field, field_beside;
        std::size_t column_of_field = Columns::none;
        std::array<std::vector<float>, 3> ahead;
        std::array<ColumnValues, 3> parts;

        explicit Work(std::size_t width)
            : costs(whole_eights(width)),
              field(width),
              field_beside(width),
              parts{ColumnValues(width), ColumnValues(width), ColumnValues(width)} {
            for (auto& message : ahead) message.resize(whole_eights(width));
        }
    };
    /// One way through a block, in the columns' order (`forward`) or against it.
    struct Turn {
        Block block;
        bool forward, first, kept;
    };

    /// Passes messages through a block.
    /// @return what each frame of the block adds to the bound
    std::vector<double> pass(const Turn& turn, const Tick& tick) {
        const auto& block = turn.block;
        const Sizes size{size_[0], size_[1], block.frames};
        std::vector<double> bounds(columns_.per_frame() * block.frames);
        if (turn.forward) fronts_[2] = from_block_before_;
        const auto in_turn = [&](std::size_t n, std::size_t size) {
            return turn.forward ? n : size - 1 - n;
        };
        in_wavefront(
            size, box_of_columns, [&] { return Work(width_); },
            [&](const ColumnBox& box, Work& work) {
                for (auto t = box.begin[2]; t < box.end[2]; ++t)
                    for (auto k = box.begin[1]; k < box.end[1]; ++k)
                        for (auto lateral = box.begin[0]; lateral < box.end[0]; ++lateral)
                            bounds[columns_.at(lateral, k, t)] =
                                visit(turn,
                                      {in_turn(lateral, size[0]), in_turn(k, size[1]),
                                       in_turn(t, size[2])},
                                      work);
            },
            tick);
        std::vector<double> out;
        for (std::size_t n = 0; n < block.frames; ++n) {
            const auto* const of_frame =
                bounds.data() + in_turn(n, block.frames) * columns_.per_frame();
            out.push_back(std::accumulate(of_frame, of_frame + columns_.per_frame(), 0.0));
        }
        return out;
    }

    /// Takes the messages to a column, divides its costs, and sends messages to the columns that
    /// come next.
    /// @param at  lateral, slice, and the frame in the block
    /// @return what the column adds to the bound
    double visit(const Turn& turn, const Sizes& at, Work& work) {
        const auto in_block = columns_.at(at[0], at[1], at[2]),
                   column = in_block + turn.block.begin * columns_.per_frame();
        const std::array<std::size_t, 3> front_at{
            at[1] + size_[1] * at[2], at[0] + size_[0] * at[2], at[0] + size_[0] * at[1]};
        const Sizes size{size_[0], size_[1], turn.block.frames};
        double out = read_costs(column, {work.costs.data(), width_});
        std::array<ColumnLine, 3> through;
        const auto lines = std::span(through).first(dimensions_.size());
        for (std::size_t n = 0; n < lines.size(); ++n) {
            const auto d = dimensions_[n];
            const std::span<float> front(fronts_[d].data() + front_at[d] * whole_, whole_),
                ahead(work.ahead[d]);
            const bool begins = at[d] == (turn.forward ? 0 : size[d] - 1),
                       ends = at[d] == (turn.forward ? size[d] - 1 : 0);
            if (begins && !turn.forward)
                from_behind(d, {at[0], at[1], at[2] + turn.block.begin}, front, work);
            else if (begins && d != time) std::ranges::fill(front, 0.0f);
            bool read = false;
            if (ends && d == time && !turn.forward)
                std::copy_n(from_block_before_.data() + front_at[d] * whole_, whole_, ahead.data());
            else if (turn.first || (ends && turn.forward))
                from_behind(d, {at[0], at[1], at[2] + turn.block.begin}, ahead, work);
            else if (ends) std::ranges::fill(ahead, 0.0f);
            else read = true;
            lines[n] = {front.data(), ahead.data(), messages_.message(d, in_block),
                        read,         turn.kept,    work.parts[d].data()};
        }
        divide_column(lines, work.costs.data(), width_,
                      (1 - rounding) / static_cast<float>(dimensions_.size()));
        if (energy_.has_field() && work.column_of_field != column) {
            read_field(column, work.field);
            work.column_of_field = column;
        }
        for (auto n = lines.size(); n-- > 0;) {
            const auto d = dimensions_[n];
            out += static_cast<double>(lines[n].least);
            const auto place = d == time ? at[2] + turn.block.begin : at[d];
            if (place != (turn.forward ? size_[d] - 1 : 0))
                send(turn.forward, d, column, lines[n], work);
        }
        return out;
    }

    /// The message from behind a column before any has been passed: a guess, or 0.
    void from_behind(std::size_t dimension, const Sizes& at, std::span<float> message,
                     Work& work) const {
        if (coarse_ != nullptr && coarse_->has(dimension) && at[dimension] + 1 < size_[dimension])
            coarse_->get(dimension, at, message.first(width_), work.coarse);
        else std::ranges::fill(message, 0.0f);
    }

    /// Reads a column's costs. If some are below 0, they count from the lowest.
    /// @return that lowest cost, or 0
    double read_costs(std::size_t column, std::span<float> out) const {
        const auto* const cells = energy_.cells<Cell>(column / columns_.per_frame()) +
                                  column % columns_.per_frame() * energy_.stride() + first_;
        if constexpr (std::is_same_v<Cell, std::uint16_t>) {
            if (!energy_.protects() && !energy_.attracts()) {
                decode_energies({cells, width_}, out);
                return 0;
            }
        }
        const auto cost = energy_.costs();
        for (std::size_t i = 0; i < width_; ++i) out[i] = cost(cells[i]);
        const float low = std::min(std::ranges::min(out), 0.0f);
        if (low < 0)
            for (auto& value : out) value -= low;
        return static_cast<double>(low) * (1 + static_cast<double>(rounding));
    }
    void read_field(std::size_t column, ColumnValues& out) const {
        energy_.field(column).read(static_cast<int>(first_), {out.data(), width_});
    }

    /// Sends a line's message to its next column, whose place in the front it takes.
    void send(bool forward, std::size_t dimension, std::size_t column, const ColumnLine& line,
              Work& work) const {
        const auto price = energy_.steps().price(dimension == time);
        if (!energy_.has_field())
            return send_to_column(line.part, nullptr, nullptr, price, line.least, width_,
                                  line.front);
        const auto step = std::array{std::size_t{1}, size_[0], columns_.per_frame()}[dimension];
        const auto next = forward ? column + step : column - step;
        read_field(next, work.field_beside);
        send_to_column(line.part, work.field.data(), work.field_beside.data(), price, line.least,
                       width_, line.front);
        // The next column of a row is visited next.
        if (dimension != 0) return;
        std::swap(work.field, work.field_beside);
        work.column_of_field = next;
    }

    const EnergyVolume& energy_;
    const CoarseMessages* const coarse_;
    const Columns columns_;
    const std::size_t first_, width_, whole_;
    const std::vector<std::size_t> dimensions_;
    const Sizes size_;
    const std::size_t frames_;  ///< in a block
    Messages& messages_;
    /// For each dimension, the messages to the columns that come next.
    std::array<std::vector<float>, 3> fronts_;
    std::vector<float> from_block_before_;  ///< messages to the block's first frame
};

/// Passes messages in an energy whose cells are of either kind.
/// @param call  given the MessagePassing
template <class Call>
auto with_passing(const EnergyVolume& energy, Window window, const CoarseMessages* coarse,
                  std::size_t frames_per_block, Messages& messages, const Call& call) {
    if (energy.summed())
        return call(MessagePassing<float>(energy, window, coarse, frames_per_block, messages));
    return call(MessagePassing<std::uint16_t>(energy, window, coarse, frames_per_block, messages));
}

/// For messages at the full resolution, and as much for those at half of it.
Limits half_of(const Limits& limits) { return {limits.memory / 2, limits.folder}; }

Messages room_for_messages(const EnergyVolume& energy, Window window, std::size_t frames,
                           const Limits& limits) {
    return {dimensions_of_lines(Columns(energy)), energy.columns_per_frame() * frames,
            static_cast<std::size_t>(window.size()), limits};
}

/// Messages for an energy at half its resolution, which begin with those at a quarter, and so on.
/// None for a single line, which needs none.
std::optional<CoarseMessages> messages_at_half(const EnergyVolume& energy, Window window,
                                               int passes, const Tick& tick, const Limits& limits) {
    if (dimensions_of_lines(Columns(energy)).size() == 1) return std::nullopt;
    tick(0);
    const auto half = restrict_energy(energy, window, std::numeric_limits<float>::infinity());
    const Window all{0, half.width() - 1};
    const auto coarse =
        messages_at_half(half, all, std::min(times_more * passes, most_passes), tick, limits);
    auto messages = room_for_messages(half, all, half.frames(), limits);
    with_passing(half, all, coarse ? &*coarse : nullptr, half.frames(), messages,
                 [&](auto&& passing) { passing.to_and_fro(passes, tick); });
    return CoarseMessages(Columns(half), static_cast<std::size_t>(half.width()), half.protects(),
                          std::move(messages));
}

/// The bound of which each frame has a part. The guess may mislead: unless vertices are attracted,
/// costs are not negative.
double sum_of(std::span<const double> parts, const EnergyVolume& energy) {
    const double sum = std::accumulate(parts.begin(), parts.end(), 0.0);
    return energy.attracts() ? sum : std::max(sum, 0.0);
}

}  // namespace

double lower_bound(const EnergyVolume& energy, Window window, int passes, const Tick& tick,
                   const Limits& limits) {
    const auto half = half_of(limits);
    const auto coarse = messages_at_half(energy, window, passes_at_half, tick, half);
    const auto frame = energy.columns_per_frame() * static_cast<std::size_t>(window.size());
    const auto block = std::min(
        energy.frames(), std::clamp(entries_per_block / frame, std::size_t{2}, frames_per_block));
    auto messages = room_for_messages(energy, window, block, half);
    const auto find = [&](auto&& passing) { return passing.bound(passes, tick); };
    return sum_of(with_passing(energy, window, coarse ? &*coarse : nullptr, block, messages, find),
                  energy);
}

struct ConsecutiveBounds::Kept {
    Messages messages;
    int first_entry;             ///< of the window
    int first_seam;              ///< number of the first seam that shares these messages
    std::size_t per_frame;       ///< columns
    bool forward = true;         ///< the way that comes next
    std::vector<double> from{};  ///< what the frames from each one on add to the last bound
};

ConsecutiveBounds::ConsecutiveBounds(Limits limits) : limits_(std::move(limits)) {}

ConsecutiveBounds::~ConsecutiveBounds() = default;

double ConsecutiveBounds::operator()(const EnergyVolume& energy, Window window, int number,
                                     int passes, const Tick& tick) {
    std::optional<CoarseMessages> coarse;
    const bool first = !kept_ || kept_->first_seam != first_with(number);
    if (first) {
        kept_.reset();
        const auto half = half_of(limits_);
        coarse = messages_at_half(energy, window, passes_at_half, tick, half);
        kept_ = std::make_unique<Kept>(
            Kept{room_for_messages(energy, window, energy.frames(), half), window.first,
                 first_with(number), energy.columns_per_frame()});
    }
    const Ways ways{kept_->forward, first, true};
    kept_->forward = !kept_->forward;
    const auto find = [&](auto&& passing) { return passing.bound(passes, tick, ways); };
    const auto parts = with_passing(energy, window, coarse ? &*coarse : nullptr, energy.frames(),
                                    kept_->messages, find);
    kept_->from.assign(parts.size() + 1, 0);
    for (auto t = parts.size(); t-- > 0;) kept_->from[t] = kept_->from[t + 1] + parts[t];
    return sum_of(parts, energy);
}

double ConsecutiveBounds::with(const SeamStart& start) const {
    double paid = 0;
    if (kept_->messages.has(time))
        for (std::size_t c = 0; c < kept_->per_frame; ++c) {
            const auto entry =
                static_cast<std::size_t>(start.entries[c * start.stride] - kept_->first_entry);
            paid += static_cast<double>(
                kept_->messages.entry(time, start.frame * kept_->per_frame + c, entry));
        }
    // The last messages went against the order of the frames if the next ones will go in it. Then
    // they hold what later frames cost beyond their parts of the bound. Else they hold what
    // earlier frames cost, which the parts of the other frames contain.
    if (kept_->forward) return start.with_frame + kept_->from[start.frame + 1] + paid;
    return start.before + kept_->from[start.frame] - paid * (1 + largest_cut);
}

void ConsecutiveBounds::follow(std::span<const std::uint16_t> at, int number) {
    if (kept_ && kept_->first_seam == first_with(number + 1))
        kept_->messages.remove(at, static_cast<std::size_t>(kept_->first_entry));
}

}  // namespace fluidcarve
