#include "formats/seam_file/warp_amount_file.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "formats/geometry_file/file_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace fluidcarve {

namespace {

using Words = std::vector<std::string_view>;

constexpr std::uint64_t most_amount_bytes = std::uint64_t{64} << 20;
constexpr auto form =
    "the first line names the columns, 'amount' and 'w', 'time' or both, as in 'w, amount'";

/// Reads the lines behind the first one.
class AmountLines {
public:
    /// @param heads  the words of the first line
    AmountLines(const FileText& file, const Words& heads)
        : file_(file),
          count_(heads.size()),
          w_(column(heads, "w")),
          time_(column(heads, "time")),
          amount_(column(heads, "amount")) {
        if (!amount_) file.fault(fmt::format("there is no column 'amount': {}", form));
        if (!w_ && !time_) file.fault(fmt::format("there is no column 'w' or 'time': {}", form));
        out_.along = w_ ? WarpAmount::Along::w : WarpAmount::Along::time;
    }

    void add(const Words& words) {
        if (words.size() != count_)
            file_.fault(fmt::format("a line needs {}, as the first one has, but this one has {}",
                                    counted(count_, "column"), words.size()));
        const auto amount = amount_in(words[*amount_]);
        if (!w_) return add({file_.number(words[*time_]), amount}, out_.points);
        const double w = file_.number(words[*w_]);
        if (w < 0 || w > 1)
            file_.fault(fmt::format(
                "{} is no place along w, which goes from 0, the first plane, to 1, the last one",
                w));
        if (!time_) return add({w, amount}, out_.points);
        const double frame = file_.number(words[*time_]);
        auto& sections = out_.sections;
        if (!sections.empty() && frame < sections.back().at)
            file_.fault(fmt::format("frame {} stands behind {}: frames must rise", frame,
                                    sections.back().at));
        if (sections.empty() || frame >= sections.back().at + WarpAmount::least_step)
            sections.push_back({frame, {}});
        add({w, amount}, sections.back().points);
    }

    /// @throws Failure if there was no line
    WarpAmount take() {
        if (!out_.varies())
            file_.fault_in_all("there are no points in it: a curve needs at least one");
        return std::move(out_);
    }

private:
    static std::optional<std::size_t> column(const Words& heads, std::string_view name) {
        const auto found = std::ranges::find(heads, name);
        return found == heads.end()
                   ? std::nullopt
                   : std::optional(static_cast<std::size_t>(found - heads.begin()));
    }
    Count amount_in(std::string_view word) const {
        const bool percent = word.ends_with('%');
        if (percent) word.remove_suffix(1);
        return {file_.number(word), percent};
    }
    void add(const WarpAmount::Point& point, std::vector<WarpAmount::Point>& to) const {
        if (!to.empty() && point.at < to.back().at + WarpAmount::least_step)
            file_.fault(fmt::format("this point, at {}, stands behind one at {}: points must rise",
                                    point.at, to.back().at));
        to.push_back(point);
    }

    const FileText& file_;
    std::size_t count_;                             ///< of columns
    std::optional<std::size_t> w_, time_, amount_;  ///< columns
    WarpAmount out_;
};

}  // namespace

WarpAmount read_amounts(const std::string& path) {
    if (const auto ending = ending_of(path); ending != ".csv")
        throw Failure(fmt::format("{}: amounts are read from .csv, not from '{}'", path, ending),
                      Failure::Kind::input);
    FileText file(InputFile(path, {.what = "amounts", .most = most_amount_bytes}));
    std::optional<AmountLines> lines;
    for (auto cells = file.next_cells(); !cells.empty(); cells = file.next_cells())
        if (lines) lines->add(cells);
        else lines.emplace(file, cells);
    if (!lines) file.fault_in_all(fmt::format("there is nothing in it: {}", form));
    return lines->take();
}

}  // namespace fluidcarve
