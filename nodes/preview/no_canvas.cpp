// In place of canvas.cpp in a build without Cairo. Every picture is refused, so that no page is
// ever drawn on.

#include "carve/base/failure.h"
#include "nodes/preview/canvas.h"

namespace fluidcarve {

struct Canvas::Page {};

std::string drawing_fault() {
    return "needs Cairo, which this build lacks; install libcairo2-dev, then configure and build "
           "again";
}

Picture read_png(const std::string&) { throw Failure(drawing_fault()); }

Canvas::Canvas(int, int, Colour) { throw Failure(drawing_fault()); }
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas::~Canvas() = default;
int Canvas::width() const { return 0; }
int Canvas::height() const { return 0; }
Colour Canvas::at(int, int) const { return {}; }
void Canvas::fill(const Rect&, Colour) {}
void Canvas::outline(const Rect&, Colour, bool) {}
void Canvas::lines(const Rect&, const std::vector<Line>&, double, Colour) {}
void Canvas::picture(const Rect&, const Picture&, Enlarge) {}
void Canvas::text(double, double, const std::string&, const TextStyle&, Align) {}
double Canvas::text_width(const std::string&, const TextStyle&) { return 0; }
void Canvas::write_png(const std::string&, const Provenance&) const {}

}  // namespace fluidcarve
