#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

/// A curve of values at x = 1, 2, 3, ... A value that is not finite leaves a gap.
struct PlotCurve {
    std::string style;           ///< CSS class
    std::vector<double> values;  ///< y at x = 1, 2, ...
};

/// A line plot for a page. The page's style sheet sets the colours of the CSS classes `axis`,
/// `grid`, `band` and those of the curves.
struct LinePlot {
    std::string title;    ///< includes the unit of y
    std::string x_label;  ///< what x counts
    std::vector<PlotCurve> curves;
    bool from_zero = false;          ///< whether the y axis includes 0
    bool band = false;               ///< whether to fill the area between the first two curves
    std::vector<std::string> notes;  ///< tooltips of the first curve's points, or empty
};

/// The plot as SVG that scales with the width of the page.
std::string to_svg(const LinePlot& plot);

}  // namespace fluidcarve
