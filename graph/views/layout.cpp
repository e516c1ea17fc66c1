#include "graph/views/layout.h"

#include "carve/base/words.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace fluidcarve {
namespace {

constexpr double column_gap = 56;
constexpr double row_gap = 18;
constexpr double line_height = 4;  // height of an edge where it passes a column
constexpr double port_gap = 7;
constexpr int sweeps = 16;

/// An entry of a column: a box, or an edge that passes through the column.
struct Item {
    std::size_t column = 0;
    double height = line_height;
    double middle = 0;
    std::vector<std::size_t> before;  ///< neighbours in the previous column
    std::vector<std::size_t> after;
};

/// Computes a Layout, step by step.
class Placement {
public:
    explicit Placement(Layout& layout) : layout_(layout) {}

    void run() {
        make_columns();
        order();
        set_heights();
        write_back();
    }

private:
    void make_columns() {
        const auto count = layout_.boxes.size();
        items_.resize(count);
        for (std::size_t n = 0; n < count; ++n) items_[n].height = layout_.boxes[n].height;
        auto by_source = layout_.edges;
        std::ranges::sort(by_source, [](const auto& a, const auto& b) { return a.from < b.from; });
        for (const auto& edge : by_source)
            items_[edge.to].column = std::max(items_[edge.to].column, items_[edge.from].column + 1);
        pull_sources();
        for (const auto& edge : layout_.edges) {
            std::vector<std::size_t> passage{edge.from};
            for (auto column = items_[edge.from].column + 1; column < items_[edge.to].column;
                 ++column) {
                passage.push_back(items_.size());
                items_.emplace_back().column = column;
            }
            passage.push_back(edge.to);
            for (std::size_t n = 1; n < passage.size(); ++n) {
                items_[passage[n - 1]].after.push_back(passage[n]);
                items_[passage[n]].before.push_back(passage[n - 1]);
            }
            passages_.push_back(std::move(passage));
        }
        for (std::size_t n = 0; n < items_.size(); ++n) {
            columns_.resize(std::max(columns_.size(), items_[n].column + 1));
            columns_[items_[n].column].push_back(n);
        }
    }

    /// Moves each box without inputs to the column before its first reader.
    void pull_sources() {
        constexpr auto none = ~std::size_t{0};
        std::vector<std::size_t> nearest(items_.size(), none);
        std::vector<bool> has_input(items_.size(), false);
        for (const auto& edge : layout_.edges) {
            nearest[edge.from] = std::min(nearest[edge.from], items_[edge.to].column - 1);
            has_input[edge.to] = true;
        }
        for (std::size_t n = 0; n < items_.size(); ++n)
            if (!has_input[n] && nearest[n] != none) items_[n].column = nearest[n];
    }

    std::vector<std::size_t> ranks() const {
        std::vector<std::size_t> out(items_.size());
        for (const auto& column : columns_)
            for (std::size_t n = 0; n < column.size(); ++n) out[column[n]] = n;
        return out;
    }

    std::size_t crossings() const {
        const auto rank = ranks();
        std::size_t out = 0;
        for (const auto& column : columns_) {
            std::vector<std::pair<std::size_t, std::size_t>> lines;
            for (const auto n : column)
                for (const auto next : items_[n].after) lines.emplace_back(rank[n], rank[next]);
            for (std::size_t a = 0; a < lines.size(); ++a)
                for (std::size_t b = 0; b < a; ++b)
                    out += (lines[a].first < lines[b].first && lines[a].second > lines[b].second) ||
                           (lines[a].first > lines[b].first && lines[a].second < lines[b].second);
        }
        return out;
    }

    void order() {
        auto best = columns_;
        auto fewest = crossings();
        for (int sweep = 0; sweep < sweeps && fewest > 0; ++sweep) {
            const bool rightwards = sweep % 2 == 0;
            for (std::size_t n = 0; n < columns_.size(); ++n) {
                auto& column = columns_[rightwards ? n : columns_.size() - 1 - n];
                const auto rank = ranks();
                const auto key = [&](std::size_t item) {
                    const auto& neighbours = rightwards ? items_[item].before : items_[item].after;
                    if (neighbours.empty()) return static_cast<double>(rank[item]);
                    double sum = 0;
                    for (const auto each : neighbours) sum += static_cast<double>(rank[each]);
                    return sum / static_cast<double>(neighbours.size());
                };
                std::ranges::stable_sort(column, [&](auto a, auto b) { return key(a) < key(b); });
            }
            if (const auto now = crossings(); now < fewest) {
                fewest = now;
                best = columns_;
            }
        }
        columns_ = std::move(best);
    }

    /// Moves the items of a column towards the mean height of their neighbours, by least squares.
    /// Order and minimum gaps are kept (pool adjacent violators).
    void level(const std::vector<std::size_t>& column, bool use_before, bool use_after) {
        struct Block {
            double sum;
            double weight;
            std::size_t size;
            double mean() const { return sum / weight; }
        };
        std::vector<Block> blocks;
        std::vector<double> offset(column.size(), 0);
        for (std::size_t n = 0; n < column.size(); ++n) {
            const auto& item = items_[column[n]];
            if (n > 0)
                offset[n] =
                    offset[n - 1] + (items_[column[n - 1]].height + item.height) / 2 + row_gap;
            double sum = 0;
            double weight = 0;
            const auto add = [&](const auto& side) {
                for (const auto each : side) sum += items_[each].middle, weight += 1;
            };
            if (use_before) add(item.before);
            if (use_after) add(item.after);
            // An item without neighbours is weakly tied to its present height.
            if (weight == 0) weight = 0.1, sum = item.middle * weight;
            blocks.push_back({sum - offset[n] * weight, weight, 1});
            while (blocks.size() > 1 && blocks[blocks.size() - 2].mean() >= blocks.back().mean()) {
                const auto last = blocks.back();
                blocks.pop_back();
                blocks.back().sum += last.sum;
                blocks.back().weight += last.weight;
                blocks.back().size += last.size;
            }
        }
        std::size_t n = 0;
        for (const auto& block : blocks)
            for (std::size_t k = 0; k < block.size; ++k, ++n)
                items_[column[n]].middle = block.mean() + offset[n];
    }

    void set_heights() {
        for (const auto& column : columns_) {
            double total = -row_gap;
            for (const auto n : column) total += items_[n].height + row_gap;
            double top = -total / 2;
            for (const auto n : column) {
                items_[n].middle = top + items_[n].height / 2;
                top += items_[n].height + row_gap;
            }
        }
        for (int sweep = 0; sweep < sweeps; ++sweep) {
            for (std::size_t n = 0; n < columns_.size(); ++n)
                level(columns_[n], true, sweep + 2 > sweeps);
            for (std::size_t n = columns_.size(); n-- > 0;)
                level(columns_[n], sweep + 2 > sweeps, true);
        }
    }

    void write_back() {
        std::vector<double> left(columns_.size(), 0);
        std::vector<double> right(columns_.size(), 0);
        double top = items_.empty() ? 0 : std::numeric_limits<double>::max();
        double bottom = items_.empty() ? 0 : std::numeric_limits<double>::lowest();
        for (std::size_t column = 0; column < columns_.size(); ++column) {
            double widest = 0;
            for (const auto n : columns_[column])
                if (n < layout_.boxes.size()) widest = std::max(widest, layout_.boxes[n].width);
            left[column] = column == 0 ? 0 : right[column - 1] + column_gap;
            right[column] = left[column] + widest;
            for (const auto n : columns_[column]) {
                top = std::min(top, items_[n].middle - items_[n].height / 2);
                bottom = std::max(bottom, items_[n].middle + items_[n].height / 2);
            }
        }
        layout_.width = right.empty() ? 0 : right.back();
        layout_.height = bottom - top;
        for (std::size_t n = 0; n < layout_.boxes.size(); ++n) {
            auto& box = layout_.boxes[n];
            const auto column = items_[n].column;
            box.x = left[column];
            box.width = right[column] - left[column];
            box.y = items_[n].middle - box.height / 2 - top;
        }
        for (std::size_t e = 0; e < passages_.size(); ++e) {
            const auto& passage = passages_[e];
            auto& route = layout_.edges[e].route;
            for (std::size_t n = 1; n < passage.size(); ++n) {
                const auto& from = items_[passage[n - 1]];
                const auto& to = items_[passage[n]];
                const double spread = n + 1 == passage.size() ? port(e) : 0;
                route.push_back({right[from.column], from.middle - top});
                route.push_back({left[to.column], to.middle - top + spread});
            }
        }
    }

    /// Vertical offset of an edge's end from the middle of its box: edges into the same box end a
    /// little apart, in the order of their heights.
    double port(std::size_t edge) const {
        const auto key = [&](std::size_t e) {
            return std::pair(items_[passages_[e][passages_[e].size() - 2]].middle, e);
        };
        double rank = 0;
        double count = 0;
        for (std::size_t e = 0; e < passages_.size(); ++e) {
            if (layout_.edges[e].to != layout_.edges[edge].to) continue;
            count += 1;
            rank += key(e) < key(edge) ? 1 : 0;
        }
        const double gap = std::min(port_gap, (layout_.boxes[layout_.edges[edge].to].height - 12) /
                                                  std::max(count - 1, 1.0));
        return (rank - (count - 1) / 2) * gap;
    }

    Layout& layout_;
    std::vector<Item> items_;  ///< first the boxes, in their order, then the passages of edges
    std::vector<std::vector<std::size_t>> columns_;  ///< items, top to bottom
    /// Per edge: the items on its way, both ends included.
    std::vector<std::vector<std::size_t>> passages_;
};

}  // namespace

void Layout::place() { Placement(*this).run(); }

}  // namespace fluidcarve
