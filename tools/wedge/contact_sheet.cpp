#include "tools/wedge/contact_sheet.h"

#include "nodes/preview/canvas.h"
#include "nodes/preview/sheet_style.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fluidcarve {
namespace {

using namespace sheet_style;

constexpr double sheet_header = 56;
constexpr double gap_of_cells = 24;  // neighbouring cells
constexpr double label_height = 19;
constexpr double result_height = 16;
constexpr double beside_picture = 8;         // above and below it
constexpr double widest = 640;               // of a picture
constexpr double empty_height = 120;         // of a cell without a picture
constexpr double most_sheet_pixels = 30000;  // of the sheet, to each side

/// The cells in rows.
class ContactSheet {
public:
    ContactSheet(std::string title, const std::vector<ContactCell>& cells, std::size_t columns)
        : title_(std::move(title)),
          cells_(cells),
          columns_(std::min(columns, std::max<std::size_t>(cells.size(), 1))) {
        for (const auto& cell : cells)
            pictures_.push_back(cell.png.empty() ? Picture{} : read_png(cell.png));
        double most = 320;
        for (const auto& picture : pictures_)
            most = std::max(most, static_cast<double>(picture.width));
        width_ =
            std::min({most, widest,
                      (most_sheet_pixels - margin) / static_cast<double>(columns_) - gap_of_cells});
        if (const auto all = height(); all > most_sheet_pixels)
            width_ = std::max(width_ * most_sheet_pixels / all, 16.0);
    }

    void write(const std::string& path) {
        const auto across = margin + static_cast<double>(columns_) * (width_ + gap_of_cells);
        Canvas canvas(static_cast<int>(std::ceil(std::max(across, 400.0))),
                      static_cast<int>(std::ceil(height())), paper);
        canvas.text(margin, 36, canvas.fitting(title_, title, canvas.width() - 2 * margin), title);
        double y = sheet_header;
        for (std::size_t row = 0; row < rows(); ++row) {
            for (auto n = row * columns_; n < std::min((row + 1) * columns_, cells_.size()); ++n)
                draw(canvas, n,
                     margin + static_cast<double>(n - row * columns_) * (width_ + gap_of_cells), y,
                     row);
            y += row_height(row);
        }
        canvas.write_png(path);
    }

private:
    std::size_t rows() const { return (cells_.size() + columns_ - 1) / columns_; }

    double picture_height(std::size_t n) const {
        return pictures_[n].width == 0
                   ? empty_height
                   : std::max(1.0, std::round(width_ * pictures_[n].height / pictures_[n].width));
    }

    /// The greatest of what `measure` says of a row's cells.
    template <class Measure>
    double most_in(std::size_t row, const Measure& measure) const {
        double out = 0;
        for (auto n = row * columns_; n < std::min((row + 1) * columns_, cells_.size()); ++n)
            out = std::max(out, measure(n));
        return out;
    }
    double labels_height(std::size_t row) const {
        return most_in(row, [&](std::size_t n) {
            return label_height * static_cast<double>(cells_[n].labels.size());
        });
    }
    double row_height(std::size_t row) const {
        const auto results = most_in(row, [&](std::size_t n) {
            return result_height * static_cast<double>(cells_[n].results.size());
        });
        return labels_height(row) + most_in(row, [&](std::size_t n) { return picture_height(n); }) +
               results + 2 * beside_picture + gap_of_cells;
    }
    double height() const {
        double out = sheet_header + margin;
        for (std::size_t row = 0; row < rows(); ++row) out += row_height(row);
        return out;
    }

    void draw(Canvas& canvas, std::size_t n, double x, double y, std::size_t row) const {
        const auto lines = [&](const std::vector<std::string>& texts, const Canvas::TextStyle& type,
                               double from, double step) {
            for (const auto& text : texts)
                canvas.text(x, from += step, canvas.fitting(text, type, width_), type);
        };
        lines(cells_[n].labels, heading, y - 5, label_height);
        y += labels_height(row) + beside_picture;
        const Canvas::Rect place{x, y, std::round(width_), picture_height(n)};
        if (pictures_[n].width > 0) canvas.picture(place, pictures_[n], Canvas::Enlarge::smoothly);
        else canvas.outline(place, dim, true);
        lines(cells_[n].results, plain, place.y + place.height + beside_picture - 4, result_height);
    }

    std::string title_;
    const std::vector<ContactCell>& cells_;
    std::size_t columns_;
    std::vector<Picture> pictures_;  ///< one per cell; of no width: none
    double width_ = widest;          ///< of a picture
};

}  // namespace

void write_contact_sheet(const std::string& title, const std::vector<ContactCell>& cells,
                         std::size_t columns, const std::string& path) {
    ContactSheet(title, cells, columns).write(path);
}

}  // namespace fluidcarve
