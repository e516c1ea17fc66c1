#pragma once

#include <array>
#include <cmath>

namespace fluidcarve {

/// How far from the root an answer may be.
inline constexpr double root_error = 1e-13;
/// How far beyond its bounds: the sides of planes are known up to rounding only.
inline constexpr double root_slack = 1e-9;

/// The root of a falling cubic, by Newton's method kept between bounds.
/// @param q         `((q[3] c + q[2]) c + q[1]) c + q[0]`, not below 0 at `from`, below 0 at `to`
/// @param from, to  0 and 1, or a hair beyond
inline double cubic_root(const std::array<double, 4>& q, double from, double to) {
    double low = from - root_slack, high = to + root_slack;
    double c = q[0] / -(q[1] + q[2] + q[3]);
    if (!(c >= low && c <= high)) c = (low + high) / 2;
    for (int n = 0; n < 100; ++n) {
        const double value = ((q[3] * c + q[2]) * c + q[1]) * c + q[0], slope = (3 * q[3] * c + 2 * q[2]) * c + q[1];
        (value >= 0 ? low : high) = c;
        const double step = value / slope, next = c - step;
        if (!(next >= low && next <= high)) {
            c = (low + high) / 2;
            if (high - low <= root_error) break;
            continue;
        }
        c = next;
        // What a step leaves of an error e is e^2 q'' / 2 q'.
        if (std::abs((3 * q[3] * c + q[2]) * step * step) <= root_error * std::abs(slope)) break;
    }
    return c;
}

/// Eight falling cubics by the power of c, and their roots: simple loops, which compilers turn into vectors.
struct CubicRow {
    std::array<double, 8> q0, q1, q2, q3;
    std::array<double, 8> c;               ///< answers
    std::array<double, 8> left, slope_at;  ///< their quotient is how far from the root an answer may be

    void set(std::size_t z, const std::array<double, 4>& q) {
        q0[z] = q[0];
        q1[z] = q[1];
        q2[z] = q[2];
        q3[z] = q[3];
    }
    bool solved(std::size_t z, double from, double to) const {
        return left[z] <= root_error * slope_at[z] && c[z] >= from - root_slack && c[z] <= to + root_slack;
    }
    std::array<double, 4> at(std::size_t z) const { return {q0[z], q1[z], q2[z], q3[z]}; }

    /// Two of Newton's steps from the secants' roots: where planes turn gently, enough.
    void solve() {
        for (std::size_t z = 0; z < 8; ++z) c[z] = q0[z] / -(q1[z] + q2[z] + q3[z]);
        step();
        step();
    }

private:
    void step() {
        for (std::size_t z = 0; z < 8; ++z) {
            const double at = c[z], slope = (3 * q3[z] * at + 2 * q2[z]) * at + q1[z];
            const double by = (((q3[z] * at + q2[z]) * at + q1[z]) * at + q0[z]) / slope;
            c[z] = at - by;
            left[z] = std::abs((3 * q3[z] * c[z] + q2[z]) * by * by);
            slope_at[z] = std::abs(slope);
        }
    }
};

}  // namespace fluidcarve
