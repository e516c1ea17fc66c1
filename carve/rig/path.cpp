#include "carve/rig/path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fluidcarve {

using openvdb::Vec3d;

Path::Path(const Rig& rig) : closed_(rig.closed), oval_(rig.oval), points_(rig.points), starts_{0} {
    const auto count = points_.size();
    for (std::size_t n = 0; n + 1 < count + (closed_ ? 1 : 0); ++n) {
        const auto chord = points_[(n + 1) % count] - points_[n];
        directions_.push_back(chord.unit());
        length_ += chord.length();
        starts_.push_back(oval_ ? 2 * M_PI * static_cast<double>(n + 1) / static_cast<double>(count)
                                : length_);
    }
    end_ = starts_.back();
    if (!closed_) starts_.back() += length_;
}

Vec3d Path::at(const Place& place) const {
    const auto piece = place.piece % directions_.size();
    if (oval_) return oval_->at(oval_->start + starts_[piece] + place.along);
    return points_[piece] + place.along * directions_[piece];
}

double Path::travelled(const Place& place) const {
    const auto rounds = place.piece / directions_.size();
    return static_cast<double>(rounds) * end() + starts_[place.piece % directions_.size()] +
           place.along;
}

Vec3d Path::direction(const Place& from, const Place& to) const {
    // Within a straight piece, a difference of two points would add rounding errors.
    if (!oval_ && from.piece == to.piece) return directions_[from.piece % directions_.size()];
    return (at(to) - at(from)).unit();
}

std::optional<Path::Place> Path::step(const Place& from, double distance) const {
    const auto origin = at(from);
    const auto pieces = directions_.size(), last = closed_ ? from.piece + pieces : pieces - 1;
    for (auto piece = from.piece; piece <= last; ++piece) {
        const double size = starts_[piece % pieces + 1] - starts_[piece % pieces];
        // Distances along a line that starts nearer than `distance` pass `distance` at most once.
        if ((at({piece, size}) - origin).length() < distance) continue;
        const double along = crossing(from, piece, origin, distance);
        return along < size              ? Place{piece, along}
               : closed_ || piece < last ? Place{piece + 1, 0}
                                         : Place{piece, size};
    }
    return std::nullopt;
}

double Path::crossing(const Place& from, std::size_t piece, const Vec3d& origin,
                      double distance) const {
    const auto n = piece % directions_.size();
    if (!oval_) {
        if (piece == from.piece) return from.along + distance;
        const auto to_start = points_[n] - origin;
        const double b = to_start.dot(directions_[n]);
        return -b + std::sqrt(std::max(0.0, b * b - to_start.lengthSqr() + distance * distance));
    }
    double low = piece == from.piece ? from.along : 0, high = starts_[n + 1] - starts_[n],
           along = high;
    for (int tries = 0; tries < 100; ++tries) {
        const double angle = oval_->start + starts_[n] + along;
        const auto off = oval_->at(angle) - origin;
        const double excess = off.lengthSqr() - distance * distance;
        (excess < 0 ? low : high) = along;
        const double slope = 2 * off.dot(std::cos(angle) * oval_->y - std::sin(angle) * oval_->x);
        double next = along - excess / slope;
        if (!(next >= low && next <= high)) next = (low + high) / 2;
        const bool done = std::abs(next - along) <= 1e-16;
        along = next;
        if (done) break;
    }
    return along;
}

}  // namespace fluidcarve
