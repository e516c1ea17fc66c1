#include "tests/bench/kept.h"

#include <fmt/format.h>

#include <sys/sysinfo.h>
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <thread>

namespace {

/// The cells of a row of a table, without the blanks around them.
std::vector<std::string> cells_of(const std::string& row) {
    std::vector<std::string> out;
    for (std::size_t begin = row.find('|'); begin != std::string::npos;) {
        const auto end = row.find('|', begin + 1);
        if (end == std::string::npos) break;
        const auto first = row.find_first_not_of(' ', begin + 1),
                   last = row.find_last_not_of(' ', end - 1);
        out.push_back(first < end ? row.substr(first, last - first + 1) : "");
        begin = end;
    }
    return out;
}

const char* name_of(Better better) { return better == Better::higher ? "higher" : "lower"; }

std::string machine() {
    std::string model = "an unknown processor";
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("model name")) {
            model = line.substr(line.find(": ") + 2);
            break;
        }
    struct sysinfo info {};
    sysinfo(&info);
    return fmt::format(
        "{}, {} threads, {:.0f} GB", model, std::thread::hardware_concurrency(),
        static_cast<double>(info.totalram) * static_cast<double>(info.mem_unit) / 1e9);
}

}  // namespace

std::vector<Figure> read_kept(const std::string& path) {
    std::vector<Figure> out;
    std::ifstream in(path);
    for (std::string line; std::getline(in, line);) {
        const auto cells = cells_of(line);
        if (cells.size() != 5 || (cells[2] != "higher" && cells[2] != "lower")) continue;
        out.push_back({cells[0], std::strtod(cells[1].c_str(), nullptr),
                       cells[2] == "higher" ? Better::higher : Better::lower, cells[3], cells[4]});
    }
    return out;
}

void write_kept(const std::string& path, const std::vector<Figure>& kept,
                const std::vector<Figure>& now) {
    auto all = kept;
    for (const auto& figure : now)
        if (const auto old = std::ranges::find(all, figure.what, &Figure::what); old != all.end())
            *old = figure;
        else all.push_back(figure);
    std::ofstream out(path);
    out << "# Speed, beside named rivals\n\n"
           "Each line is a ratio of two times, or of two other figures, of one run: machines "
           "differ, ratios less so. `./dev bench` measures,\n"
           "says what became worse by more than a tenth, and keeps the figures here with "
           "`--keep`.\n\n"
        << fmt::format("Machine of the last run: {}.\n\n", machine())
        << "| what | ratio | better | made of | date |\n|---|--:|---|---|---|\n";
    for (const auto& figure : all)
        out << fmt::format("| {} | {:.2f} | {} | {} | {} |\n", figure.what, figure.ratio,
                           name_of(figure.better), figure.rest, figure.date);
}

std::vector<std::string> worse_than_kept(const std::vector<Figure>& kept,
                                         const std::vector<Figure>& now) {
    std::vector<std::string> out;
    for (const auto& figure : now) {
        const auto old = std::ranges::find(kept, figure.what, &Figure::what);
        if (old == kept.end()) continue;
        const double change =
            figure.better == Better::higher ? old->ratio / figure.ratio : figure.ratio / old->ratio;
        if (change > 1.1)
            out.push_back(fmt::format("{}: {:.2f}, but {:.2f} on {} ({} is better)", figure.what,
                                      figure.ratio, old->ratio, old->date, name_of(figure.better)));
    }
    return out;
}
