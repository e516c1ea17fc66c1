#pragma once

#include "formats/file/path_pattern.h"
#include "tests/bench/measure.h"

#include <openvdb/io/File.h>

#include <string>

/// Seconds to read the frames of a sequence, counted from 1, and to write them again one by one:
/// the least that any tool takes.
/// @param scratch  of the file that is written
inline double seconds_to_copy(const fluidcarve::PathPattern& files, int frames,
                              const std::string& scratch) {
    return seconds(3, [&] {
        for (int frame = 1; frame <= frames; ++frame) {
            openvdb::io::File from(files.at(frame));
            from.open(false);
            const auto grids = from.getGrids();
            const auto metadata = from.getMetadata();
            from.close();
            openvdb::io::File(scratch).write(*grids, *metadata);
        }
    });
}
