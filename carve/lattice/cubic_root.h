#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace fluidcarve {

/// Largest error of a root.
inline constexpr double root_error = 1e-13;
/// How far a root may lie beyond its bounds: the sides of planes are known only up to rounding.
inline constexpr double root_slack = 1e-9;

/// The root of a falling cubic between two bounds, by Newton's method with bisection.
/// @param q         coefficients of `((q[3] c + q[2]) c + q[1]) c + q[0]`, which is at least 0 at
///   `from` and below 0 at `to`
/// @param from, to  the bounds: 0 and 1, or slightly beyond
inline double cubic_root(const std::array<double, 4>& q, double from, double to) {
    double low = from - root_slack, high = to + root_slack;
    double c = q[0] / -(q[1] + q[2] + q[3]);
    if (!(c >= low && c <= high)) c = (low + high) / 2;
    for (int n = 0; n < 100; ++n) {
        const double value = ((q[3] * c + q[2]) * c + q[1]) * c + q[0],
                     slope = (3 * q[3] * c + 2 * q[2]) * c + q[1];
        (value >= 0 ? low : high) = c;
        const double step = value / slope, next = c - step;
        if (!(next >= low && next <= high)) {
            c = (low + high) / 2;
            if (high - low <= root_error) break;
            continue;
        }
        c = next;
        // A Newton step that corrects an error e leaves an error of e^2 q'' / (2 q').
        if (std::abs((3 * q[3] * c + q[2]) * step * step) <= root_error * std::abs(slope)) break;
    }
    return c;
}

/// Eight falling cubics and their roots. The loops are simple, so that compilers vectorize them.
struct CubicRow {
    std::array<double, 8> q0, q1, q2, q3;  ///< coefficients, by power of c
    std::array<double, 8> c;               ///< the roots, after solve()
    std::array<double, 8> left, slope_at;  ///< left / slope_at bounds the error of c

    void set(std::size_t z, const std::array<double, 4>& q) {
        q0[z] = q[0];
        q1[z] = q[1];
        q2[z] = q[2];
        q3[z] = q[3];
    }
    /// Whether the root of cubic z is exact to root_error and between its bounds.
    /// @param from, to  the bounds
    bool solved(std::size_t z, double from, double to) const {
        return left[z] <= root_error * slope_at[z] && c[z] >= from - root_slack &&
               c[z] <= to + root_slack;
    }
    std::array<double, 4> at(std::size_t z) const { return {q0[z], q1[z], q2[z], q3[z]}; }

    /// Takes two Newton steps from the secants' roots. That is enough where planes turn gently.
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
