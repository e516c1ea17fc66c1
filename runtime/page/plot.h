#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

/// Values over the whole numbers from 1; one that is not finite leaves a gap.
struct PlotCurve {
    std::string style;  ///< a class of the page's style sheet
    std::vector<double> values;
};

/// A line plot for a page, which gives its classes colours: `axis`, `grid`, `band`, and those of the curves.
struct LinePlot {
    std::string title;    ///< with the unit
    std::string x_label;  ///< what is counted
    std::vector<PlotCurve> curves;
    bool from_zero = false;          ///< the axis begins there
    bool band = false;               ///< fills what lies between the first two curves
    std::vector<std::string> notes;  ///< tooltips of the first curve's points, or none
};

/// As SVG, which scales with the page's width.
std::string to_svg(const LinePlot& plot);

}  // namespace fluidcarve
