#include "carve/solver/task/part_finder.h"

#include "carve/base/failure.h"
#include "carve/solver/task/no_more.h"

#include <utility>

namespace fluidcarve {

namespace {

std::uint64_t bytes_of_seams(const SeamTask& task, const CarvedSpace& space) {
    return static_cast<std::uint64_t>(task.count) * (task.pairs ? 2 : 1) *
           columns_of(task, space).count() * sizeof(std::uint16_t);
}

}  // namespace

PartFinder::PartFinder(EnergyVolume& energy, const SeamTask& task, const CarvedSpace& space,
                       const FindSeam& find, Limits limits)
    : energy_(energy),
      task_(task),
      space_(space),
      find_(find),
      limits_(std::move(limits)),
      taken_(energy.bytes() + bytes_of_seams(task, space)),
      fits_(taken_ <= limits_.memory) {}

FoundSeams PartFinder::operator()(const SeamPart& part, int count, const Tick& tick,
                                  SearchOptions search) const {
    if (!fits_)
        search.keep = [&](const SeamEntries& entries) {
            return SeamEntries::in_file(entries, limits_.folder);
        };
    search.limits = {memory(), limits_.folder};
    if (task_.finest > 1) search.full = FullSize{columns_of(task_, space_), task_.size};
    try {
        return find_seams(energy_, part, count, find_, tick, search);
    } catch (const NoSeam& none) {
        throw Failure(why_no_more(none, task_, part, space_));
    }
}

FoundParts find_parts(const SeamTask& task,
                      const std::function<FoundSeams(const SeamPart& part, int count,
                                                     const FoundSeams& pairs)>& find) {
    FoundParts out;
    int count = task.count;
    if (task.pairs) {
        out.pairs = find(*task.pairs, count, {});
        count = static_cast<int>(out.pairs.seams.size());
    }
    out.seams = find(task.seams, count, out.pairs);
    return out;
}

}  // namespace fluidcarve
