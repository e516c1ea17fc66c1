#pragma once

#include <string>
#include <vector>

/// Which ratios are better than others.
enum class Better { higher, lower };

/// A line of ./dev bench.
struct Figure {
    std::string what;  ///< what is measured, as ratio of two things
    double ratio = 0;
    Better better = Better::higher;
    std::string rest;  ///< what the ratio is made of
    std::string date;  ///< day of the measurement, 2026-01-31
};

/// The table of a page of kept figures; none if there is no such page.
std::vector<Figure> read_kept(const std::string& path);

/// Writes the page. Figures of `now` replace those of the same name in `kept`; the others stay.
void write_kept(const std::string& path, const std::vector<Figure>& kept,
                const std::vector<Figure>& now);

/// A line for each figure that is worse than the kept one of the same name by more than a tenth.
std::vector<std::string> worse_than_kept(const std::vector<Figure>& kept,
                                         const std::vector<Figure>& now);
