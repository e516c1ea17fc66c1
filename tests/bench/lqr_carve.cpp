#include "tests/bench/lqr_carve.h"

#include <lqr.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

Samples carve_by_lqr(const Samples& image, std::size_t width) {
    const auto [columns, rows, planes] = image.shape;
    if (image.frames != 1 || planes != 1)
        throw std::runtime_error("liblqr carves one image at a time");
    auto* const values =
        static_cast<float*>(g_malloc(image.values.size() * sizeof(float)));  // the carver frees it
    std::ranges::copy(image.values, values);
    const std::unique_ptr<LqrCarver, decltype(&lqr_carver_destroy)> carver(
        lqr_carver_new_ext(values, static_cast<int>(columns), static_cast<int>(rows), 1,
                           LQR_COLDEPTH_32F),
        &lqr_carver_destroy);
    if (!carver || lqr_carver_init(carver.get(), 1, 0) != LQR_OK ||
        lqr_carver_resize(carver.get(), static_cast<int>(width), static_cast<int>(rows)) != LQR_OK)
        throw std::runtime_error("liblqr has failed");
    Samples out(1, {width, rows, 1}, image.closed, image.around);
    int row = 0;
    void* line = nullptr;
    while (lqr_carver_scan_line_ext(carver.get(), &row, &line))
        std::copy_n(static_cast<const float*>(line), width, out.row(static_cast<std::size_t>(row)));
    return out;
}
