#include "nodes/solving/reported_seams.h"

#include "nodes/solving/report.h"

#include <memory>

namespace fluidcarve {

ReportedSeams ReportedSeams::first(std::size_t count) const {
    const auto out = std::make_shared<Seams>(*seams);
    for (auto* const list : {&out->seams, &out->pairs})
        if (list->size() > count)
            list->erase(list->begin() + static_cast<std::ptrdiff_t>(count), list->end());
    auto cut = report;
    cut_report(cut, count);
    if (count == 0) {
        out->kind = Seams::Kind::remove;
        cut = empty_report(*out);
    }
    return {out, std::move(cut)};
}

}  // namespace fluidcarve
